// SPDX-License-Identifier: MIT
// Rotation of a body with locked axes (base/axis_locks.hpp).
//
// One free axis is a hinge: the body turns about it alone, by dt L / I, and its orientation is a turn about that axis
// of the one that it started with, for ever to one rounding. With two the angular velocity stays in their plane while
// the inertia turns: equation 4 there, corrected so that the energy is kept as in rotation_step.hpp, along the plane.
// Any orientation can be reached so, as a ball that rolls without spinning reaches any. With none the orientation keeps
// its bits.
#pragma once

#include "base/axis_locks.hpp"
#include "state/rigid_shape.hpp"
#include "state/rotation_step.hpp"

namespace flotilla {

/// The inertia of a body at an orientation; the inverse is that of what is free.
[[nodiscard]] WorldInertia world_inertia(const RigidShape& shape, AxisMask locked, const Quat& rotation);

/// rotate_for() with locked axes, of momentum `momentum` about the free ones. The rotation vector has no part along
/// locked axes.
[[nodiscard]] RotationStep rotate_locked(const WorldInertia& inertia, AxisMask locked, const Vec3& momentum, double dt);
/// Whichever of the two it is.
[[nodiscard]] inline RotationStep rotate_free(const WorldInertia& inertia, AxisMask locked, const Vec3& momentum,
                                              double dt) {
    return locked == 0 ? rotate_for(inertia.principal, momentum, dt) : rotate_locked(inertia, locked, momentum, dt);
}

/// The orientation nearest to `rotation` that is a turn of `start` about the only free axis; `start` itself where none
/// is free, and `rotation` where more are.
[[nodiscard]] Quat allowed_rotation(AxisMask locked, const Quat& start, const Quat& rotation);

} // namespace flotilla
