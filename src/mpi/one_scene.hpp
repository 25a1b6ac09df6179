// SPDX-License-Identifier: MIT
// One scene over all ranks.
//
// Rank 0 makes the run, with its folder; the others start from its snapshot and step along. Every rank holds the whole
// scene, and the expensive loops of a step are divided (parallel/division.hpp). After every step the state hashes of
// all ranks are compared: the state that rank 0 writes is one on which all agree.
#pragma once

#include <string>

#include <flotilla/run.hpp>

#include "mpi/session.hpp"
#include "parallel/ranks.hpp"

namespace flotilla::mpi {

struct OneScene {
    const SceneDescription& scene;
    std::string source; ///< names it in messages
    RunOptions run;     ///< of rank 0; the others take the number of threads from it
};

struct OneSceneTotals {
    RunTotals run; ///< of rank 0
    RankTraffic traffic;
    double imbalance = 1; ///< at the end: the most that a rank had to do by the mean
};

/// Called by all ranks. Throws what run_scene does on every rank, or on rank 0 before the first step, of which the
/// others then know nothing; BrokenPromise where the states of ranks differ. What else one rank alone throws ends the
/// job.
[[nodiscard]] OneSceneTotals run_one_scene(const OneScene& one, Session& session);

} // namespace flotilla::mpi
