// SPDX-License-Identifier: MIT
// Independent items on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace flotilla {

/// Threads to use where the caller does not say: FLOTILLA_NUM_THREADS, else OMP_NUM_THREADS, else the cores that this
/// process may use.
[[nodiscard]] int default_threads();

/// The cores that this process may use.
[[nodiscard]] int usable_cores();

/// Calls work(i) once for every i in [0, n), in any order, on at most `threads` threads (the caller's among them); returns
/// when all are done. Results belong in slots keyed by i. An exception of work stops the items not yet begun; of several the
/// one with the smallest i is thrown here. One thread spawns nothing and goes in order.
void parallel_for(std::size_t n, int threads, const std::function<void(std::size_t)>& work);

} // namespace flotilla
