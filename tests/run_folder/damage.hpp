// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>

namespace flotilla {

/// Inverts one bit of a file.
inline void flip_bit(const std::filesystem::path& path, std::streamoff byte) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(byte);
    const char old = static_cast<char>(file.get());
    file.seekp(byte);
    file.put(static_cast<char>(old ^ 0x10));
}

} // namespace flotilla
