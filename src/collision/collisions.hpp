// SPDX-License-Identifier: MIT
// Stage 1: elastic and partially elastic collisions (paper, section 3, Algorithm 1), as frozen sweeps
// (pair/ordered_sweep.hpp).
//
// Reads x^n and settings; writes the clusters' velocities, the end states and the pairs' records. On return there is no
// hit and no fast end proximity left for which there is an impulse, or the limit of sweeps is reached; the rest is for
// stage 5.
#pragma once

#include "collision/accumulated.hpp"
#include "collision/first_hits.hpp"
#include "collision/grounds.hpp"

namespace flotilla {

/// Kept between steps.
struct CollisionScratch {
    std::vector<ListedPair> active;   ///< sequential: pairs with an impulse in this step, sorted
    std::vector<ListedPair> merged;   ///< scratch of that
    std::vector<std::size_t> hitting; ///< sequential: how many pairs hit, by sweep
    std::vector<double> hardest;      ///< sequential: N s, the largest impulse, by sweep
    HitLists hits;                    ///< accumulated
    Touching touching;
    Grounds grounds; ///< sequential
    FirstHits first; ///< sequential
};

/// `joint`: may be null; else what sweeps do not end is solved together, unless there are to be none.
StageCounters handle_collisions(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                const ContactsAtStart& known, JointSolve* joint, CollisionScratch& scratch);

} // namespace flotilla
