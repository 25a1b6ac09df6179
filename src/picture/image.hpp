// SPDX-License-Identifier: MIT
// An 8-bit picture and its PNG form.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace flotilla {

/// sRGB, 3 bytes a pixel, rows from top to bottom.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb; ///< [height][width][3]
};

/// Writes aside and renames: a reader never sees half a file. Throws IoError.
void write_png(const std::filesystem::path& path, const Image& image);

} // namespace flotilla
