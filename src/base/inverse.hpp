// SPDX-License-Identifier: MIT
// The inverse of a small matrix by its cofactors: accurate relative to its largest entries, not to its smallest.
#pragma once

#include "base/vec3.hpp"

namespace flotilla {

/// The inverse of the transpose; of a symmetric matrix its inverse. Not finite where the matrix is singular.
[[nodiscard]] inline Mat3 inverse_of_transpose(const Mat3& a) {
    const Vec3 r0 = row(a, 0), r1 = row(a, 1), r2 = row(a, 2);
    const Vec3 c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
    const double d = 1 / dot(r0, c0);
    return d * Mat3{{c0.x, c0.y, c0.z, c1.x, c1.y, c1.z, c2.x, c2.y, c2.z}};
}

} // namespace flotilla
