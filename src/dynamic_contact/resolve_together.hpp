// SPDX-License-Identifier: MIT
// Hits of dynamic contact solved together (pair/joint_hits.hpp). The failsafe takes what that does not end.
#pragma once

#include "pair/inelastic.hpp"
#include "pair/joint_hits.hpp"

namespace flotilla {

/// Whether nothing hits any more. Clusters must be single bodies. `joint`: what is left in it is left to the failsafe
/// at once where a step goes through stages 4 and 5 again. `counters`: added to.
[[nodiscard]] bool resolve_together(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                    JointSolve& joint, StageCounters& counters);

} // namespace flotilla
