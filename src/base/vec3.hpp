// SPDX-License-Identifier: MIT
// Arithmetic of three-component vectors. Every sum is written in one fixed order, (x + y) + z, because the same bits
// are promised from every compiler and at every vector width.
#pragma once

#include <algorithm>
#include <cmath>

#include <flotilla/types.hpp>

namespace flotilla {

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Vec3 operator*(const Vec3& a, double s) { return s * a; }
constexpr Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
constexpr Vec3& operator+=(Vec3& a, const Vec3& b) { return a = a + b; }
constexpr Vec3& operator-=(Vec3& a, const Vec3& b) { return a = a - b; }
constexpr Vec3& operator*=(Vec3& a, double s) { return a = s * a; }

constexpr double dot(const Vec3& a, const Vec3& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr double length_sq(const Vec3& a) { return dot(a, a); }
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// The unit vector along a, or zero where a is zero.
inline Vec3 normalized(const Vec3& a) {
    const double l = length(a);
    return l > 0 ? a / l : Vec3{};
}

constexpr Vec3 min(const Vec3& a, const Vec3& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
constexpr Vec3 max(const Vec3& a, const Vec3& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
constexpr Vec3 abs(const Vec3& a) { return {a.x < 0 ? -a.x : a.x, a.y < 0 ? -a.y : a.y, a.z < 0 ? -a.z : a.z}; }
constexpr double max_component(const Vec3& a) { return std::max(std::max(a.x, a.y), a.z); }
inline bool is_finite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// Coordinate 0, 1 or 2.
constexpr double component(const Vec3& a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

constexpr Mat3 identity() { return {{1, 0, 0, 0, 1, 0, 0, 0, 1}}; }
constexpr Mat3 diagonal(const Vec3& d) { return {{d.x, 0, 0, 0, d.y, 0, 0, 0, d.z}}; }
constexpr Vec3 row(const Mat3& a, int i) {
    const auto k = static_cast<std::size_t>(3 * i);
    return {a.m[k], a.m[k + 1], a.m[k + 2]};
}
constexpr Vec3 operator*(const Mat3& a, const Vec3& v) {
    return {dot(row(a, 0), v), dot(row(a, 1), v), dot(row(a, 2), v)};
}
constexpr Mat3 transpose(const Mat3& a) {
    return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    const Mat3 bt = transpose(b);
    Mat3 c;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) c.m[static_cast<std::size_t>(3 * i + j)] = dot(row(a, i), row(bt, j));
    return c;
}
constexpr Mat3 operator+(const Mat3& a, const Mat3& b) {
    Mat3 c;
    for (std::size_t i = 0; i < 9; ++i) c.m[i] = a.m[i] + b.m[i];
    return c;
}
constexpr Mat3 operator-(const Mat3& a, const Mat3& b) {
    Mat3 c;
    for (std::size_t i = 0; i < 9; ++i) c.m[i] = a.m[i] - b.m[i];
    return c;
}
constexpr Mat3 operator*(double s, const Mat3& a) {
    Mat3 c;
    for (std::size_t i = 0; i < 9; ++i) c.m[i] = s * a.m[i];
    return c;
}
/// The matrix [a]x with [a]x b = a x b.
constexpr Mat3 cross_matrix(const Vec3& a) { return {{0, -a.z, a.y, a.z, 0, -a.x, -a.y, a.x, 0}}; }

} // namespace flotilla
