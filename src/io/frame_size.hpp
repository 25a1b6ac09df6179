// SPDX-License-Identifier: MIT
// What a frame of a run takes in its folder. Here and not with the folder, because a plan says it without writing one.
#pragma once

#include <cstddef>

namespace flotilla::io {

/// Of one body in one frame: 13 doubles, and contacts, cluster and cost; 7 more doubles for each inner step that is
/// kept.
[[nodiscard]] constexpr std::size_t frame_bytes_per_body(int substeps) {
    return (13 + 7 * (static_cast<std::size_t>(substeps) - 1)) * sizeof(double) + 5;
}

} // namespace flotilla::io
