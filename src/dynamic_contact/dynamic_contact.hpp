// SPDX-License-Identifier: MIT
// Stage 5, first part: dynamic contact (paper, section 4.1, Algorithm 2), as frozen sweeps (pair/ordered_sweep.hpp).
// Pairs that do not resolve within their iterations are rigidified at the end of the sweep (section 4.2.1).
#pragma once

#include "dynamic_contact/resolve_together.hpp"

namespace flotilla {

struct DynamicContactStats {
    StageCounters counters;
    std::int64_t merges = 0;
    std::int32_t trigger_a = -1, trigger_b = -1; ///< bodies of the first pair that was rigidified
};

/// `joint`: for hits of which sweeps do not see the end; may be none: they are given up.
DynamicContactStats handle_dynamic_contact(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                           JointSolve* joint);

} // namespace flotilla
