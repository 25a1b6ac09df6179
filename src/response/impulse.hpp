// SPDX-License-Identifier: MIT
// Impulse at one point between two bodies or clusters: paper section 3.2 with the energy clamp of [13].
//
// Convention: n points from a to b, relative velocity is that of b minus that of a (approaching where its component
// along n is negative), the impulse acts on b at its arm and its negative on a.
#pragma once

#include <optional>

#include "base/axis_locks.hpp"

namespace flotilla {

/// What an impulse sees of a body or cluster. Infinite mass: inverse_mass = 0 and inverse_inertia = 0. What is locked
/// is so along its axes alone: `inverse_mass` is that along the free ones, and `inverse_inertia` has nothing about
/// locked axes.
struct Impulsive {
    double inverse_mass = 0; ///< 1/kg
    Mat3 inverse_inertia;    ///< world axes, about the centre of mass, 1/(kg m^2)
    Vec3 velocity;           ///< of the centre of mass, m/s
    Vec3 angular_velocity;   ///< rad/s
    AxisMask locked = 0;     ///< axes of translation
};

struct ContactPoint {
    Vec3 normal;            ///< unit, from a to b
    Vec3 arm_a, arm_b;      ///< contact point minus centre of mass, m
    Vec3 relative_velocity; ///< of the contact points, b minus a, m/s (effective velocity for swept hits)
    double friction;
};

/// Velocity of the body's point at `arm`.
[[nodiscard]] constexpr Vec3 point_velocity(const Impulsive& body, const Vec3& arm) {
    return body.velocity + cross(body.angular_velocity, arm);
}

/// Change of the velocity of the centre of mass by an impulse.
[[nodiscard]] constexpr Vec3 velocity_change(const Impulsive& body, const Vec3& impulse) {
    return free_part(body.locked, body.inverse_mass * impulse);
}

/// The matrix K = K_a + K_b with change of relative velocity = K impulse.
[[nodiscard]] Mat3 collision_matrix(const Impulsive& a, const Impulsive& b, const Vec3& arm_a, const Vec3& arm_b);

/// n . K n for the normal n of a point, K being its matrix; 0 where neither body can move along n.
[[nodiscard]] double normal_mobility(const Impulsive& a, const Impulsive& b, const ContactPoint& point, const Mat3& k);

/// The impulse (N s, on b) after which the normal relative velocity is `target` (m/s), with friction against the slip
/// of every moment of the impact (frictional_impact.hpp). Nothing where the point is not pushed apart by it (target not
/// above the present normal velocity), or where both bodies have infinite mass.
[[nodiscard]] std::optional<Vec3> contact_impulse(const Impulsive& a, const Impulsive& b, const ContactPoint& point,
                                                  double target);

/// The largest share s in [0, 1] of the impulse that does not raise the kinetic energy of the two bodies (ref. [13]):
/// dE(s) = s b + s^2 a / 2; s = 0 where b >= 0, else min(1, -2b/a). Velocities and inertias are those of the same time.
[[nodiscard]] double energy_clamp(const Impulsive& a, const Impulsive& b, const Vec3& arm_a, const Vec3& arm_b,
                                  const Vec3& impulse);

} // namespace flotilla
