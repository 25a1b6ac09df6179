// SPDX-License-Identifier: MIT
// The separation s of a pair (scene/pair_lengths.hpp) on the way to a proof: what queries ask for, and at which
// multiples of it something is decided. A query proves distances above s and may report a hit a little above it, but
// none of features farther apart than kFeatureReach s. So what is farther apart than a greater multiple may be left
// out, by boxes, lists, directions or bounds, and the answer is the same, whatever the way to it.
#pragma once

#include <algorithm>

#include "geometry/ccd_cubic.hpp"
#include "scene/pair_lengths.hpp"
#include "state/trajectories.hpp"

namespace flotilla {

/// Up to here a query of features may report a hit, where rounding has no more slack (geometry/ccd_kernel.hpp).
inline constexpr double kHitReach = 1 + kSlackOfSeparation;
/// A feature pair counts where its own coarse boxes come so near ...
inline constexpr double kFeatureReach = 1 + 0x1p-6;
/// ... and boxes around features are tried with more, far beyond rounding: so a feature pair that counts is never lost
/// on the way to it, whatever the way.
inline constexpr double kNodeReach = 1 + 0x1p-5;
inline constexpr double kNodeRoom = 0x1p-19; ///< of the largest coordinate: above the rounding of coarse boxes
/// Bodies that start farther apart than this do not start near s: beyond the slack of a hit.
inline constexpr double kNotNear = 1.02;
/// What is proved apart without a query is so by this.
inline constexpr double kClear = 2;
static_assert(kHitReach < kFeatureReach && kFeatureReach < kNotNear && kNotNear < kNodeReach && kNodeReach < kClear);

/// The share of min(d0, d_rest) that the arcs of two turning bodies may take: as much is added to s (rigid_path.hpp).
inline constexpr double kArcShare = 0.1;

/// What a query asks for on straight paths, m: s; of the cubic its tolerance, which is the separation where that is
/// set.
[[nodiscard]] inline double query_separation(const Settings& settings, const PairLengths& lengths, CcdMethod method) {
    if (method == CcdMethod::conservative) return lengths.separation;
    return settings.separation > 0 ? settings.separation : kCubicTolerance;
}

/// The largest that queries of the pair with a neighbour list ask for, of whichever method stage 1 uses and with what
/// arcs take, m.
[[nodiscard]] inline double largest_query_separation(const Settings& settings, const PairLengths& lengths) {
    const double arcs = settings.trajectory == Trajectory::rigid ? kArcShare * lengths.rest : 0.0;
    return std::max(lengths.separation, query_separation(settings, lengths, settings.ccd)) + arcs;
}

/// What a list must reach at any time of the step for queries with a separation, m.
[[nodiscard]] inline double swept_reach(double separation, const BodyMotion& a, const BodyMotion& b) {
    return separation * kNodeReach + kNodeRoom * std::max(a.max_abs(), b.max_abs());
}

} // namespace flotilla
