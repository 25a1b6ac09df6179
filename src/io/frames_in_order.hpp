// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "io/run_folder.hpp"
#include "parallel/in_order.hpp"

namespace flotilla::io {

/// use(make(frame), k) for all frames of the run: read and used in order, made into something else side by side in between.
template <class Make, class Use>
void frames_in_order(RunReader& run, Make&& make, Use&& use) {
    const auto read = [&](std::size_t k) { return run.frame(static_cast<std::int64_t>(k)); };
    const auto use_made = [&](auto& made, std::size_t k) { use(made, static_cast<std::int64_t>(k)); };
    in_order(static_cast<std::size_t>(run.frames()), free_threads(), read, make, use_made);
}

} // namespace flotilla::io
