// SPDX-License-Identifier: MIT
// How far a set of points reaches in a direction, in single precision: for bounds that cost little and know their
// error.
#pragma once

#include <span>
#include <vector>

#include "base/vec3.hpp"

namespace flotilla {

struct alignas(16) FourPoints {
    float x[4], y[4], z[4]; ///< m
};

/// Four side by side; the last one fills what is left over. None where they are too large or too small for single
/// precision.
struct SupportPoints {
    std::vector<FourPoints> fours;
    double error = 0; ///< m, more than what any reach() is off
};
[[nodiscard]] SupportPoints support_points(std::span<const Vec3> points);

struct Support {
    double reach = 0;      ///< m, of the farthest point along the direction, to `error`
    std::size_t place = 0; ///< of that point, or of one as far to twice that
};
/// `direction`: a unit vector. There is a point.
[[nodiscard]] Support reach(const SupportPoints& points, const Vec3& direction);

} // namespace flotilla
