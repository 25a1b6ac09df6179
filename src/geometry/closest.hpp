// SPDX-License-Identifier: MIT
// Closest points of features: vertex-triangle, edge-edge, triangle-triangle.
#pragma once

#include <array>
#include <limits>

#include "base/vec3.hpp"

namespace flotilla {

/// Closest point of a triangle to a vertex: q = b[0] f0 + b[1] f1 + b[2] f2.
struct VertexTriangleClosest {
    std::array<double, 3> barycentric; ///< >= 0, sum 1 to rounding
    Vec3 point;                        ///< q, on the triangle
    double distance_sq;                ///< |v - q|^2, m^2
};

/// Closest points of two segments: p = a0 + s (a1 - a0), q = b0 + t (b1 - b0).
struct EdgeEdgeClosest {
    double s, t; ///< in [0, 1]
    Vec3 p, q;
    double distance_sq; ///< |p - q|^2, m^2
};

/// Closest points of two triangles. Where they intersect the distance is zero and p = q is one common point, up to
/// rounding: the exact answer to "do they intersect" is geometry/exact's.
struct TriangleTriangleClosest {
    Vec3 p, q; ///< on the first, on the second
    double distance_sq;
};

/// All three accept any degeneracy: zero-area triangles, zero-length edges, equal points.
[[nodiscard]] VertexTriangleClosest closest_vertex_triangle(const Vec3& v, const Vec3& f0, const Vec3& f1,
                                                            const Vec3& f2);
[[nodiscard]] EdgeEdgeClosest closest_edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);
[[nodiscard]] TriangleTriangleClosest closest_triangle_triangle(const std::array<Vec3, 3>& a,
                                                                const std::array<Vec3, 3>& b);

/// The direction of `d`, the difference of the closest points of a vertex and a face with the edges e and f, or of the
/// edges e and f. Of points much nearer to each other than to the origin it is that of rounding: then that of the
/// features' common normal, where d is normal to them but for rounding. `largest`: no coordinate of the corners is
/// larger.
[[nodiscard]] Vec3 direction_between(const Vec3& d, double largest, const Vec3& e, const Vec3& f);

} // namespace flotilla
