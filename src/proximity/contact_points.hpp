// SPDX-License-Identifier: MIT
// Contact points of two bodies at rest: feature pairs nearer than d_proximity, pruned (paper, section 4.3.1).
//
// A proximity is kept if each of its two points is, seen from the other to within theta, the nearest of its own body
// nearby: otherwise it is not what touches there (figure 11). Of several faces near a vertex in one direction the
// nearest counts. Edge-edge proximities whose closest point is an end of an edge repeat a vertex-face proximity and are
// left out, and so are those of edges and vertices that lie within a flat face (Topology::salient_edge): floors of many
// triangles touch as one of two. Last, a ray between the points must not cross either body.
//
// Deviation: section 4.3.1 compares with the nearest point of the WHOLE body and keeps one face per vertex. Where a
// body lies in a groove or corner of another, both walls are at the rest distance and only one of them would be a
// contact. The other is then held by dynamic contact alone: the body neither falls nor comes to rest, with a velocity
// near |g| dt/2 for ever.
#pragma once

#include <array>
#include <vector>

#include "ccd/feature_candidates.hpp"
#include "ccd/plane_features.hpp"
#include "ccd/query_aid.hpp"

namespace flotilla {

struct ProximityPoint {
    FeaturePair features;
    Vec3 a, b;           ///< closest points on the two bodies, world, m
    Vec3 normal;         ///< unit, from a to b; of a contact point, that of the flat side it is within theta of
    double distance = 0; ///< m, |b - a|; of a contact point, its part along the normal
    bool flat = false;   ///< of a contact point of a vertex: the normal is that of the flat side that it is on
};

struct PruneCounters {
    std::int64_t proximities = 0; ///< feature pairs within d_proximity
    std::int64_t same_direction = 0, angle = 0, occluded = 0, end_points = 0;

    PruneCounters& operator+=(const PruneCounters& other) {
        proximities += other.proximities;
        same_direction += other.same_direction;
        angle += other.angle;
        occluded += other.occluded;
        end_points += other.end_points;
        return *this;
    }
};

/// Buffers of a proximity query; one per thread, reused.
struct ProximityScratch {
    PruneCounters counters;
    std::vector<ProximityPoint> found, others;
    FeatureBuffer candidates;
    SliceScratch slices;
    std::vector<std::uint8_t> repeats;               ///< flags of points
    std::array<std::vector<std::int32_t>, 2> around; ///< triangles of the two bodies that may decide about a point
};

struct ProximityResult {
    bool near = false;   ///< some feature pair is within d_proximity, kept or not
    double distance = 0; ///< m, of the nearest feature pair; only where near
};

// Bodies are taken at x0, and what is known of them at the end of its motion.

/// Fills scratch.found with the proximities in the order of their feature keys: one face per vertex and direction, no
/// ends of edges. `angle_cos` is the cosine of theta_proximity, here and below.
ProximityResult find_proximities(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                 const QueryAid& aid, ProximityScratch& scratch);

/// Whether there is a feature pair within `proximity`: the field `near` of the above, sooner.
[[nodiscard]] bool any_proximity(const BodyMotion& a, const BodyMotion& b, double proximity, const QueryAid& aid,
                                 ProximityScratch& scratch);

/// Whether a proximity is a contact: the rules of the nearest point and of the ray.
[[nodiscard]] bool admissible(const BodyMotion& a, const BodyMotion& b, const ProximityPoint& point, double angle_cos,
                              ProximityScratch& scratch);

/// Appends the contact points, the proximities that are admissible, one of each place (same_place.hpp), to `out` in the
/// order of their feature keys. Where
/// that is one alone, also the nearest in other directions up to 15 degrees from it, one in each: what stops the bodies
/// where they slide from it.
ProximityResult find_contact_points(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                    const QueryAid& aid, ProximityScratch& scratch, std::vector<ProximityPoint>& out);

/// The contact points of feature pairs that were contacts a little while ago: appends them to `out`, in the order of
/// their feature keys, and sets `distance` to that of the nearest, m. False, and nothing appended, where one of them is
/// none any more: not within `proximity`, at the end of an edge of two, or of a vertex that left its flat side by more
/// than theta, beyond which others carry what it did.
[[nodiscard]] bool renew_contact_points(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                        std::span<const FeaturePair> features, double& distance,
                                        std::vector<ProximityPoint>& out);

/// Where the points of a rigid body go at constant velocities, linearised: x to x + at(x).
struct PointWays {
    Vec3 center, way, turn; ///< m, m, rad
    [[nodiscard]] Vec3 at(const Vec3& x) const { return way + cross(turn, x - center); }
};

/// Two bodies that move, and the distance, m, which their contacts are to keep.
struct PassingBodies {
    PointWays a, b;
    double rest = 0;
    Vec3 across{}; ///< unit, from a to b: where they are known to touch; zero: nowhere. It changes no answer
};

/// As find_contact_points(), but for places, of the feature pairs alone that come nearer than the rest distance, which
/// takes no time where there are none.
void find_passing_points(const BodyMotion& a, const BodyMotion& b, const PassingBodies& passing, double proximity,
                         double angle_cos, ProximityScratch& scratch, std::vector<ProximityPoint>& out);

} // namespace flotilla
