// SPDX-License-Identifier: MIT
#include "static_contact/velocity_arrays.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

#include "base/index.hpp"
#include "base/same_bits.hpp"
#include "state/loads.hpp"
#include "state/locked_rotation.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBodyGrain = 64; // bodies of a task

} // namespace

void VelocityArrays::load(Team* team, const Model& model, std::uint64_t version, std::span<const Pose> poses,
                          std::span<const Motion> motion) {
    const std::size_t n = model.size();
    position.resize(n);
    velocity.resize(n);
    angular_velocity.resize(n);
    loaded_angular_velocity.resize(n);
    inverse_mass.resize(n);
    inverse_inertia.resize(n);
    inertia.resize(n);
    turned.resize(n);
    locked.resize(n);
    const bool all = std::exchange(still_version, version) != version;
    for_each(team, "load velocities", all ? n : model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::size_t i = all ? k : at(model.active[k]);
        const bool movable = model.bodies[i].movable();
        position[i] = poses[i].com;
        velocity[i] = motion[i].velocity;
        inverse_mass[i] = movable ? model.bodies[i].inverse_mass : 0.0;
        set_inertia(model, i, poses[i].rotation);
        locked[i] = movable ? model.bodies[i].locked.translation : AxisMask{0};
        angular_velocity[i] = movable ? inverse_inertia[i] * motion[i].momentum : motion[i].momentum;
        loaded_angular_velocity[i] = angular_velocity[i];
    });
}

void VelocityArrays::set_inertia(const Model& model, std::size_t i, const Quat& rotation) {
    const Body& body = model.bodies[i];
    const Turned now{rotation, body.shape, body.locked.rotation, body.movable()};
    Turned& last = turned[i];
    if (same_bits(now.rotation, last.rotation) && now.shape == last.shape && now.locked == last.locked &&
        now.movable == last.movable)
        return;
    last = now;
    const WorldInertia world = now.movable ? world_inertia(model.shape_of(i), now.locked, rotation) : WorldInertia{};
    inverse_inertia[i] = world.inverse;
    inertia[i] = now.locked == 0 ? world.tensor : free_block(now.locked, world.tensor);
}

void VelocityArrays::set_rest_speeds(Team* team, const Model& model, const ContactTuning& tuning) {
    rest_speed.assign(model.size(), 0);
    std::atomic<bool> any = false;
    for_each(team, "rest speeds", model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::size_t i = at(model.active[k]);
        if (!model.bodies[i].driven()) return;
        rest_speed[i] = tuning.rest_speed * most_acceleration(model, i) * model.settings.time_step;
        any.store(true, std::memory_order_relaxed);
    });
    if (!any) rest_speed.clear();
}

void VelocityArrays::set_unloaded(Team* team, const Model& model, double accelerated) {
    unloaded.clear();
    const auto turned_by_load = [&](std::int32_t body) { return model.bodies[at(body)].torque != Vec3{}; };
    std::atomic<bool> any = false;
    for_each(team, "own torques", model.active.size(), kBodyGrain, [&](std::size_t k) {
        if (turned_by_load(model.active[k])) any.store(true, std::memory_order_relaxed);
    });
    if (!any) return;
    unloaded = angular_velocity;
    for_each(team, "unloaded turns", model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::int32_t body = model.active[k];
        if (model.bodies[at(body)].movable() && turned_by_load(body))
            unloaded[at(body)] -= accelerated * (inverse_inertia[at(body)] * turning_torque(model, at(body)));
    });
}

void VelocityArrays::store(Team* team, const Model& model, std::span<Motion> motion) const {
    for_each(team, "store velocities", model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::size_t i = at(model.active[k]);
        if (!model.bodies[i].movable()) return;
        motion[i].velocity = velocity[i];
        if (angular_velocity[i] != loaded_angular_velocity[i])
            motion[i].momentum += inertia[i] * (angular_velocity[i] - loaded_angular_velocity[i]);
    });
}

} // namespace flotilla
