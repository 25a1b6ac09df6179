// SPDX-License-Identifier: MIT
// What queries of a pair are aided by. Convex bodies of few vertices: by the plane that was last found between them
// (ccd/plane_features.hpp). Others: by a neighbour list (ccd/candidate_list.hpp), where slow pairs keep theirs over
// steps, fast ones for the sweeps of one step, and first queries of fast pairs traverse the hierarchies. Either changes
// the cost of a query and never its answer.
#pragma once

#include "pair/pair_table.hpp"
#include "pair/step_view.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// What is known of the pair for a query of the motion: of convex bodies of few vertices a plane between them, else a
/// list that covers the motion, made now if that seems to pay.
[[nodiscard]] QueryAid swept_aid(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache,
                                 const BodyMotion& a, const BodyMotion& b, CcdMethod method);

/// The same for queries of the proximity distance at the end of the step, with a list only where there is one that
/// covers the present end poses.
[[nodiscard]] QueryAid end_aid(const StepView& view, const PairRecord& pair);

/// The same; where there is neither a list is made if that seems to pay.
[[nodiscard]] QueryAid kept_aid(const StepView& view, Worker& worker, PairRecord& pair);

} // namespace flotilla
