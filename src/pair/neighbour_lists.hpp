// SPDX-License-Identifier: MIT
// Which pairs have a neighbour list (ccd/candidate_list.hpp), and when one is made: slow pairs keep theirs over steps,
// fast ones for the sweeps of one step, and first queries of fast pairs traverse the hierarchies. A list changes the
// cost of a query and never its answer.
#pragma once

#include "pair/pair_table.hpp"
#include "pair/step_view.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// A list that covers the motion, made now if that seems to pay; else null.
[[nodiscard]] CoveringList covering_list(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache,
                                         const BodyMotion& a, const BodyMotion& b);

/// The pair's list where it covers the present end poses: for queries of the proximity distance at the end of the step.
/// Null otherwise.
[[nodiscard]] CoveringList end_candidates(const StepView& view, const PairRecord& pair);

/// The same; where there is no such list one is made if that seems to pay.
[[nodiscard]] CoveringList kept_candidates(const StepView& view, Worker& worker, PairRecord& pair);

} // namespace flotilla
