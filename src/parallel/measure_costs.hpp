// SPDX-License-Identifier: MIT
// What threads cost on this machine, for the prediction of what more cores would give.
#pragma once

#include <vector>

#include "parallel/schedule.hpp"

namespace flotilla {

/// Medians, measured with teams of 2, 3, ... threads up to `widest` (above 16 in steps of an eighth); empty where that is one.
/// Takes some tens of milliseconds for each width. Threads are awake when a section begins, as they are between the sections of a step.
/// More threads than cores, or other work on the machine, are measured with it.
[[nodiscard]] std::vector<ThreadCosts> measure_costs(int widest);

} // namespace flotilla
