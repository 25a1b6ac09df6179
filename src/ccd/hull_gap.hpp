// SPDX-License-Identifier: MIT
// Planes that keep two bodies apart. Most pairs whose boxes overlap in a pile do not touch: for those a plane between
// their convex hulls is found, or known from the last time, for a fraction of what a traversal costs.
//
// Along a fixed direction a vertex that moves straight is, at any time, at the mean of its two ends weighted by that
// time: where all of b is beyond all of a along it, by some gap at both ends, the bodies are no nearer than the lesser
// gap at any time between.
//
// The direction is found by reflection (Chung and Wang, 1996): where p of a and q of b are the points that a direction
// d separates least, d is turned by -2 (d . r) r, r along q - p.
#pragma once

#include "state/trajectories.hpp"

namespace flotilla {

/// Gaps between the hulls along a direction, m, rounding taken off; negative where there is none known.
struct HullGap {
    double start = -1, end = -1;
};

/// `direction`: tried first where it is not zero; the one found. Ends when both gaps exceed `wanted`, m, or after a few
/// trials with the direction whose lesser gap was largest. Bodies move straight.
[[nodiscard]] HullGap find_hull_gap(const BodyMotion& a, const BodyMotion& b, double wanted, Vec3& direction);

} // namespace flotilla
