// SPDX-License-Identifier: MIT
// The face with which a body meets another one, where the features that hit are on its border.
#pragma once

#include <optional>

#include "pair/cluster_query.hpp"

namespace flotilla {

/// The unit normal, from a to b, of a face that touches at the points of a hit and parts, at that time, all faces that
/// touch there of a from those of b, where the hit's own normal does not: the one nearest to that, of those that are
/// within some 7 degrees of it. None where the hit's normal is a face's already.
///
/// At a hit bodies are a separation apart, a fiftieth of a rest distance, or some times that where they turn. Edges
/// that meet along their length, as when boxes land flat on each other, may be a tenth of that aside: the direction
/// from one to the other is then 6 degrees off, and so would be the impulse. Along a normal whose cosine to that is
/// 1 / kHitReach the bodies are as near to each other as the distance of a hit is certain.
[[nodiscard]] std::optional<Vec3> face_of_hit(const StepView& view, const ClusterHit& hit);

} // namespace flotilla
