// SPDX-License-Identifier: MIT
// How many threads sweeps over groups of tasks are worth: the one rule, for the solver that runs them and for the
// prediction of what more cores would give.
#pragma once

#include <algorithm>
#include <cstddef>

namespace flotilla {

/// Tasks in the average group for each of two threads below which one does all: a batch of contacts (a packet) takes
/// some hundreds of nanoseconds, and to wait for another thread as much. How many threads there are changes no bit; but
/// an island that is worth two is large (static_contact/sweep_island.hpp), and parts of it may be swept alone.
inline constexpr std::size_t kTasksOfTwo = 4;

/// At most `threads`, and as many as have a task each in the average group; `tasks` is the number in all groups
/// together. Where shares wait for their neighbours alone, one more thread costs the others nothing.
[[nodiscard]] inline int sweep_width(std::size_t tasks, std::size_t groups, int threads) {
    const std::size_t in_group = tasks / std::max<std::size_t>(groups, 1);
    if (in_group < 2 * kTasksOfTwo) return 1;
    return static_cast<int>(std::clamp<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), 1, in_group));
}

} // namespace flotilla
