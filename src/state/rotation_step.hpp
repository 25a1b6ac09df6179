// SPDX-License-Identifier: MIT
// Rotation of a rigid body over one time step at constant angular momentum: equation 4 of the paper with the energy
// correction of reference [13] (Su, Schroeder, Fedkiw 2009).
//
// The state is (orientation, L); the angular velocity is always R I0^-1 R^T L, so L is exact. Equation 4 alone lets the
// kinetic energy E = L.w/2 drift, by 100 % in 100 s for a fast top at 1/24 s. The correction turns the body once more,
// about s = L x w, by the angle that restores E: L stays, the energy returns to the last bits.
//
// All of it in the body's principal axes, where inertia is three numbers: entries of a tensor in other axes are sums
// in which the part of a slender body's long axis is lost, and with it the energy.
#pragma once

#include "base/rotation.hpp"

namespace flotilla {

/// Principal moments of inertia about the centre of mass, kg m^2, and their inverses; zero where there is no mass.
struct PrincipalInertia {
    Quat axes; ///< rotates principal axes into those of whoever holds this: a mesh's, or the world's
    Vec3 moments, inverse;
};

/// Inertia about the centre of mass in world axes at the start of the step: kg m^2, and its inverse.
struct WorldInertia {
    Mat3 tensor, inverse;
    PrincipalInertia principal; ///< of `tensor`
};

struct RotationStep {
    Quat rotation; ///< takes the orientation at the start to that at the end
    Vec3 vector;   ///< the same as a rotation vector with its whole turns, radians, world axes
};

/// Turns a body of angular momentum `momentum` (kg m^2/s) for dt seconds; its inertia at the start in world axes.
[[nodiscard]] RotationStep rotate_for(const PrincipalInertia& inertia, const Vec3& momentum, double dt);

/// The angular velocity, rad/s, of an angular momentum, and the other way round.
[[nodiscard]] Vec3 angular_velocity(const PrincipalInertia& inertia, const Vec3& momentum);
[[nodiscard]] Vec3 angular_momentum(const PrincipalInertia& inertia, const Vec3& angular_velocity);

/// The principal form of a symmetric positive definite tensor.
[[nodiscard]] PrincipalInertia principal_form(const Mat3& tensor);
/// Both tensors of a principal form, in the axes that it is given in.
[[nodiscard]] WorldInertia world_inertia(const PrincipalInertia& inertia);

/// The rotation vector of q that is nearest to `near`, which may count whole turns.
[[nodiscard]] Vec3 rotation_vector_near(const Quat& q, const Vec3& near);

/// The tensor of a body whose axes at the start of a step have been turned by `rotation`.
[[nodiscard]] Mat3 turned(const Mat3& tensor, const Quat& rotation);
/// The same of a principal form.
[[nodiscard]] PrincipalInertia turned(const PrincipalInertia& inertia, const Quat& rotation);

} // namespace flotilla
