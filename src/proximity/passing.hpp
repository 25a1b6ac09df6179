// SPDX-License-Identifier: MIT
// Normals of features that pass each other.
//
// A contact's constraint is linear along its normal (equation 16), which the paper takes where the points are. But
// what is nearest changes on the way of a step. A vertex beside an edge, a corner or an edge along another one see each
// other along a different normal at each place: what slides over the seam of two level tables sees the edge ahead of it
// at its own height, along a normal that points almost back at it, and would be stopped by an edge that it passes at
// its rest distance: a box at 0.1 m/s and 1/24 s for good. A vertex above a face and edges that cross keep their
// normal, but for no longer than they are the nearest: the bevel of that box, which meets the seam's edge, is followed
// by its bottom.
//
// So the points are followed, from feature to feature (the Voronoi regions of Lin and Canny, ICRA 1991), to where they
// come as near as the rest distance, or nearest. The plane to stay beyond is the one across their gap there.
#pragma once

#include "proximity/feature_points.hpp"

namespace flotilla {

/// Where the point of body b is, seen from that of body a.
struct PointGap {
    Vec3 normal;         ///< unit, from a to b
    double distance = 0; ///< m, along it
};

/// `way`: m, of b relative to a. The normal at which it leads what is nearest to `radius` (m) from each other, or where
/// it leads that nearest, and the present distance of the points along it; `now` where the present normal allows the
/// way, or is the one at which they meet.
[[nodiscard]] PointGap gap_on_the_way(const FeaturePair& features, const PosedShape& a, const PosedShape& b,
                                      const Vec3& way, double radius, const PointGap& now);

} // namespace flotilla
