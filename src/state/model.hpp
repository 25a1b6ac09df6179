// SPDX-License-Identifier: MIT
// What a run does not change (Model) and what outlives a step (State).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include <flotilla/scene.hpp>
#include <flotilla/settings.hpp>

#include "base/axis_locks.hpp"
#include "base/rotation.hpp"
#include "scene/scene.hpp"
#include "state/rigid_shape.hpp"

namespace flotilla {

/// Constants of a body. Movable bodies have finite mass; static and scripted ones infinite mass (inverse_mass 0).
struct Body {
    std::int32_t shape = 0;
    BodyType type = BodyType::dynamic;
    double mass = 0, inverse_mass = 0; ///< kg, 1/kg
    double friction = 0, restitution = 0;
    double size = 0;   ///< m, diameter of the bounding sphere
    double extent = 0; ///< m, which the lengths of its pairs go by (Shape::extent)
    std::vector<Keyframe> keyframes;
    AxisLocks locked;
    Quat first_rotation;     ///< where it was last placed: what a hinge turns from
    Vec3 force, torque;      ///< N and N m, of the body's own (state/loads.hpp)
    std::int32_t group = -1; ///< of PairFilter; -1: of none
    bool present = true;     ///< a body that was removed leaves a place that stands still and meets nobody
    bool asleep = false;     ///< stands still in the step under way, like a body of infinite mass

    [[nodiscard]] bool dynamic() const { return type == BodyType::dynamic; }
    [[nodiscard]] bool movable() const { return dynamic() && !asleep; }
    [[nodiscard]] bool scripted() const { return type == BodyType::kinematic; }
    [[nodiscard]] bool force_acts() const { return force != Vec3{}; }
    [[nodiscard]] bool driven() const { return force_acts() || torque != Vec3{}; }
};

struct Model {
    std::deque<RigidShape> shapes; ///< stay where they are as others come
    std::vector<Body> bodies;
    Vec3 gravity; ///< m/s^2
    Settings settings;
    PairFilter filter;
    /// Bodies that may move in the step under way, movable or scripted ones, ascending. The others stand still.
    std::vector<std::int32_t> active;

    /// After bodies were added, fell asleep or woke.
    void list_active();

    [[nodiscard]] std::size_t size() const { return bodies.size(); }
    /// Whether the filter lets two bodies pass through each other.
    [[nodiscard]] bool ignores(std::int32_t a, std::int32_t b) const {
        return !filter.empty() && filter.ignores(a, bodies[static_cast<std::size_t>(a)].group, b,
                                                 bodies[static_cast<std::size_t>(b)].group);
    }
    [[nodiscard]] const RigidShape& shape_of(std::size_t body) const {
        return shapes[static_cast<std::size_t>(bodies[body].shape)];
    }
};

/// Pair friction is the geometric mean, pair restitution the maximum (src/state/README.md).
[[nodiscard]] double pair_friction(const Model& model, std::int32_t a, std::int32_t b);
[[nodiscard]] double pair_restitution(const Model& model, std::int32_t a, std::int32_t b);

/// The pose with a given centre of mass and rotation.
[[nodiscard]] Pose make_pose(const RigidShape& shape, const Vec3& com, const Quat& rotation);
/// The pose of a body whose mesh origin stands at `origin`.
[[nodiscard]] Pose pose_at_origin(const RigidShape& shape, const Vec3& origin, const Quat& rotation);

/// A pair that started without room for its rest distance: what it has instead, by which its separation goes as well.
struct RestDistance {
    std::int32_t a, b; ///< a < b
    double distance;   ///< m
};

/// A pair that lacks some of its rest distance (static_contact/squeezed_pairs.hpp).
struct SqueezedPair {
    static constexpr std::int32_t kMostWait = 1 << 20; ///< steps, with room to double
    std::int32_t a, b;                                 ///< a < b
    double distance;        ///< m, that it is due: its rest distance, or while it waits what it has
    std::int32_t steps = 0; ///< in a row that it was asked in vain; negative: until it is asked again
    std::int32_t waits = 0; ///< steps that it waited last; 0: never yet
};

/// The impulse at a feature pair, kept for the next solve as a world vector.
struct WarmImpulse {
    std::int32_t a, b; ///< a < b
    std::uint64_t feature_key;
    Vec3 impulse; ///< on b, N s
};

/// Rest of a body: how long it has been quiet, and with whom it fell asleep.
struct Sleep {
    std::int32_t quiet_steps = 0;
    std::int32_t island = -1; ///< lowest body of the island that fell asleep together; -1: awake
};

/// Where a body was when the contacts of its pairs were last searched for on its account, and after which step.
struct Searched {
    Pose pose;
    std::int64_t step = 0;
};

/// The solves of static contact in a step: stage 3, of what its velocities keep and of half a step's that may raise
/// bodies to their rest distance, and stage 7.
enum class ContactStage : std::uint8_t { kept, half, final };
/// By stage.
class WarmImpulses {
  public:
    std::vector<WarmImpulse>& operator[](ContactStage stage) { return lists_[static_cast<std::size_t>(stage)]; }
    const std::vector<WarmImpulse>& operator[](ContactStage stage) const {
        return lists_[static_cast<std::size_t>(stage)];
    }
    [[nodiscard]] auto begin() { return lists_.begin(); }
    [[nodiscard]] auto end() { return lists_.end(); }
    [[nodiscard]] auto begin() const { return lists_.begin(); }
    [[nodiscard]] auto end() const { return lists_.end(); }

  private:
    std::array<std::vector<WarmImpulse>, 3> lists_;
};

/// Of a scripted body (step/scripts.hpp). Steps are inner ones.
struct ScriptClock {
    static constexpr std::int64_t kMostStops = 5;

    double delay = 0;       ///< s: it lags; where it follows, since the place that it made for last was due
    std::int64_t stops = 0; ///< up by one in each step that something cut short, down by one in each that it made
};

/// Everything that can change a later bit, and what contacts carried. A checkpoint holds exactly this, and the state
/// hash covers it but for `earlier`.
struct State {
    std::int64_t step = 0; ///< inner ones, where a step is made of several (Settings::substeps)
    double time = 0;       ///< s
    std::vector<Pose> pose;
    std::vector<Motion> motion;
    std::vector<Sleep> sleep;
    std::vector<ScriptClock> script_clock;
    std::vector<double> lift;                 ///< J of each body's energy that are lift (step/energy_account.hpp)
    std::vector<RestDistance> rest_distances; ///< sorted by (a, b)
    std::vector<SqueezedPair> squeezed;       ///< sorted by (a, b)
    /// The impulses of the last solves, each sorted by (a, b, feature pair without a face, feature_key). They solve
    /// different problems: at rest each finds its own solution of the step before.
    WarmImpulses warm;
    /// Those of contacts that no awake body is part of: they wait for the day their bodies wake.
    WarmImpulses waiting;
    std::vector<Searched> searched; ///< by body; empty where contacts are searched for in every step (contact_reuse)
    /// Sums of what static contact did in the inner steps of the last step but its last one, and at contacts ahead
    /// (step/look_ahead.hpp) at the end of all, sorted by (a, b), of pairs of which a body is awake: for who asks, no
    /// bit depends on it.
    std::vector<WarmImpulse> earlier;
};

/// The lengths of a pair of which the body is the smaller one.
[[nodiscard]] PairLengths body_lengths(const Model& model, std::size_t body);
/// The model of an inner step (Settings::substeps), which is all that the stages know of.
[[nodiscard]] Model inner_model(Model model);
/// How far gravity alone, and what else pulls on it all the time, moves a body from rest in one step, m; no more than
/// its size.
[[nodiscard]] double fall_in_step(const Model& model, std::size_t body);
/// Lengths of a pair (scene/pair_lengths.hpp): the size that they go by is the smaller bounding-sphere diameter of its
/// movable bodies (paper, section 4.3.1), less for thin solids (Shape::extent).
[[nodiscard]] PairLengths pair_lengths(const Model& model, const State& state, std::int32_t a, std::int32_t b);

/// Angular velocity of a body with angular momentum `momentum` at the given orientation, rad/s.
[[nodiscard]] Vec3 angular_velocity(const RigidShape& shape, const Quat& rotation, const Vec3& momentum);
/// The same of a movable body of the model, whose axes may be locked.
[[nodiscard]] Vec3 angular_velocity(const Model& model, std::size_t body, const Quat& rotation, const Vec3& momentum);

/// 64-bit hash of all bits of the state.
[[nodiscard]] std::uint64_t state_hash(const State& state);
/// The same in two parts: what does not change while the same bodies sleep, and the rest with that. `awake`: bodies
/// that do not sleep.
[[nodiscard]] std::uint64_t sleepers_hash(const State& state);
[[nodiscard]] std::uint64_t state_hash(const State& state, std::span<const std::int32_t> awake,
                                       std::uint64_t of_sleepers);

} // namespace flotilla
