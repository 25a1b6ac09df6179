// SPDX-License-Identifier: MIT
#include "static_contact/expected_turns.hpp"

#include <algorithm>
#include <atomic>

#include "base/index.hpp"
#include "state/locked_rotation.hpp"
#include "state/rotation_step.hpp"

namespace flotilla {
namespace {

constexpr std::uint8_t kNot = 0, kNear = 1, kFar = 2;       // more than a radian
constexpr std::size_t kBodyGrain = 64, kContactGrain = 256; // of a task

} // namespace

void ExpectedTurns::clear(std::size_t bodies) {
    turns_.assign(bodies, kNot);
    any_ = false;
}

void ExpectedTurns::mark(std::int32_t body) {
    std::atomic_ref(turns_[at(body)]).store(kNear, std::memory_order_relaxed); // whoever comes first
    std::atomic_ref(any_).store(true, std::memory_order_relaxed);
}

void ExpectedTurns::find(Team* team, const Model& model, const VelocityArrays& bodies,
                         std::span<const Contact> contacts, std::span<const Vec3> impulses) {
    if (!any_) return;
    const double dt = time_step_ = model.settings.time_step;
    add_impulses(team, bodies, contacts, impulses);
    turn_.resize(model.size());
    for_each(team, "expected turns", model.active.size(), kBodyGrain, [&](std::size_t k) {
        const std::int32_t body = model.active[k];
        const std::size_t i = at(body);
        if (turns_[i] == kNot) return;
        const Body& b = model.bodies[i];
        const Vec3& now = bodies.turn_of(body);
        const Vec3 added = bodies.angular_velocity[i] - now;
        const Vec3 more = added + bodies.inverse_inertia[i] * torque_[i];
        const bool known = length_sq(more) < length_sq(now);
        const Vec3 omega = known ? now + more : now;
        const auto left = [&] { return std::clamp(dot(more, added) / length_sq(added), 0.0, 1.0) * added; };
        const Vec3 on_arcs = known && added != Vec3{} ? now + left() : now;
        if (!b.movable()) {
            turns_[i] = kNot;
            return;
        }
        if (!(length_sq(omega) * dt * dt <= 1)) turns_[i] = kFar;
        const Vec3 momentum = bodies.inertia[i] * omega;
        const WorldInertia inertia = world_inertia(model.shape_of(i), b.locked.rotation, bodies.turned[i].rotation);
        turn_[i] = {omega, rotate_free(inertia, b.locked.rotation, momentum, dt).rotation, on_arcs};
    });
}

void ExpectedTurns::add_impulses(Team* team, const VelocityArrays& bodies, std::span<const Contact> contacts,
                                 std::span<const Vec3> impulses) {
    torque_.assign(turns_.size(), {});
    pair_torque_.resize(contacts.size());
    const auto acts = [&](const Contact& c) { return (turns_[at(c.a)] | turns_[at(c.b)]) != kNot; };
    for_each(team, "torques of pairs", contacts.size(), kContactGrain, [&](std::size_t i) {
        if (!begins_pair(contacts, i) || !acts(contacts[i])) return;
        Torque sum;
        for (std::size_t k = i; k == i || (k < contacts.size() && !begins_pair(contacts, k)); ++k) {
            const Contact& c = contacts[k];
            sum.a -= cross(point_on(c, c.a) - bodies.position[at(c.a)], impulses[k]);
            sum.b += cross(point_on(c, c.b) - bodies.position[at(c.b)], impulses[k]);
        }
        pair_torque_[i] = sum;
    });
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& c = contacts[i];
        if (!begins_pair(contacts, i) || !acts(c)) continue;
        torque_[at(c.a)] += pair_torque_[i].a;
        torque_[at(c.b)] += pair_torque_[i].b;
    }
}

bool ExpectedTurns::turns(std::int32_t body) const { return turns_[at(body)] == kNear; }

const Vec3& ExpectedTurns::on_arcs(const VelocityArrays& bodies, std::int32_t body) const {
    return turns(body) && !bodies.unloaded.empty() ? turn_[at(body)].on_arcs : bodies.turn_of(body);
}

const Vec3& ExpectedTurns::angular_velocity(const VelocityArrays& bodies, std::int32_t body) const {
    return turns(body) ? turn_[at(body)].angular_velocity : bodies.turn_of(body);
}

Vec3 ExpectedTurns::mean_less_now(std::int32_t body, const Vec3& arm) const {
    if (turns_[at(body)] == kNot) return {};
    const Turn& turn = turn_[at(body)];
    return (1 / time_step_) * (rotate(turn.rotation, arm) - arm) - cross(turn.angular_velocity, arm);
}

} // namespace flotilla
