// SPDX-License-Identifier: MIT
// The other points of two bodies that touch when they hit: corners of a face that lands flat, and where its rim crosses
// that of the other's.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "pair/cluster_query.hpp"
#include "pair/footprint.hpp"

namespace flotilla {

/// Where a body stands on the plane of the hit: appends to `out` its vertices that are within `reach` (m) of the plane,
/// and as near to the other body as the points of the hit are but for that reach; the vertices of a body that does not
/// move which the other one stands on; and the points in which edges of the two on the plane cross, or come as near. Of
/// all these what approaches, as contact points with the hit's normal; not the hit itself. Velocities are the rigid
/// ones. Of the hit only the bodies and the time count: 1 for bodies that end the step near each other. `prints`:
/// scratch.
/// `grounds`: bodies that stand still, on which the body that moves may land as well where the other one of the hit
/// stands still too; points on them have their friction.
void find_simultaneous_hits(const StepView& view, std::array<Footprint, 2>& prints, const ClusterHit& hit,
                            const ContactPoint& first, double reach, std::span<const std::int32_t> grounds,
                            std::vector<ContactPoint>& out);

} // namespace flotilla
