// SPDX-License-Identifier: MIT
#include "static_contact/geometric_stiffness.hpp"

#include <atomic>

#include "base/index.hpp"
#include "base/inverse.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kContactGrain = 256;

/// (w dt)^2 from which on inertia is added: explicit forces are stable to 4, of a sum over the axes. Chains of torus
/// links need the margin, whose contact points move as they turn: with 2 eight of them at 1/24 s swing no better than
/// with 1, with 4 they stop.
constexpr double kResolved = 1;
/// The share of it below which a single force counts for nothing.
constexpr double kCounts = 1.0 / 64;

double trace(const Mat3& a) { return a.m[0] + a.m[4] + a.m[8]; }

/// f f^T / |f|
Mat3 along(const Vec3& f, double size) {
    const Vec3 n = (1 / size) * f;
    return {{n.x * f.x, n.x * f.y, n.x * f.z, n.y * f.x, n.y * f.y, n.y * f.z, n.z * f.x, n.z * f.y, n.z * f.z}};
}

} // namespace

bool GeometricStiffness::find_pulled(Team* team, const Model& model, std::span<const Contact> contacts,
                                     std::span<const Vec3> carried, double time, const VelocityArrays& velocities) {
    pulled_.assign(model.size(), 0);
    const double dt = model.settings.time_step;
    std::atomic<bool> any = false;
    for_each(team, "pulled bodies", contacts.size(), kContactGrain, [&](std::size_t i) {
        if (carried[i] == Vec3{}) return;
        const Contact& c = contacts[i];
        for (const std::int32_t body : {c.a, c.b}) {
            const Vec3 f = (body == c.b ? 1 / time : -1 / time) * carried[i];
            const double outward = dot(f, point_on(c, body) - velocities.position[at(body)]);
            if (!(dt * dt * outward * trace(velocities.inverse_inertia[at(body)]) > kCounts * kResolved)) continue;
            std::atomic_ref(pulled_[at(body)]).store(1, std::memory_order_relaxed); // whoever comes first
            any.store(true, std::memory_order_relaxed);
        }
    });
    return any;
}

void GeometricStiffness::stiffen(Team* team, const Model& model, std::span<const Contact> contacts,
                                 std::span<const Vec3> carried, double time, VelocityArrays& velocities) {
    if (!find_pulled(team, model, contacts, carried, time, velocities)) return;
    pulls_.assign(model.size(), {});
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& c = contacts[i];
        for (const std::int32_t body : {c.a, c.b}) {
            if (pulled_[at(body)] == 0 || carried[i] == Vec3{}) continue;
            const Vec3 f = (body == c.b ? 1 / time : -1 / time) * carried[i];
            Pulls& p = pulls_[at(body)];
            p.outward += dot(f, point_on(c, body) - velocities.position[at(body)]);
            p.size += length(f);
            p.along = p.along + along(f, length(f));
        }
    }
    const double dt = model.settings.time_step;
    for (const std::int32_t body : model.active) {
        const Pulls& p = pulls_[at(body)];
        if (pulled_[at(body)] == 0 || !(p.outward > 0) || !model.bodies[at(body)].movable()) continue;
        const Mat3 one{{1, 0, 0, 0, 1, 0, 0, 0, 1}}, own = velocities.inverse_inertia[at(body)];
        const Mat3 turned = (dt * dt * p.outward) * ((one - (1 / p.size) * p.along) * own); // (w dt)^2, as a matrix
        const double resolved = kResolved / trace(turned);
        if (!(resolved < 1)) continue;
        const Mat3 more = own * inverse_of_transpose(transpose(one + ((1 - resolved) / kResolved) * turned));
        stiffened_.push_back({body, own});
        velocities.inverse_inertia[at(body)] = 0.5 * (more + transpose(more));
    }
}

void GeometricStiffness::relax(VelocityArrays& velocities) {
    for (const Stiffened& s : stiffened_) velocities.inverse_inertia[at(s.body)] = s.inverse_inertia;
    stiffened_.clear();
}

} // namespace flotilla
