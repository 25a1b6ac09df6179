// SPDX-License-Identifier: MIT
// The arithmetic limit of one core of this processor, measured: independent chains of additions and multiplications (no
// fused ones, as the kernels have none) that fill the pipes without touching memory. Kernels are compared with it.
#pragma once

#include "geometry/ccd.hpp"

namespace flotilla::bench {

inline constexpr int kPeakSteps = 1000;
/// Runs kPeakSteps steps of six additions and six multiplications per lane; returns the number of operations, lanes
/// counted. Call only where the processor has the instruction set.
double run_peak_loop(Isa isa);

/// Operations per second of CPU time: the best of several short runs, measured once per process.
[[nodiscard]] double arithmetic_peak(Isa isa);

[[nodiscard]] const char* name(Isa isa);

} // namespace flotilla::bench
