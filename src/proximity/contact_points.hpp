// SPDX-License-Identifier: MIT
// Contact points of two bodies at rest: feature pairs nearer than d_proximity, pruned (paper, section 4.3.1).
//
// A vertex-face proximity is kept for the face nearest to the vertex only. Its foot point is projected back onto the vertex's
// body; if the nearest point there is seen at more than theta from the vertex, the vertex is not what touches (figure 11).
// Edge-edge proximities are tried in the same way from both sides; those whose closest point is an end of an edge repeat a
// vertex-face proximity and are left out. Last, a ray between the points must not cross either body.
#pragma once

#include <vector>

#include "ccd/feature_candidates.hpp"

namespace flotilla {

struct ProximityPoint {
    FeaturePair features;
    Vec3 a, b;           ///< closest points on the two bodies, world, m
    Vec3 normal;         ///< unit, from a to b
    double distance = 0; ///< |b - a|, m
};

struct PruneCounters {
    std::int64_t proximities = 0; ///< feature pairs within d_proximity
    std::int64_t not_nearest = 0, angle = 0, occluded = 0, end_points = 0;
};

/// Buffers of a proximity query; one per thread, reused.
struct ProximityScratch {
    PruneCounters counters;
    std::vector<ProximityPoint> found;
};

struct ProximityResult {
    bool near = false;   ///< some feature pair is within d_proximity, kept or not
    double distance = 0; ///< m, of the nearest feature pair; only where near
};

/// Appends the contact points to `out` in the order of their feature keys. Bodies are taken at x0. `angle_cos` is the cosine of
/// theta_proximity.
ProximityResult find_contact_points(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                    ProximityScratch& scratch, std::vector<ProximityPoint>& out);

} // namespace flotilla
