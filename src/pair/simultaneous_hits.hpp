// SPDX-License-Identifier: MIT
// The other points of two bodies that touch when they hit: corners of a face that lands flat.
#pragma once

#include "pair/step_data.hpp"

namespace flotilla {

/// Appends to `out` the vertices of either body that are within `reach` (m) of the hit's plane and of the other body at the time of
/// the hit, and approach it, as contact points with the hit's normal; not the vertices of the hit's own features. Velocities are the
/// rigid ones. Of the hit only the bodies and the time count: 1 for bodies that end the step near each other.
void find_simultaneous_hits(const StepData& data, const ClusterHit& hit, const ContactPoint& first, double reach,
                            std::vector<ContactPoint>& out);

} // namespace flotilla
