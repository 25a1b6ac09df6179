// SPDX-License-Identifier: MIT
// Closest points of two triangles, any degeneracy, in double arithmetic: a measurement and a source of directions for
// the sweep, never a proof.
#pragma once

#include <array>

#include "base/vec3.hpp"

namespace flotilla::audit {

using Corners = std::array<Vec3, 3>;

struct ClosestPoints {
    Vec3 on_a, on_b;
    double distance_sq = 0; ///< m^2
};

/// For triangles that do not intersect; for others the distance of their boundaries.
[[nodiscard]] ClosestPoints closest_points(const Corners& a, const Corners& b);

/// Of two segments, which may be points.
[[nodiscard]] ClosestPoints closest_points(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

} // namespace flotilla::audit
