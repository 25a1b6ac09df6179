// SPDX-License-Identifier: MIT
// Stage 1 with `collisions: accumulated`: rounds of queries over all pairs that moved, in any order. After each, the
// hits met so far in the step are solved together (response/kept_hits.hpp), and the bodies that this changed move
// again. It ends when a round finds nothing.
//
// A round reads x^n and the bodies' motions and writes the records of its pairs, one task each; islands of hits share
// no movable body; hits are kept in the order of bodies, then of rounds. So the bits are the same at any number of
// threads.
#pragma once

#include <span>

#include "collision/late_hits.hpp"
#include "islands/contact_graph.hpp"
#include "pair/impulses.hpp"
#include "pair/joint_hits.hpp"
#include "pair/pair_lists.hpp"
#include "response/kept_hits.hpp"
#include "state/contact.hpp"

namespace flotilla {

/// Hits that are kept in a step, and buffers.
struct HitLists {
    std::vector<KeptHit> hits;         ///< sorted by bodies
    std::vector<FoundHit> found;       ///< by the last round
    std::vector<BodyPair> bodies_of;   ///< of each hit
    std::vector<std::int32_t> island;  ///< of each hit
    std::vector<std::int32_t> places;  ///< in `hits`, by island
    std::vector<std::int32_t> begin;   ///< in `places`, of each island, and the end
    std::vector<std::int32_t> moved;   ///< bodies
    std::vector<std::uint8_t> used;    ///< by body
    std::vector<std::uint8_t> movable; ///< by body
    HitBodies bodies;
    ContactGraphScratch graph;
};

/// `joint`: may be null; else what the solves of islands do not end is solved together.
StageCounters accumulate_collisions(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                    const ContactsAtStart& known, const Touching& touching, JointSolve* joint,
                                    HitLists& lists);

} // namespace flotilla
