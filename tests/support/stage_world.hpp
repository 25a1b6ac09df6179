// SPDX-License-Identifier: MIT
// A step as far as a single stage needs it: bodies at x^n with given velocities, and nothing that the stages around it
// do. SI units.
#pragma once

#include <utility>
#include <vector>

#include "broadphase/kept_pairs.hpp"
#include "mesh/primitives.hpp"
#include "pair/impulses.hpp"
#include "pair/pair_lists.hpp"
#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "step/certificate.hpp"
#include "step/scene_parts.hpp"
#include "step/scripts.hpp"

namespace flotilla::test {

/// What the stages of one step share, at its start: every body is a cluster that moves as the scene says, and has moved
/// so.
class StageWorld {
  public:
    explicit StageWorld(const SceneDescription& description, int threads = 1)
        : model_(inner_model(make_model(build_scene(description)))),
          state_(initial_state(build_scene(description), model_)),
          workers_(TeamOptions{.threads = threads}) {
        trajectories_.start(model_, state_.pose);
        book_.table.start_step(workers_.team, 1);
        clusters_.start(model_, trajectories_, state_.motion);
        Scripts(model_).move(model_, state_, trajectories_, clusters_);
        for (const std::int32_t i : model_.active)
            if (model_.bodies[at(i)].movable()) clusters_.evolve(i, dt(), trajectories_);
    }
    StageWorld(const StageWorld&) = delete;
    StageWorld& operator=(const StageWorld&) = delete;

    [[nodiscard]] StepView view() const {
        const Settings& s = model_.settings;
        const double approach =
            s.approach_threshold >= 0 ? s.approach_threshold : 0.5 * length(model_.gravity) * s.time_step;
        const double angle_cos = sin_cos(s.proximity_angle * scenario::kPi / 180).cos;
        return {model_, state_, trajectories_, clusters_, book_.lists.bounds, s.time_step, angle_cos, approach};
    }
    [[nodiscard]] Movers movers() { return {clusters_, trajectories_, dt()}; }
    [[nodiscard]] PairBook& book() { return book_; }
    [[nodiscard]] Workers& workers() { return workers_; }

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const State& state() const { return state_; }
    [[nodiscard]] const Trajectories& trajectories() const { return trajectories_; }
    [[nodiscard]] Clusters& clusters() { return clusters_; }
    [[nodiscard]] PairTable& pairs() { return book_.table; }
    [[nodiscard]] double dt() const { return model_.settings.time_step; }
    [[nodiscard]] double mass(std::int32_t body) const { return model_.bodies[at(body)].mass; }
    [[nodiscard]] Vec3 velocity(std::int32_t body) const { return clusters_.motion()[at(body)].velocity; }
    [[nodiscard]] Vec3 spin(std::int32_t body) const { ///< rad/s
        return angular_velocity(model_.shape_of(at(body)), start(body).rotation, clusters_.motion()[at(body)].momentum);
    }
    [[nodiscard]] const std::vector<Pose>& starts() const { return state_.pose; }
    [[nodiscard]] const Pose& start(std::int32_t body) const { return state_.pose[at(body)]; }
    [[nodiscard]] const Pose& end(std::int32_t body) const { return trajectories_.end_pose(at(body)); }
    [[nodiscard]] PairLengths lengths(std::int32_t a, std::int32_t b) const {
        return pair_lengths(model_, state_, a, b);
    }

    /// kg m/s, of the movable bodies.
    [[nodiscard]] Vec3 momentum() const {
        Vec3 sum;
        for (const std::int32_t i : model_.active)
            if (model_.bodies[at(i)].movable()) sum += mass(i) * velocity(i);
        return sum;
    }
    /// J, kinetic, with the inertia at x^n.
    [[nodiscard]] double energy() const {
        double sum = 0;
        for (const std::int32_t i : model_.active)
            if (model_.bodies[at(i)].movable())
                sum += 0.5 * (mass(i) * length_sq(velocity(i)) + dot(spin(i), clusters_.motion()[at(i)].momentum));
        return sum;
    }
    /// All end poses, bit for bit.
    [[nodiscard]] std::vector<Pose> ends() const {
        std::vector<Pose> out;
        for (std::size_t i = 0; i < model_.size(); ++i) out.push_back(trajectories_.end_pose(i));
        return out;
    }

  private:
    static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

    Model model_;
    State state_;
    Workers workers_;
    Trajectories trajectories_;
    Clusters clusters_;
    KeptPairs broadphase_;
    PairBook book_{broadphase_};
};

inline bool proved_apart(StageWorld& world) {
    try {
        certify(world.view(), world.book(), world.workers().team);
    } catch (const CertificateError&) {
        return false;
    }
    return true;
}

/// Without gravity and friction; a step of 1/100 s.
inline SceneDescription weightless_scene() {
    SceneDescription scene = scenario::empty_scene();
    scene.gravity = {};
    scene.settings.time_step = 0.01;
    scene.settings.friction = scene.settings.restitution = 0;
    return scene;
}

/// An octahedron with a corner at distance `radius` on each axis.
inline std::int32_t add_octahedron(SceneDescription& scene, double mass, double radius = 0.5) {
    return scenario::add_shape(scene, scenario::make_octahedron(radius), mass);
}

/// Boxes in each other, with less room than they turn: whatever a blow does to one of them, it hits the next.
inline SceneDescription nested_boxes(SceneDescription scene, int count) {
    scene.settings.trajectory = Trajectory::rigid;
    double size = 1;
    for (int i = 0; i < count; ++i, size *= 0.998) {
        const std::int32_t shape = scenario::add_shape(scene, make_box(size, size, size), 1);
        BodyDescription& body = scenario::add_body(scene, shape, BodyType::dynamic, {}, 0.5, 0);
        body.angular_velocity = {300.0 - 60 * i, 150.0 * (i % 2), 100};
        body.velocity = {0.1 * (i % 3), 0, 0};
    }
    return scene;
}

} // namespace flotilla::test
