// SPDX-License-Identifier: MIT
// Segment-triangle test for the occlusion rule of contact points (paper, section 4.3.1).
#pragma once

#include <optional>

#include "base/vec3.hpp"

namespace flotilla {

/// The parameter t in [0, 1] at which the segment p + t (q - p) crosses the triangle, boundary included; nothing where
/// it does not or where segment and triangle are parallel (a coplanar segment does not count). Not exact, but what it
/// returns is a place on both, to rounding.
[[nodiscard]] std::optional<double> segment_triangle(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1,
                                                     const Vec3& f2);

/// Whether the segment crosses the inside of the triangle at some t in (margin, 1 - margin), told apart from rounding:
/// an end that is in the triangle's plane to within rounding does not cross it. For segments that end on the very
/// surface that is asked about: where they run along one of its faces, segment_triangle would divide noise by noise.
[[nodiscard]] bool segment_pierces(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1, const Vec3& f2,
                                   double margin);

} // namespace flotilla
