// SPDX-License-Identifier: MIT
// What the environment of the process asks for (flotilla/environment.hpp).
#pragma once

#include <charconv>
#include <cstdlib>
#include <cstring>

namespace flotilla {

inline constexpr int kMostThreads = 1024; ///< of a World or of coarse work

/// FLOTILLA_NUM_THREADS; 0 where it is unset or no positive number, which check_environment() refuses.
[[nodiscard]] inline int threads_from_environment() {
    const char* text = std::getenv("FLOTILLA_NUM_THREADS");
    int threads = 0;
    if (text != nullptr) std::from_chars(text, text + std::strlen(text), threads);
    return threads > 0 ? threads : 0;
}

} // namespace flotilla
