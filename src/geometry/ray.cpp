// SPDX-License-Identifier: MIT
#include "geometry/ray.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/closest.hpp"

namespace flotilla {

namespace {

// Of the height of a point over a triangle's plane, times the triangle's edges: the corners' own rounding moves the
// plane by a few u M (M: largest coordinate), cross and dot products add as much.
constexpr double kHeightNoise = 0x1p-46; // 128 u

double largest_coordinate(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1, const Vec3& f2) {
    return max_component(max(max(abs(p), abs(q)), max(max(abs(f0), abs(f1)), abs(f2))));
}

/// Where the segment crosses, as the signs of volumes have it. Of one in the triangle's plane these are all rounding,
/// and say so now and then of a triangle that lies elsewhere in that plane.
std::optional<double> crossing(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1, const Vec3& f2) {
    const Vec3 n = cross(f1 - f0, f2 - f0);
    const double hp = dot(n, p - f0), hq = dot(n, q - f0);
    if (hp == hq || (hp > 0 && hq > 0) || (hp < 0 && hq < 0)) return std::nullopt;
    // The line passes inside where the volumes spanned with the three edges have one sign.
    const Vec3 d = q - p;
    const double v0 = dot(d, cross(f1 - p, f2 - p)), v1 = dot(d, cross(f2 - p, f0 - p)),
                 v2 = dot(d, cross(f0 - p, f1 - p));
    const bool inside = (v0 >= 0 && v1 >= 0 && v2 >= 0) || (v0 <= 0 && v1 <= 0 && v2 <= 0);
    if (!inside) return std::nullopt;
    return hp / (hp - hq);
}

} // namespace

std::optional<double> segment_triangle(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1, const Vec3& f2) {
    const auto t = crossing(p, q, f0, f1, f2);
    if (!t) return std::nullopt;
    const double rounding = kHeightNoise * largest_coordinate(p, q, f0, f1, f2);
    const auto there = closest_vertex_triangle(p + *t * (q - p), f0, f1, f2);
    return there.distance_sq <= rounding * rounding ? t : std::nullopt;
}

bool segment_pierces(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1, const Vec3& f2, double margin) {
    const auto t = crossing(p, q, f0, f1, f2);
    if (!t || !(*t > margin && *t < 1 - margin)) return false;
    const Vec3 n = cross(f1 - f0, f2 - f0);
    const double noise = kHeightNoise * largest_coordinate(p, q, f0, f1, f2) * length(f1 - f0) * length(f2 - f0);
    return std::abs(dot(n, p - f0)) > noise && std::abs(dot(n, q - f0)) > noise;
}

} // namespace flotilla
