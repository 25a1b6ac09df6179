// SPDX-License-Identifier: MIT
// Normals of features that pass each other.
//
// A contact's constraint is linear along its normal (equation 16), which the paper takes where the points are. That is
// the only one for a vertex above a face and for edges that cross. A vertex beside an edge, a corner or an edge along
// another one has a different one at each place of its way: what slides over the seam of two level tables sees the edge
// ahead of it at its own height, along a normal that points almost back at it, and would be stopped by an edge that it
// passes at its rest distance: a box at 0.1 m/s and 1/24 s for good.
//
// To stay `radius` from an edge is to stay out of a cylinder around it, from a corner out of a ball. The plane to stay
// beyond is the one that touches it where the way of the step enters, or comes nearest, or goes on to another feature:
// an edge ends at its faces, a corner at its edges, and there the normals of both are the same.
#pragma once

#include "state/feature_pair.hpp"
#include "state/model.hpp"

namespace flotilla {

/// A body's shape at a pose.
struct PlacedShape {
    const RigidShape& shape;
    const Pose& pose;
};

/// Where the point of body b is, seen from that of body a.
struct PointGap {
    Vec3 normal;         ///< unit, from a to b
    double distance = 0; ///< m, along it
};

/// `way`: m, of the point of b relative to that of a. The normal at which it leads the points to `radius` (m) from each
/// other, or where it leads them nearest, and their present distance along that; `now` where the features have one
/// normal alone, or where that one allows the way.
[[nodiscard]] PointGap gap_on_the_way(const FeaturePair& features, const PlacedShape& a, const PlacedShape& b,
                                      const Vec3& way, double radius, const PointGap& now);

} // namespace flotilla
