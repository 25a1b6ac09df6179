// SPDX-License-Identifier: MIT
#include "audit/triangle_distance.hpp"

#include <algorithm>
#include <limits>

namespace flotilla::audit {
namespace {

double clamp01(double t) { return t > 0 ? std::min(t, 1.0) : 0.0; } // NaN: 0

/// Parameter of the point of segment p, p + d that is closest to x.
double closest_parameter(const Vec3& x, const Vec3& p, const Vec3& d) {
    const double dd = dot(d, d);
    return dd > 0 ? clamp01(dot(x - p, d) / dd) : 0;
}

ClosestPoints make(const Vec3& p, const Vec3& q) { return {p, q, length_sq(p - q)}; }

/// Vertex and the inside of a triangle; infinite where the vertex does not project into it.
double vertex_face(const Vec3& x, const Corners& f, Vec3& foot) {
    const Vec3 n = cross(f[1] - f[0], f[2] - f[0]);
    const double nn = dot(n, n);
    if (!(nn > 0)) return std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k)
        if (dot(cross(f[(k + 1) % 3] - f[k], x - f[k]), n) < 0) return std::numeric_limits<double>::infinity();
    foot = x - (dot(x - f[0], n) / nn) * n;
    return length_sq(x - foot);
}

} // namespace

/// Segments p + s d and q + t e: the minimum of a convex quadratic over the unit square, at the inner stationary point
/// after clamping s, or with s = 0 or s = 1.
ClosestPoints closest_points(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
    const Vec3 &p = a[0], &q = b[0];
    const Vec3 d = a[1] - p, e = b[1] - q, r = p - q;
    const double dd = dot(d, d), de = dot(d, e), ee = dot(e, e);
    const double determinant = dd * ee - de * de;
    ClosestPoints best{{}, {}, std::numeric_limits<double>::infinity()};
    const auto consider = [&](double s) {
        const Vec3 x = p + s * d;
        const double t = closest_parameter(x, q, e);
        const Vec3 y = q + t * e;
        const ClosestPoints candidate = make(p + closest_parameter(y, p, d) * d, y);
        if (candidate.distance_sq < best.distance_sq) best = candidate;
    };
    consider(0);
    consider(1);
    if (determinant > 0) consider(clamp01((de * dot(e, r) - ee * dot(d, r)) / determinant));
    return best;
}

ClosestPoints closest_points(const Corners& a, const Corners& b) {
    ClosestPoints best{a[0], b[0], length_sq(a[0] - b[0])};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            const auto candidate = closest_points(std::array{a[i], a[(i + 1) % 3]}, std::array{b[j], b[(j + 1) % 3]});
            if (candidate.distance_sq < best.distance_sq) best = candidate;
        }
        Vec3 foot;
        if (const double d = vertex_face(a[i], b, foot); d < best.distance_sq) best = {a[i], foot, d};
        if (const double d = vertex_face(b[i], a, foot); d < best.distance_sq) best = {foot, b[i], d};
    }
    return best;
}

} // namespace flotilla::audit
