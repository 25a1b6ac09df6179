// SPDX-License-Identifier: MIT
#include "response/impulse.hpp"

#include <cmath>

#include "response/frictional_impact.hpp"

namespace flotilla {
namespace {

Mat3 point_mobility(const Impulsive& body, const Vec3& arm) {
    const Mat3 r = cross_matrix(arm);
    const double w = body.inverse_mass;
    return diagonal(free_part(body.locked, {w, w, w})) + transpose(r) * (body.inverse_inertia * r);
}

bool can_move(const Impulsive& body, const Vec3& arm, const Vec3& n) {
    return dot(n, point_mobility(body, arm) * n) > kLeastMobility * body.inverse_mass;
}

} // namespace

double normal_mobility(const Impulsive& a, const Impulsive& b, const ContactPoint& point, const Mat3& k) {
    const Vec3& n = point.normal;
    if ((a.locked | b.locked) != 0 && !can_move(a, point.arm_a, n) && !can_move(b, point.arm_b, n)) return 0;
    return dot(n, k * n);
}

Mat3 collision_matrix(const Impulsive& a, const Impulsive& b, const Vec3& arm_a, const Vec3& arm_b) {
    return point_mobility(a, arm_a) + point_mobility(b, arm_b);
}

std::optional<Vec3> contact_impulse(const Impulsive& a, const Impulsive& b, const ContactPoint& point, double target) {
    const Vec3& n = point.normal;
    const double vn = dot(n, point.relative_velocity);
    if (!(target > vn)) return std::nullopt;
    const Mat3 k = collision_matrix(a, b, point.arm_a, point.arm_b);
    const double nkn = normal_mobility(a, b, point, k);
    if (!(nkn > 0)) return std::nullopt;
    if (point.friction <= 0) return ((target - vn) / nkn) * n;
    return frictional_impact({k, n, point.friction, (a.locked | b.locked) != 0}, point.relative_velocity, target);
}

double energy_clamp(const Impulsive& a, const Impulsive& b, const Vec3& arm_a, const Vec3& arm_b, const Vec3& impulse) {
    const double slope = dot(impulse, point_velocity(b, arm_b) - point_velocity(a, arm_a));
    if (!(slope < 0)) return 0;
    const double curvature = dot(impulse, collision_matrix(a, b, arm_a, arm_b) * impulse);
    return curvature > -2 * slope ? -2 * slope / curvature : 1.0;
}

} // namespace flotilla
