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

/// Where a body is. World vertices are computed from `origin`, the place of the mesh's own origin; `com` is the centre
/// of mass. Neither is rebuilt from the other.
struct Pose {
    Vec3 com;      ///< m
    Quat rotation; ///< unit; mesh axes to world
    Vec3 origin;   ///< m
    friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

struct Motion {
    Vec3 velocity; ///< of the centre of mass, m/s
    /// Angular momentum about the centre of mass, kg m^2/s; of static and kinematic bodies, whose inertia is infinite,
    /// the angular velocity, rad/s. Zero about locked axes.
    Vec3 momentum;
};

/// Vertex indices of a triangle; of a segment, where one is there twice; of a point, where all are the same.
using Triangle = std::array<std::int32_t, 3>;
/// The segment from vertex `a` to vertex `b`, as an element of ShapeDescription::triangles.
[[nodiscard]] constexpr Triangle segment_element(std::int32_t a, std::int32_t b) { return {a, b, b}; }
/// The point at vertex `a`, likewise.
[[nodiscard]] constexpr Triangle point_element(std::int32_t a) { return {a, a, a}; }

} // namespace flotilla
