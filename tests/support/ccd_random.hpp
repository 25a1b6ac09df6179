// SPDX-License-Identifier: MIT
// The conservative CCD on generated queries: wide kernels against scalar code bit for bit, and against the exact
// oracle. The fast test runs a slice, the slow one the whole: the same code, other counts.
#pragma once

#include <cstddef>
#include <cstdint>

namespace flotilla::test {

/// Queries from `first` on, all classes together: every field of every result of every instruction set at hand equals
/// the scalar code's, over several separations, both ways to start, and batches of every length up to some hundreds.
void check_wide_against_scalar(std::uint64_t first, std::uint64_t count);

/// Queries from `first` on, all classes together, against exact arithmetic: no contact missed, no reported time after
/// the exact one, no hit missing on features that come within the separation, no witness direction that certifies
/// contact. Prints one line per class.
void check_against_oracle(std::uint64_t first, std::uint64_t count);

/// A count from the environment, else the default.
std::uint64_t count_from_environment(const char* variable, std::uint64_t standard);

} // namespace flotilla::test
