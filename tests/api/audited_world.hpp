// SPDX-License-Identifier: MIT
// A World that is edited and stepped, every step proved by the audit: no two bodies that may meet intersect, and none
// passes another.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <flotilla/world.hpp>

#include "audit/audit.hpp"
#include "base/vec3.hpp"

namespace flotilla::test {

class AuditedWorld {
  public:
    explicit AuditedWorld(const SceneDescription& scene, const WorldOptions& options = {})
        : world(scene, "scene", options), rigid_(scene.settings.trajectory == Trajectory::rigid) {
        for (const ShapeDescription& shape : scene.shapes) add(shape);
    }

    std::int32_t add_shape(const ShapeDescription& shape) {
        const std::int32_t index = world.add_shape(shape);
        add(shape);
        return index;
    }

    /// Empty where everything holds.
    std::string step(StepReport* report = nullptr) {
        list_bodies();
        const audit::Placement before = place();
        const StepReport r = world.step();
        if (report != nullptr) *report = r;
        const audit::Placement after = place();
        std::vector<Vec3> turns;
        for (const std::size_t i : present_) turns.push_back(world.turn(i));
        const auto name = [&](std::int32_t k) { return world.name(world.id(present_[static_cast<std::size_t>(k)])); };
        const auto state = audit::check_state(scene_, after, 1);
        for (const auto& x : state.intersections)
            if (!ignored || !ignored(name(x.body_a), name(x.body_b)))
                return name(x.body_a) + " and " + name(x.body_b) + " intersect after step " + std::to_string(r.step);
        const auto motion = rigid_ ? audit::Motion::rigid : audit::Motion::linear;
        const auto way = audit::check_motion(scene_, before, after, motion, turns, 1);
        for (const auto& x : way.passages)
            if (!ignored || !ignored(name(x.body_a), name(x.body_b)))
                return name(x.body_a) + " and " + name(x.body_b) + " are not proved apart in step " +
                       std::to_string(r.step);
        return "";
    }

    World world;
    std::function<bool(const std::string&, const std::string&)>
        ignored; ///< which pairs need not be apart; may be empty

  private:
    void add(const ShapeDescription& shape) {
        Vec3 center;
        for (const Vec3& v : shape.vertices) center = center + (1.0 / static_cast<double>(shape.vertices.size())) * v;
        scene_.shapes.push_back(audit::make_shape({shape.vertices, shape.triangles}, center));
    }
    void list_bodies() {
        present_.clear();
        scene_.bodies.clear();
        for (std::size_t i = 0; i < world.size(); ++i) {
            const BodyId id{static_cast<std::int32_t>(i), world.generation(i)};
            if (!world.contains(id)) continue;
            const BodyDescription& body = world.description(id);
            present_.push_back(i);
            scene_.bodies.push_back({body.shape, body.type != BodyType::dynamic});
        }
    }
    [[nodiscard]] audit::Placement place() const {
        std::vector<audit::Pose> poses;
        for (const std::size_t i : present_) poses.push_back({world.poses()[i].origin, world.poses()[i].rotation});
        return audit::place(scene_, poses, 1);
    }

    bool rigid_;
    audit::Scene scene_;
    std::vector<std::size_t> present_;
};

} // namespace flotilla::test
