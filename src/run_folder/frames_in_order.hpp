// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "parallel/in_order.hpp"
#include "run_folder/export.hpp"
#include "run_folder/run_folder.hpp"

namespace flotilla::io {

/// use(make(frame), k) for the frames k of the range: read and used in order, made into something else side by side in
/// between.
template <class Make, class Use>
void frames_in_order(RunReader& run, const FrameRange& range, Make&& make, Use&& use) {
    const auto frame_of = [&](std::size_t i) { return range.first + range.every * static_cast<std::int64_t>(i); };
    const auto read = [&](std::size_t i) { return run.frame(frame_of(i)); };
    const auto use_made = [&](auto& made, std::size_t i) { use(made, frame_of(i)); };
    in_order(static_cast<std::size_t>(count(range)), free_threads(), read, make, use_made);
}

} // namespace flotilla::io
