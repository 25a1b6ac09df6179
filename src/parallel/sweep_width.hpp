// SPDX-License-Identifier: MIT
// How many threads sweeps with a barrier after every group are worth: the one rule, for the solver that runs them and
// for the prediction of what more cores would give.
#pragma once

#include <algorithm>
#include <cstddef>

namespace flotilla {

/// Tasks that a thread needs in the average group for a barrier to pay: a batch of contacts (a packet) takes some
/// hundreds of nanoseconds, a barrier of two threads as much. Changes times only, never a bit.
inline constexpr std::size_t kTasksPerSweeper = 4;

/// At most `threads`; `tasks` is the number in all groups together.
[[nodiscard]] inline int sweep_width(std::size_t tasks, std::size_t groups, int threads) {
    const std::size_t worth = tasks / (kTasksPerSweeper * std::max<std::size_t>(groups, 1));
    return static_cast<int>(std::clamp<std::size_t>(worth, 1, static_cast<std::size_t>(std::max(threads, 1))));
}

} // namespace flotilla
