// SPDX-License-Identifier: MIT
// How near two moving features come: bounds of their minimum distance over a step, to judge a CCD by. Slow and
// exhaustive.
#pragma once

#include <limits>

#include "geometry/ccd.hpp"

namespace flotilla {

struct DistanceBounds {
    double lower = 0, upper = 0; ///< m; the minimum over t in [0, 1] lies in [lower, upper], rounding included
};

/// When the search may stop.
struct DistanceGoal {
    double tolerance = 0;                                   ///< m: upper - lower <= tolerance, or
    double above = std::numeric_limits<double>::infinity(); ///< m: lower > above, or
    double below = -1;                                      ///< m: upper <= below, or
    int budget = 1'000'000;                                 ///< evaluations used up; the bounds hold all the same
};

/// Branch and bound on t. Every interval gets an upper bound, the distance at its middle, and a lower one: for a unit
/// vector d the distance is at least d . w for every difference w of points of the two features, each d . w of corner
/// points is linear in t, and convex combinations of the corners are the whole features. d is the closest direction at
/// the middle; a poor d costs evaluations, never truth. Both bounds are widened by 64 u M (M: largest coordinate), more
/// than all roundings of an evaluation together. Precondition: finite coordinates below 1e150 m.
[[nodiscard]] DistanceBounds sweep_distance(CcdKind kind, const CcdQuery& query, const DistanceGoal& goal);

} // namespace flotilla
