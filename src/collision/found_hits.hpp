// SPDX-License-Identifier: MIT
// A look at all pairs that moved, side by side, for what hits.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pair/impulses.hpp"
#include "pair/pair_lists.hpp"
#include "pair/step_view.hpp"

namespace flotilla {

/// Fills `found`, in the order of the pairs; those of a pair stand together, the first with its landing. Only pairs
/// of bodies are looked at that are `asked`.
void look_for_hits(const StepView& view, PairBook& book, Workers& workers, StageCounters& counters,
                   std::vector<FoundHit>& found, const std::function<bool(std::int32_t, std::int32_t)>& asked);

/// Takes out of what was found the hits whose velocities part, whose ways are put right one after the other. Whether
/// any was.
bool hasten_parting(const StepView& view, Movers& movers, StageCounters& counters, std::vector<FoundHit>& found);

} // namespace flotilla
