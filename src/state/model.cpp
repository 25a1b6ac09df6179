// SPDX-License-Identifier: MIT
#include "state/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hasher.hpp"
#include "state/loads.hpp"
#include "state/locked_rotation.hpp"

namespace flotilla {

double pair_friction(const Model& model, std::int32_t a, std::int32_t b) {
    return std::sqrt(model.bodies[at(a)].friction * model.bodies[at(b)].friction);
}

double pair_restitution(const Model& model, std::int32_t a, std::int32_t b) {
    return std::max(model.bodies[at(a)].restitution, model.bodies[at(b)].restitution);
}

Pose make_pose(const RigidShape& shape, const Vec3& com, const Quat& rotation) {
    return {com, rotation, com - rotate(rotation, shape.center_of_mass)};
}

Pose pose_at_origin(const RigidShape& shape, const Vec3& origin, const Quat& rotation) {
    return {origin + rotate(rotation, shape.center_of_mass), rotation, origin};
}

PairLengths body_lengths(const Model& model, std::size_t body) {
    return lengths_of_size(model.settings, model.bodies[body].extent);
}

Model inner_model(Model model) {
    model.settings.time_step /= model.settings.substeps;
    model.settings.substeps = 1;
    return model;
}

double fall_in_step(const Model& model, std::size_t body) {
    const double dt = model.settings.time_step;
    return std::min(0.5 * most_acceleration(model, body) * dt * dt, model.bodies[body].size);
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
    // In a tight joint features that were far from each other pass at the distance of the play, which must not be a
    // hit.
    lengths.rest = it->distance;
    lengths.separation = std::min(lengths.separation, derived_separation(lengths.rest));
    return lengths;
}

Vec3 angular_velocity(const RigidShape& shape, const Quat& rotation, const Vec3& momentum) {
    return angular_velocity(turned(shape.principal, rotation), momentum);
}

Vec3 angular_velocity(const Model& model, std::size_t body, const Quat& rotation, const Vec3& momentum) {
    const AxisMask locked = model.bodies[body].locked.rotation;
    const RigidShape& shape = model.shape_of(body);
    if (locked == 0) return angular_velocity(shape, rotation, momentum);
    return world_inertia(shape, locked, rotation).inverse * momentum;
}

void Model::list_active() {
    active.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (bodies[i].present && (bodies[i].movable() || bodies[i].scripted()))
            active.push_back(static_cast<std::int32_t>(i));
}

namespace {

bool sleeps(const Sleep& s) { return s.island >= 0; }

std::uint64_t word(std::int32_t high, std::int32_t low) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(high)) << 32) | static_cast<std::uint32_t>(low);
}

void add(Hasher& h, const State& s, std::span<const std::int32_t> bodies) {
    const auto each = [&](auto&& add_one) {
        for (const std::int32_t i : bodies) add_one(static_cast<std::size_t>(i));
    };
    each([&](std::size_t i) { h.add(s.pose[i].com), h.add(s.pose[i].rotation), h.add(s.pose[i].origin); });
    each([&](std::size_t i) { h.add(s.motion[i].velocity), h.add(s.motion[i].momentum); });
    each([&](std::size_t i) { h.add(word(s.sleep[i].quiet_steps, s.sleep[i].island)); });
    each([&](std::size_t i) { h.add(s.script_clock[i].delay); });
    each([&](std::size_t i) { // only where there are any: hashes of scenes without stay
        if (s.script_clock[i].stops != 0)
            h.add(word(static_cast<std::int32_t>(i), static_cast<std::int32_t>(s.script_clock[i].stops)));
    });
    each([&](std::size_t i) { h.add(s.lift[i]); });
    if (s.searched.empty()) return;
    each([&](std::size_t i) {
        const Searched& from = s.searched[i];
        h.add(from.pose.com), h.add(from.pose.rotation), h.add(from.pose.origin);
        h.add(static_cast<std::uint64_t>(from.step));
    });
}

void add(Hasher& h, const std::vector<WarmImpulse>& impulses) {
    h.add(static_cast<std::uint64_t>(impulses.size()));
    for (const WarmImpulse& w : impulses) {
        h.add(word(w.a, w.b));
        h.add(w.feature_key);
        h.add(w.impulse);
    }
}

std::vector<std::int32_t> bodies_of(const State& state, bool asleep) {
    std::vector<std::int32_t> out;
    for (std::size_t i = 0; i < state.sleep.size(); ++i)
        if (sleeps(state.sleep[i]) == asleep) out.push_back(static_cast<std::int32_t>(i));
    return out;
}

} // namespace

std::uint64_t sleepers_hash(const State& state) {
    if (std::none_of(state.sleep.begin(), state.sleep.end(), sleeps)) return 0;
    Hasher h;
    const std::vector<std::int32_t> bodies = bodies_of(state, true);
    for (const std::int32_t i : bodies) h.add(static_cast<std::uint64_t>(i));
    add(h, state, bodies);
    for (const auto& impulses : state.waiting) add(h, impulses);
    return h.value();
}

std::uint64_t state_hash(const State& state, std::span<const std::int32_t> awake, std::uint64_t of_sleepers) {
    Hasher h;
    h.add(static_cast<std::uint64_t>(state.step));
    h.add(state.time);
    add(h, state, awake);
    for (const RestDistance& r : state.rest_distances) h.add(word(r.a, r.b)), h.add(r.distance);
    for (const SqueezedPair& s : state.squeezed)
        h.add(word(s.a, s.b)), h.add(s.distance), h.add(word(s.steps, s.waits));
    for (const auto& impulses : state.warm) add(h, impulses);
    if (of_sleepers != 0) h.add(of_sleepers);
    return h.value();
}

std::uint64_t state_hash(const State& state) {
    return state_hash(state, bodies_of(state, false), sleepers_hash(state));
}

} // namespace flotilla
