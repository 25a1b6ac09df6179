// SPDX-License-Identifier: MIT
// What an export of a run (flotilla/run_folder.hpp) writes.
#pragma once

#include <cstdint>
#include <limits>

namespace flotilla {

enum class ExportFormat : std::uint8_t {
    csv, ///< one row per body and frame, 17 significant digits
    vtp, ///< ParaView: one point per body with its rotation, the meshes, and a .pvd over time
    obj, ///< one file per frame, all bodies in the world
    glb, ///< one animated node per body, single precision
    usd, ///< one point instancer with time samples, as text, single precision
};
/// Frames first, first + every, ... up to last; they keep their numbers and times.
struct FrameRange {
    std::int64_t first = 0;
    std::int64_t last = std::numeric_limits<std::int64_t>::max(); ///< that of the run where it has fewer
    std::int64_t every = 1;
};

struct ExportSize {
    std::int64_t frames = 0;
    std::uintmax_t bytes = 0;
};

} // namespace flotilla
