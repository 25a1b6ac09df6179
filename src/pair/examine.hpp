// SPDX-License-Identifier: MIT
// The query of a pair of bodies along its present motion.
#pragma once

#include "pair/pair_table.hpp"
#include "pair/step_view.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// What a query found.
struct PairFinding {
    PairHit hit;                     ///< the earliest, if there is any
    Verdict verdict = Verdict::open; ///< what `hit` says of the pair: open where there is one
};

/// Runs the continuous collision detection `method` on the pair. A function of the two motions and of the settings
/// alone: `cache` saves work, and nothing is recorded. That is for commit().
[[nodiscard]] PairFinding examine(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache,
                                  CcdMethod method);

/// Examines the pair conservatively and records a proof where there is one.
PairHit query(const StepView& view, Worker& worker, PairRecord& pair);

} // namespace flotilla
