// SPDX-License-Identifier: MIT
// One impact at one point with Coulomb's friction against the slip of every moment of it.
#pragma once

#include "base/vec3.hpp"

namespace flotilla {

struct ImpactPoint {
    const Mat3& k;     ///< change of relative velocity = K impulse, 1/kg, symmetric
    Vec3 normal;       ///< unit; n . K n > 0
    double friction;   ///< > 0
    bool semidefinite; ///< K may have directions in which no impulse moves the point
};

/// The impulse, N s, after which the relative velocity u along the normal is `target`, m/s, above that of `velocity`,
/// m/s. By its normal part p, du/dp = K (n - mu t) for the direction t of the slip (Routh, "Dynamics of a system of
/// rigid bodies", 1905; Keller, "Impact with friction", J. Appl. Mech. 53, 1986). Where slip stops friction holds the
/// point if the cone allows that, else the point starts in a direction that it keeps. A jam, in which friction pulls
/// the point in faster than p pushes it out (Painleve), ends when the slip has. Reference [15] takes the slip before
/// the impact all the way: the impulse of a box on one corner is then off by 13 % on average (friction and restitution
/// 0.3, 27 impacts that slide to their end).
[[nodiscard]] Vec3 frictional_impact(const ImpactPoint& point, const Vec3& velocity, double target);

} // namespace flotilla
