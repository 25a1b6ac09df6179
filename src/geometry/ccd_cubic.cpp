// SPDX-License-Identifier: MIT
#include "geometry/ccd_cubic.hpp"

#include "geometry/closest.hpp"

#include <cmath>
#include <utility>

namespace flotilla {
namespace {

/// c[0] + c[1] t + c[2] t^2 + c[3] t^3.
using Cubic = std::array<double, 4>;

double evaluate(const Cubic& c, double t) { return ((c[3] * t + c[2]) * t + c[1]) * t + c[0]; }

/// The signed volume of the four points, times 6: [x1 - x0, x2 - x0, x3 - x0] with x_i(t) = x_i + v_i t.
Cubic coplanarity(const CcdQuery& q) {
    std::array<Vec3, 3> x, v;
    for (std::size_t i = 0; i < 3; ++i) {
        x[i] = q.x0[i + 1] - q.x0[0];
        v[i] = (q.x1[i + 1] - q.x1[0]) - x[i];
    }
    const Vec3 xx = cross(x[1], x[2]), vv = cross(v[1], v[2]);
    const Vec3 xv = cross(x[1], v[2]) + cross(v[1], x[2]);
    return {dot(x[0], xx), dot(x[0], xv) + dot(v[0], xx), dot(x[0], vv) + dot(v[0], xv), dot(v[0], vv)};
}

/// Roots found so far, ascending.
struct Roots {
    std::array<double, 5> t{};
    std::size_t count = 0;
    void add(double root) { t[count++] = root; }
};

/// The times in (0, 1) where the derivative vanishes, ascending: the cubic is monotone between them.
Roots turning_points(const Cubic& c) {
    const double a = 3 * c[3], b = 2 * c[2], d = b * b - 4 * a * c[1];
    Roots roots;
    if (!(d >= 0)) return roots;
    // The stable form of the quadratic formula; infinite or NaN candidates fail the comparisons below.
    const double q = -0.5 * (b + std::copysign(std::sqrt(d), b));
    std::array<double, 2> candidates{q / a, c[1] / q};
    if (candidates[1] < candidates[0]) std::swap(candidates[0], candidates[1]);
    for (const double t : candidates)
        if (t > 0 && t < 1) roots.add(t);
    return roots;
}

/// The root between low and high, where the cubic has opposite signs, by bisection: to the last bit, or to 2^-60 where
/// the root is smaller than that.
double bracketed_root(const Cubic& c, double low, double high) {
    const bool rising = evaluate(c, low) < 0;
    for (;;) {
        const double mid = 0.5 * (low + high);
        if (mid <= low || mid >= high || high < 0x1p-60) return low;
        ((evaluate(c, mid) < 0) == rising ? low : high) = mid;
    }
}

/// Roots in [0, 1] in ascending order; none where the cubic is identically zero.
Roots roots_in_step(const Cubic& c) {
    Roots roots;
    if (c[0] == 0 && c[1] == 0 && c[2] == 0 && c[3] == 0) return roots;
    Roots ends = turning_points(c);
    ends.add(1);
    double low = 0, value_low = evaluate(c, 0);
    if (value_low == 0) roots.add(0);
    for (std::size_t i = 0; i < ends.count; ++i) {
        const double high = ends.t[i], value_high = evaluate(c, high);
        if (value_high == 0)
            roots.add(high);
        else if (value_low != 0 && (value_low < 0) != (value_high < 0))
            roots.add(bracketed_root(c, low, high));
        low = high;
        value_low = value_high;
    }
    return roots;
}

/// Shortest vector from the second feature to the first at t.
Vec3 shortest(CcdKind kind, const CcdQuery& q, double t) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = (1 - t) * q.x0[i] + t * q.x1[i];
    if (kind == CcdKind::vertex_face) return x[0] - closest_vertex_triangle(x[0], x[1], x[2], x[3]).point;
    const EdgeEdgeClosest c = closest_edge_edge(x[0], x[1], x[2], x[3]);
    return c.p - c.q;
}

} // namespace

CcdResult ccd_cubic(CcdKind kind, const CcdQuery& query, double tolerance) {
    Roots times = roots_in_step(coplanarity(query));
    times.add(1);
    CcdResult result;
    for (std::size_t i = 0; i < times.count; ++i) {
        const Vec3 d = shortest(kind, query, times.t[i]);
        ++result.iterations;
        if (length(d) <= tolerance) {
            result.direction = normalized(d);
            result.toi = times.t[i];
            return result;
        }
    }
    result.hit = false;
    return result;
}

} // namespace flotilla
