// SPDX-License-Identifier: MIT
// The report of a step that is made of inner ones (Settings::substeps).
#pragma once

#include <flotilla/report.hpp>

namespace flotilla {

/// Adds what the next inner step reports to the report of its step. Time and work add up, of errors and of what the
/// failsafe has in hand the worst counts, and what is measured at the end of a step is the last one's. Left alone are
/// `step`, `time` and `total_ms`, and what the state says: energies, momenta, sleepers, the hash.
void add_inner_step(const StepReport& inner, StepReport& report);

} // namespace flotilla
