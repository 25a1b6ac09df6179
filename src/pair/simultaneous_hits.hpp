// SPDX-License-Identifier: MIT
// The other points of two bodies that touch when they hit: corners of a face that lands flat.
#pragma once

#include "pair/cluster_query.hpp"

namespace flotilla {

/// Where a body stands on the plane of the hit: appends to `out` its vertices that are within `reach` (m) of the plane,
/// and as near to the other body as the points of the hit are but for that reach, and approach it, as contact points
/// with the hit's normal; not the hit itself. Velocities are the rigid ones. Of the hit only the bodies and the time
/// count: 1 for bodies that end the step near each other. `feet`: scratch.
void find_simultaneous_hits(const StepView& view, std::vector<Vec3>& feet, const ClusterHit& hit,
                            const ContactPoint& first, double reach, std::vector<ContactPoint>& out);

} // namespace flotilla
