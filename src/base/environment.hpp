// SPDX-License-Identifier: MIT
#pragma once

#include <charconv>
#include <cstdlib>
#include <cstring>

namespace flotilla {

/// FLOTILLA_NUM_THREADS; 0 where it is unset or no positive number.
[[nodiscard]] inline int threads_from_environment() {
    const char* text = std::getenv("FLOTILLA_NUM_THREADS");
    int threads = 0;
    if (text != nullptr) std::from_chars(text, text + std::strlen(text), threads);
    return threads > 0 ? threads : 0;
}

} // namespace flotilla
