// SPDX-License-Identifier: MIT
// A run whose every inner step the audit looks at: the state it ends in, and the motion that led there.
#pragma once

#include <flotilla/scene_library.hpp>

#include "audit/audit.hpp"
#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "step/scenario.hpp"
#include "step/stepper.hpp"

namespace flotilla::scenario {

class AuditedRun {
  public:
    /// The bodies are moved by `shift` (m) after the scene was checked: as far as they may get in a run.
    explicit AuditedRun(const SceneDescription& description, const Vec3& shift = {})
        : scene_(shifted(build_scene(description), shift)),
          model_(make_model(scene_)),
          stepper_(model_, initial_state(scene_, model_)) {
        for (const RigidShape& s : model_.shapes)
            audited_.shapes.push_back(audit::make_shape(s.mesh, s.center_of_mass));
        for (const Body& b : model_.bodies) audited_.bodies.push_back({b.shape, !b.movable()});
        last_ = place(stepper_.state().pose);
    }

    void set_gravity(const Vec3& gravity) { stepper_.set_gravity(gravity); }

    /// Steps and adds what the audit finds to `findings`.
    StepReport step() {
        const StepReport report = stepper_.step();
        totals.add(report);
        for (const InnerState& inner : stepper_.inner_states()) audit_motion(inner.pose, inner.turn);
        audit_motion(stepper_.state().pose, stepper_.turns());
        return report;
    }

    [[nodiscard]] const Stepper& stepper() const { return stepper_; }

    RunTotals totals;
    std::size_t findings = 0;
    std::int64_t audited_pairs = 0; ///< of triangles, on the way
    double largest_turn = 0;        ///< rad in one inner step

  private:
    static Scene shifted(Scene scene, const Vec3& shift) {
        for (BodyDescription& body : scene.bodies) body.position += shift;
        return scene;
    }

    audit::Placement place(const std::vector<Pose>& at) {
        std::vector<audit::Pose> poses;
        for (const Pose& p : at) poses.push_back({p.origin, p.rotation});
        return audit::place(audited_, poses, 1);
    }

    void audit_motion(const std::vector<Pose>& end, const std::vector<Vec3>& turns) {
        audit::Placement now = place(end);
        const auto motion =
            model_.settings.trajectory == Trajectory::rigid ? audit::Motion::rigid : audit::Motion::linear;
        const auto states = audit::check_state(audited_, now, 1);
        const auto paths = audit::check_motion(audited_, last_, now, motion, turns, 1);
        findings += states.intersections.size() + paths.passages.size() + paths.bad_paths.size() + now.bad.size();
        audited_pairs += paths.triangle_pairs;
        for (const Vec3& turn : turns) largest_turn = std::max(largest_turn, length(turn));
        last_ = std::move(now);
    }

    Scene scene_;
    Model model_;
    Stepper stepper_;
    audit::Scene audited_;
    audit::Placement last_;
};

} // namespace flotilla::scenario
