// SPDX-License-Identifier: MIT
#include "geometry/closest.hpp"

#include <algorithm>

#include "geometry/ray.hpp"

namespace flotilla {
namespace {

double clamp01(double t) { return t < 0 ? 0.0 : t > 1 ? 1.0 : t; }

/// Parameter of the point of segment a + t e nearest to p; 0 where the segment is a point.
double segment_parameter(const Vec3& p, const Vec3& a, const Vec3& e) {
    const double ee = length_sq(e);
    return ee > 0 ? clamp01(dot(p - a, e) / ee) : 0.0;
}

} // namespace

VertexTriangleClosest closest_vertex_triangle(const Vec3& v, const Vec3& f0, const Vec3& f1, const Vec3& f2) {
    // The nearest point is interior to the face or on one of the three edges. The edges are always right; the face is
    // taken only where the foot of the perpendicular lies inside and comes out nearer, so a needle's useless normal
    // does no harm.
    const std::array<const Vec3*, 3> f{&f0, &f1, &f2};
    VertexTriangleClosest best{{1, 0, 0}, f0, length_sq(v - f0)};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const Vec3 e = *f[j] - *f[i];
        const double t = segment_parameter(v, *f[i], e);
        const Vec3 q = *f[i] + t * e;
        const double d = length_sq(v - q);
        if (d < best.distance_sq) {
            best = {{0, 0, 0}, q, d};
            best.barycentric[i] = 1 - t;
            best.barycentric[j] = t;
        }
    }
    const Vec3 n = cross(f1 - f0, f2 - f0);
    const double nn = length_sq(n);
    const double b0 = dot(n, cross(f1 - v, f2 - v));
    const double b1 = dot(n, cross(f2 - v, f0 - v));
    const double b2 = dot(n, cross(f0 - v, f1 - v));
    if (nn > 0 && b0 >= 0 && b1 >= 0 && b2 >= 0) {
        const double sum = b0 + b1 + b2;
        const Vec3 q = f0 + (b1 / sum) * (f1 - f0) + (b2 / sum) * (f2 - f0);
        const double d = length_sq(v - q);
        if (sum > 0 && d < best.distance_sq) best = {{b0 / sum, b1 / sum, b2 / sum}, q, d};
    }
    return best;
}

EdgeEdgeClosest closest_edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
    const Vec3 ea = a1 - a0, eb = b1 - b0;
    EdgeEdgeClosest best{};
    best.distance_sq = std::numeric_limits<double>::infinity();
    const auto offer = [&](double s, double t) {
        const Vec3 p = s == 1 ? a1 : a0 + s * ea;
        const Vec3 q = t == 1 ? b1 : b0 + t * eb;
        const double d = length_sq(p - q);
        if (d < best.distance_sq) best = {s, t, p, q, d};
    };
    offer(0, segment_parameter(a0, b0, eb));
    offer(1, segment_parameter(a1, b0, eb));
    offer(segment_parameter(b0, a0, ea), 0);
    offer(segment_parameter(b1, a0, ea), 1);
    // Both points interior: foot points of the common perpendicular n of the two lines.
    const Vec3 n = cross(ea, eb);
    const double nn = length_sq(n);
    if (nn > 0) {
        const Vec3 w = b0 - a0;
        const double s = dot(cross(w, eb), n) / nn;
        const double t = dot(cross(w, ea), n) / nn;
        if (s > 0 && s < 1 && t > 0 && t < 1) offer(s, t);
    }
    return best;
}

TriangleTriangleClosest closest_triangle_triangle(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    TriangleTriangleClosest best{a[0], b[0], length_sq(a[0] - b[0])};
    const auto offer = [&](const Vec3& p, const Vec3& q, double d) {
        if (d < best.distance_sq) best = {p, q, d};
    };
    // Where the triangles are apart, a closest pair is vertex-triangle or edge-edge.
    for (std::size_t i = 0; i < 3; ++i) {
        const auto onto_b = closest_vertex_triangle(a[i], b[0], b[1], b[2]);
        offer(a[i], onto_b.point, onto_b.distance_sq);
        const auto onto_a = closest_vertex_triangle(b[i], a[0], a[1], a[2]);
        offer(onto_a.point, b[i], onto_a.distance_sq);
        for (std::size_t j = 0; j < 3; ++j) {
            const auto e = closest_edge_edge(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]);
            offer(e.p, e.q, e.distance_sq);
        }
    }
    // Where they cross, an edge of one passes through the other.
    for (std::size_t i = 0; i < 3 && best.distance_sq > 0; ++i) {
        if (const auto t = segment_triangle(a[i], a[(i + 1) % 3], b[0], b[1], b[2])) {
            const Vec3 x = a[i] + *t * (a[(i + 1) % 3] - a[i]);
            offer(x, x, 0);
        } else if (const auto s = segment_triangle(b[i], b[(i + 1) % 3], a[0], a[1], a[2])) {
            const Vec3 x = b[i] + *s * (b[(i + 1) % 3] - b[i]);
            offer(x, x, 0);
        }
    }
    return best;
}

Vec3 direction_between(const Vec3& d, double largest, const Vec3& e, const Vec3& f) {
    // Closest points are off by a few units of 2^-53 of the largest coordinate: nearer than kNear, their difference by
    // 2^-37 rad or more, which an exact contact solve takes for real (kOfSpeed). Two walls close beside a body then
    // make a wedge that holds it. The floor of the CCD is 8 times kRounding.
    // Besides, squares of distances do not tell a foot beside an edge from the edge, and the point of the edge is taken
    // for closest; that turns d by the root of what they are rounded by.
    constexpr double kNear = 0x1p-16, kRounding = 0x1p-46, kOfSquares = 0x1p-34;
    const double square = length_sq(d), near = kNear * largest, rounding = kRounding * largest;
    if (!(square < near * near)) return normalized(d);
    const Vec3 n = cross(e, f);
    const double nn = length_sq(n), along = dot(d, n);
    // The corners' rounding turns n by its share of |n| / max(|e|, |f|), and d by its share of |d|.
    if (!(nn > square * std::max(length_sq(e), length_sq(f)))) return normalized(d);
    if (!(length_sq(d - (along / nn) * n) <= std::max(rounding * rounding, kOfSquares * square))) return normalized(d);
    return normalized(along < 0 ? -n : n);
}

} // namespace flotilla
