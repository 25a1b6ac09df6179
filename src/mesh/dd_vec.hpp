// SPDX-License-Identifier: MIT
// Vectors and matrices of double-doubles, for mass properties.
#pragma once

#include <array>
#include <cstddef>

#include "base/vec3.hpp"
#include "mesh/double_double.hpp"

namespace flotilla {

using DdVec3 = std::array<DoubleDouble, 3>;
using DdMat3 = std::array<DdVec3, 3>;

/// a - b exactly.
inline DdVec3 exact_difference(const Vec3& a, const Vec3& b) {
    return {two_sum(a.x, -b.x), two_sum(a.y, -b.y), two_sum(a.z, -b.z)};
}
inline DdVec3 operator+(const DdVec3& a, const DdVec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline DdVec3 operator*(const DoubleDouble& s, const DdVec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline DdVec3& operator+=(DdVec3& a, const DdVec3& b) { return a = a + b; }
inline DoubleDouble dot(const DdVec3& a, const DdVec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline DdVec3 cross(const DdVec3& a, const DdVec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3 to_double(const DdVec3& a) { return {to_double(a[0]), to_double(a[1]), to_double(a[2])}; }

/// m += s a a^T.
inline void add_outer(DdMat3& m, const DoubleDouble& s, const DdVec3& a) {
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) m[i][j] += s * (a[i] * a[j]);
}

/// Twice the area vector of a triangle, from differences taken exactly.
inline DdVec3 doubled_area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
    return cross(exact_difference(b, a), exact_difference(c, a));
}

} // namespace flotilla
