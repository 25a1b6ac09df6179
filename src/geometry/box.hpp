// SPDX-License-Identifier: MIT
// Axis-aligned boxes.
#pragma once

#include <limits>

#include "base/vec3.hpp"

namespace flotilla {

/// All points p with lower <= p <= upper. The default is empty: the neutral element of merged() and extended().
struct Box {
    Vec3 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
               std::numeric_limits<double>::infinity()};
    Vec3 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
               -std::numeric_limits<double>::infinity()};
    friend constexpr bool operator==(const Box&, const Box&) = default;
};
// The moving-box test loads pairs of neighbouring doubles across lower and upper.
static_assert(sizeof(Box) == 6 * sizeof(double));

/// The smallest box that holds both; exact, since minima and maxima do not round.
constexpr Box merged(const Box& a, const Box& b) { return {min(a.lower, b.lower), max(a.upper, b.upper)}; }
constexpr Box extended(const Box& a, const Vec3& p) { return {min(a.lower, p), max(a.upper, p)}; }
/// The box of three points.
constexpr Box box_of(const Vec3& p, const Vec3& q, const Vec3& r) { return {min(min(p, q), r), max(max(p, q), r)}; }
constexpr Vec3 extent(const Box& a) { return a.upper - a.lower; }
constexpr Vec3 center(const Box& a) { return 0.5 * a.lower + 0.5 * a.upper; }
/// The largest magnitude of a coordinate, m.
constexpr double max_abs_coordinate(const Box& a) { return max_component(max(abs(a.lower), abs(a.upper))); }

/// Whether the boxes come within `inflation` of each other along every axis, both boxes taken at rest. Conservative:
/// with exact a - b <= inflation, rounding to nearest is monotone, so fl(a - b) <= inflation. NaN counts as overlap.
constexpr bool boxes_overlap(const Box& a, const Box& b, double inflation) {
    return !((a.lower.x - b.upper.x > inflation) | (b.lower.x - a.upper.x > inflation) |
             (a.lower.y - b.upper.y > inflation) | (b.lower.y - a.upper.y > inflation) |
             (a.lower.z - b.upper.z > inflation) | (b.lower.z - a.upper.z > inflation));
}

} // namespace flotilla
