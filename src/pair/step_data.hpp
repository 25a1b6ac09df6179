// SPDX-License-Identifier: MIT
// What a stage of a step is handed.
#pragma once

#include "pair/impulses.hpp"
#include "pair/neighbour_lists.hpp"
#include "pair/pair_distance.hpp"
#include "pair/pair_lists.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// A stage runs on one thread and may change all of this. What it runs side by side takes the parts that it reads and
/// writes: the view, the record of its own pair, its thread's worker, and the movers of its own clusters.
struct StepData : StepView {
    Movers movers; ///< the view's clusters and trajectories, to be changed
    PairTable& pairs;
    PairFinder& broadphase;
    ListBuffers& lists;
    Team& team;
    Workers& workers;

    [[nodiscard]] Worker& worker(int thread) { return *workers[static_cast<std::size_t>(thread)]; }
};

} // namespace flotilla
