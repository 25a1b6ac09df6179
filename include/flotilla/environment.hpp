// SPDX-License-Identifier: MIT
// What the library takes from the environment of the process.
#pragma once

namespace flotilla {

/// Throws InputError where FLOTILLA_NUM_THREADS is not a whole number of 1 to 1024, or FLOTILLA_SIMD not scalar, avx2
/// or avx512; where they are unset or empty they ask for nothing. Worlds and proofs of runs begin with it.
void check_environment();

} // namespace flotilla
