// SPDX-License-Identifier: MIT
// Hits of stage 1 solved together (pair/joint_hits.hpp), where sweeps or rounds do not end them: what falls on a light
// body that lies on the ground, or between heavy ones.
#pragma once

#include "collision/late_hits.hpp"
#include "pair/impulses.hpp"
#include "pair/joint_hits.hpp"
#include "pair/pair_lists.hpp"

namespace flotilla {

/// Hits of an island that are solved together.
inline constexpr std::ptrdiff_t kMostCollisionsTogether = 64;

/// Without rebounds: bodies that bounce on each other without end in no time end so, where they lose something each
/// time (inelastic collapse). Those of pairs with more than `most_restitution` have not come to that, and are left.
/// Whether nothing hits any more; what does is stage 5's. `bodies`: flags by body; with whom it begins, who take in
/// those that they hit. `found`: scratch; `counters`: added to.
[[nodiscard]] bool collide_together(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                    JointSolve& joint, const Touching& touching, std::vector<std::uint8_t> bodies,
                                    double most_restitution, std::vector<FoundHit>& found, StageCounters& counters);

} // namespace flotilla
