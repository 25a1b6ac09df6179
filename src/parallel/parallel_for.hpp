// SPDX-License-Identifier: MIT
// Independent items of coarse work (checks of frames, files, models), on oneTBB; the step runs on OpenMP (team.hpp),
// and nothing uses both at a time.
#pragma once

#include <cstddef>
#include <functional>

#include "parallel/threads.hpp"

namespace flotilla {

/// Calls work(i) once for every i in [0, n), in any order, on at most `threads` threads (the caller's among them);
/// returns when all are done. Results belong in slots keyed by i. Of several exceptions the one with the smallest i is
/// thrown here, as in a plain loop; items after it may be left out. One thread spawns nothing and goes in order.
void parallel_for(std::size_t n, int threads, const std::function<void(std::size_t)>& work);

} // namespace flotilla
