// SPDX-License-Identifier: MIT
// What threads cost on this machine, for the prediction of what more cores would give.
#pragma once

#include <vector>

#include "trace/schedule.hpp"

namespace flotilla {

/// Measured with teams of 2, 3, ... threads up to `widest` (above 16 in steps of an eighth); empty where that is one.
/// Takes up to 0.6 s for each width, on an idle machine a tenth of that. Threads are awake when a section begins, as
/// they are between the sections of a step. Of many single measurements the tenth percentile counts, because other work
/// on the machine only ever adds; where there is so much of it that threads hardly ever run side by side, that is
/// measured. More threads than cores are measured as what they are.
[[nodiscard]] std::vector<ThreadCosts> measure_costs(int widest);

} // namespace flotilla
