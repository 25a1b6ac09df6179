// SPDX-License-Identifier: MIT
// Rotations: quaternions, matrices, the exponential map, and sine and cosine of our own, because libm's differ between
// systems and the promise of equal bits covers them.
#pragma once

#include "base/vec3.hpp"

namespace flotilla {

struct SinCos {
    double sin, cos;
};

/// Sine and cosine of x (radians, finite). Error below 1 ulp of 1 for |x| < 10^6; beyond it the angle itself is only
/// known to |x| u, and the result is that of the angle reduced modulo the double nearest to 2 pi.
[[nodiscard]] SinCos sin_cos(double x);

/// Product of rotations: (a b) applied to v is a applied to (b applied to v).
[[nodiscard]] Quat operator*(const Quat& a, const Quat& b);
[[nodiscard]] constexpr Quat conjugate(const Quat& q) { return {q.w, -q.x, -q.y, -q.z}; }
[[nodiscard]] double norm(const Quat& q);
/// q / |q|; the identity where q is zero.
[[nodiscard]] Quat normalized(const Quat& q);

/// The rotation by |w| radians about w (the exponential map).
[[nodiscard]] Quat rotation_from_vector(const Vec3& w);
/// The shortest rotation vector of a unit quaternion, |w| <= pi.
[[nodiscard]] Vec3 rotation_vector(const Quat& q);
/// The matrix of a unit quaternion. Orthogonal to a few u where |q| is 1 to a few u.
[[nodiscard]] Mat3 matrix(const Quat& q);
/// The unit quaternion of a rotation matrix (largest-component form, w >= 0).
[[nodiscard]] Quat quaternion(const Mat3& r);
/// q v q^-1 for a unit quaternion.
[[nodiscard]] Vec3 rotate(const Quat& q, const Vec3& v);

} // namespace flotilla
