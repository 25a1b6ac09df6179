// SPDX-License-Identifier: MIT
#include "state/model.hpp"

#include <algorithm>
#include <limits>

#include "base/hasher.hpp"
#include "state/rotation_step.hpp"

namespace flotilla {
namespace {

constexpr double kRestOfSize = 1.0 / 330.0; // 1 cm for the paper's 3.3 m boat
constexpr double kProximityOfRest = 2;
constexpr double kSeparationOfRest = 1.0 / 50.0;

} // namespace

Pose make_pose(const RigidShape& shape, const Vec3& com, const Quat& rotation) {
    return {com, rotation, com - rotate(rotation, shape.center_of_mass)};
}

Pose pose_at_origin(const RigidShape& shape, const Vec3& origin, const Quat& rotation) {
    return {origin + rotate(rotation, shape.center_of_mass), rotation, origin};
}

namespace {

PairLengths lengths_of_size(const Settings& s, double size) {
    const double rest = s.rest_distance > 0 ? s.rest_distance : size * kRestOfSize;
    return {rest, s.proximity_distance > 0 ? s.proximity_distance : kProximityOfRest * rest,
            s.separation > 0 ? s.separation : kSeparationOfRest * rest};
}

} // namespace

PairLengths body_lengths(const Model& model, std::size_t body) {
    return lengths_of_size(model.settings, model.bodies[body].extent);
}

double fall_in_step(const Model& model, std::size_t body) {
    const double dt = model.settings.time_step;
    return std::min(0.5 * length(model.gravity) * dt * dt, model.bodies[body].size);
}

PairLengths pair_lengths(const Model& model, const State& state, std::int32_t a, std::int32_t b) {
    double size = std::numeric_limits<double>::infinity();
    for (std::int32_t i : {a, b}) {
        const Body& body = model.bodies[static_cast<std::size_t>(i)];
        if (body.dynamic()) size = std::min(size, body.extent);
    }
    PairLengths lengths = lengths_of_size(model.settings, size);
    const auto less = [](const RestDistance& r, std::pair<std::int32_t, std::int32_t> key) {
        return std::pair(r.a, r.b) < key;
    };
    const auto it = std::lower_bound(state.rest_distances.begin(), state.rest_distances.end(), std::pair(a, b), less);
    if (it == state.rest_distances.end() || it->a != a || it->b != b || !(it->distance < lengths.rest)) return lengths;
    // In a tight joint features that were far from each other pass at the distance of the play, which must not be a hit.
    lengths.rest = it->distance;
    lengths.separation = std::min(lengths.separation, kSeparationOfRest * lengths.rest);
    return lengths;
}

Vec3 angular_velocity(const RigidShape& shape, const Quat& rotation, const Vec3& momentum) {
    return rotate(rotation, shape.inverse_inertia * rotate(conjugate(rotation), momentum));
}

std::uint64_t state_hash(const State& state) {
    Hasher h;
    h.add(static_cast<std::uint64_t>(state.step));
    h.add(state.time);
    for (const Pose& p : state.pose) h.add(p.com), h.add(p.rotation), h.add(p.origin);
    for (const Motion& m : state.motion) h.add(m.velocity), h.add(m.momentum);
    for (const Sleep& q : state.sleep)
        h.add((static_cast<std::uint64_t>(static_cast<std::uint32_t>(q.quiet_steps)) << 32) |
              static_cast<std::uint32_t>(q.island));
    for (double d : state.script_delay) h.add(d);
    for (double e : state.lift) h.add(e);
    for (const RestDistance& r : state.rest_distances) {
        h.add((static_cast<std::uint64_t>(static_cast<std::uint32_t>(r.a)) << 32) | static_cast<std::uint32_t>(r.b));
        h.add(r.distance);
    }
    for (const auto* impulses : {&state.warm_half, &state.warm_final}) {
        h.add(static_cast<std::uint64_t>(impulses->size()));
        for (const WarmImpulse& w : *impulses) {
            h.add((static_cast<std::uint64_t>(static_cast<std::uint32_t>(w.a)) << 32) |
                  static_cast<std::uint32_t>(w.b));
            h.add(w.feature_key);
            h.add(w.impulse);
        }
    }
    return h.value();
}

} // namespace flotilla
