// SPDX-License-Identifier: MIT
// Directions along which two moving sets of points stay apart (see audit/sweep.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/vec3.hpp"

namespace flotilla::audit {

/// What lies between computed points, moved linearly from one end of an interval to the other, and those on the true
/// paths.
struct Slack {
    double straying; ///< m, of a point of either set together, in any direction
    double rounding; ///< m, of one coordinate, in a difference of two points and in its product with a direction
};

struct Span {
    double low, high;
};
template <std::size_t N>
[[nodiscard]] Span project(const std::array<Vec3, N>& points, const Vec3& d) {
    Span span{dot(points[0], d), dot(points[0], d)};
    for (std::size_t k = 1; k < N; ++k) {
        const double x = dot(points[k], d);
        span = {std::min(span.low, x), std::max(span.high, x)};
    }
    return span;
}

/// Points a and b, at the start (s) and the end (e) of an interval, are apart along d throughout. NaN is not apart.
template <std::size_t M, std::size_t N>
[[nodiscard]] bool separated(const Vec3& d, const std::array<Vec3, M>& a_s, const std::array<Vec3, N>& b_s,
                             const std::array<Vec3, M>& a_e, const std::array<Vec3, N>& b_e, const Slack& slack) {
    const double norm_1 = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
    const double margin = 1.0001 * length(d) * slack.straying + slack.rounding * norm_1;
    const Span as = project(a_s, d), bs = project(b_s, d), ae = project(a_e, d), be = project(b_e, d);
    return (bs.low - as.high > margin && be.low - ae.high > margin) ||
           (as.low - bs.high > margin && ae.low - be.high > margin);
}

/// The same along a direction that goes straight from d_s to d_e. Each difference of two points along it is a quadratic
/// in time, which is at least the least of its Bernstein coefficients; the direction is never longer than the longer of
/// both.
template <std::size_t M, std::size_t N>
[[nodiscard]] bool separated_on_the_way(const Vec3& d_s, const Vec3& d_e, const std::array<Vec3, M>& a_s,
                                        const std::array<Vec3, N>& b_s, const std::array<Vec3, M>& a_e,
                                        const std::array<Vec3, N>& b_e, const Slack& slack) {
    const auto norm_1 = [](const Vec3& d) { return std::abs(d.x) + std::abs(d.y) + std::abs(d.z); };
    const double margin = 1.0001 * std::max(length(d_s), length(d_e)) * slack.straying +
                          slack.rounding * std::max(norm_1(d_s), norm_1(d_e));
    const auto middle = [&](const auto& at_s, const auto& at_e) {
        const auto value = [&](std::size_t k) { return 0.5 * (dot(at_e[k], d_s) + dot(at_s[k], d_e)); };
        Span span{value(0), value(0)};
        for (std::size_t k = 1; k < at_s.size(); ++k)
            span = {std::min(span.low, value(k)), std::max(span.high, value(k))};
        return span;
    };
    const std::array as{project(a_s, d_s), middle(a_s, a_e), project(a_e, d_e)},
        bs{project(b_s, d_s), middle(b_s, b_e), project(b_e, d_e)};
    bool ahead = true, behind = true;
    for (std::size_t k = 0; k < 3; ++k) {
        ahead = ahead && bs[k].low - as[k].high > margin;
        behind = behind && as[k].low - bs[k].high > margin;
    }
    return ahead || behind;
}

/// d scaled to a largest component of 1, so that nothing over- or underflows; zero where it cannot be.
[[nodiscard]] inline Vec3 scaled(const Vec3& d) {
    const double m = max_component(abs(d));
    return m > 0 && std::isfinite(m) ? d / m : Vec3{};
}

/// The part of d across u.
[[nodiscard]] inline Vec3 without(const Vec3& d, const Vec3& u) {
    const double uu = dot(u, u);
    if (!(uu > 0)) return d;
    const Vec3 once = d - (dot(d, u) / uu) * u;
    return once - (dot(once, u) / uu) * u; // what the first time left by rounding
}

/// A vector across u and v: along each of them it has no more than a rounding of its own length, also where they are
/// nearly parallel, where u x v is all rounding. Zero where they are parallel.
[[nodiscard]] inline Vec3 across(const Vec3& u, const Vec3& v) {
    const Vec3 a = scaled(u), b = without(scaled(v), a);
    return without(without(cross(a, scaled(b)), a), b);
}

} // namespace flotilla::audit
