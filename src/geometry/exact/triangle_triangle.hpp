// SPDX-License-Identifier: MIT
// Exact intersection tests of closed triangles and segments: is there a common point of the two point sets whose
// corners are the given doubles? Touching counts. Every degeneracy is accepted: a triangle with collinear corners is
// the segment they span, one with equal corners a point. Symmetric in the arguments and in the order of the corners,
// because the answer is that of real arithmetic.
// Preconditions: finite coordinates, rounding to nearest.
#pragma once

#include <algorithm>
#include <array>

#include "base/vec3.hpp"

namespace flotilla::exact {

/// Whether the bounding boxes of two sets of points have no common point. Exact: comparisons only.
template <std::size_t N, std::size_t M>
[[nodiscard]] bool boxes_disjoint(const std::array<Vec3, N>& a, const std::array<Vec3, M>& b) {
    Vec3 a_low = a[0], a_high = a[0], b_low = b[0], b_high = b[0];
    for (const Vec3& p : a) a_low = min(a_low, p), a_high = max(a_high, p);
    for (const Vec3& p : b) b_low = min(b_low, p), b_high = max(b_high, p);
    return a_high.x < b_low.x || b_high.x < a_low.x || a_high.y < b_low.y || b_high.y < a_low.y || a_high.z < b_low.z ||
           b_high.z < a_low.z;
}

/// The tests without the bounding boxes, for callers that have compared them already.
[[nodiscard]] bool triangles_intersect_unboxed(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);
[[nodiscard]] bool segment_intersects_triangle_unboxed(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t);

[[nodiscard]] inline bool triangles_intersect(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    return !boxes_disjoint(a, b) && triangles_intersect_unboxed(a, b);
}

/// The segment is closed and may be a single point (p = q).
[[nodiscard]] inline bool segment_intersects_triangle(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
    return !boxes_disjoint(std::array{p, q}, t) && segment_intersects_triangle_unboxed(p, q, t);
}

} // namespace flotilla::exact
