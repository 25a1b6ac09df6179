// SPDX-License-Identifier: MIT
#include "impulse.hpp"

#include <algorithm>
#include <cmath>

namespace flotilla::baseline {
namespace {

/// K of section 5: the change of a point's velocity by an impulse there.
Mat3 compliance(const Body& body, const Vec3& arm) {
    const Mat3 r = cross_matrix(arm);
    return body.inverse_mass * identity() + transpose(r) * (body.inverse_inertia * r);
}

void apply(Body& body, const Vec3& arm, const Vec3& impulse) {
    body.velocity += body.inverse_mass * impulse;
    body.angular_velocity += body.inverse_inertia * cross(arm, impulse);
}

/// Section 7. `u`: relative velocity, m/s, approaching along the normal n.
Vec3 impulse_of(const Mat3& k, const Vec3& u, const Vec3& n, double restitution, double friction) {
    const double approach = dot(u, n);
    if (friction > 0) {
        // Assume that the contact sticks: no tangential velocity afterwards. Accepted inside the friction cone.
        const Vec3 sticking = inverse(k) * (-restitution * approach * n - u);
        const double normal = dot(sticking, n);
        if (length(sticking - normal * n) <= friction * normal) return sticking;
        const Vec3 tangential = u - approach * n;
        const Vec3 direction = n - friction * normalized(tangential);
        const double resistance = dot(n, k * direction);
        if (resistance > 0) return -(1 + restitution) * approach / resistance * direction;
        // Painleve's case, which the publication leaves open: without friction.
    }
    return -(1 + restitution) * approach / dot(n, k * n) * n;
}

} // namespace

double pair_friction(const Body& a, const Body& b) { return std::sqrt(a.friction * b.friction); }
double pair_restitution(const Body& a, const Body& b) { return std::min(a.restitution, b.restitution); }

bool apply_impulse(Body& a, Body& b, const Interference& contact, const Vec3& arm_a, const Vec3& arm_b,
                   double restitution, double friction) {
    const Vec3 u = point_velocity(a, arm_a) - point_velocity(b, arm_b);
    // Rounding leaves points that have just been stopped at +-1e-16 or so.
    constexpr double kResting = 1e-12; // m/s
    if (dot(u, contact.normal) >= -kResting) return false;
    const Vec3 impulse =
        impulse_of(compliance(a, arm_a) + compliance(b, arm_b), u, contact.normal, restitution, friction);
    apply(a, arm_a, impulse);
    apply(b, arm_b, -impulse);
    return true;
}

} // namespace flotilla::baseline
