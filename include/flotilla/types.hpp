// SPDX-License-Identifier: MIT
// Plain value types of the public interface. They carry no arithmetic: the operations that the guarantee
// depends on live in the library, compiled once with its own flags.
#pragma once

#include <array>
#include <cstdint>

namespace flotilla {

/// A point or a vector, metres unless stated otherwise.
struct Vec3 {
    double x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// A rotation as a unit quaternion, scalar part first: v' = q v q^-1.
struct Quat {
    double w = 1, x = 0, y = 0, z = 0;
    friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

/// A 3x3 matrix in row-major order.
struct Mat3 {
    std::array<double, 9> m{};
    friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
};

/// Vertex indices of a triangle.
using Triangle = std::array<std::int32_t, 3>;

} // namespace flotilla
