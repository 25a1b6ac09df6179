// SPDX-License-Identifier: MIT
#include "base/environment.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include <flotilla/environment.hpp>

#include "base/error_list.hpp"
#include "base/text.hpp"

namespace flotilla {
namespace {

bool is_thread_count(std::string_view text) {
    int threads = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
    return error == std::errc() && end == text.data() + text.size() && threads >= 1 && threads <= kMostThreads;
}

bool is_instruction_set(std::string_view text) {
    constexpr std::array<std::string_view, 3> kNames{"scalar", "avx2", "avx512"};
    return std::find(kNames.begin(), kNames.end(), text) != kNames.end();
}

void check(const char* variable, bool (*allowed)(std::string_view), const std::string& what, ErrorList& errors) {
    const char* const value = std::getenv(variable);
    if (value == nullptr || *value == '\0' || allowed(value)) return;
    errors.add(variable, "must be " + what + ", got " + in_quotes(value));
}

} // namespace

void check_environment() {
    ErrorList errors("environment");
    check("FLOTILLA_NUM_THREADS", is_thread_count, "a whole number of 1 to " + std::to_string(kMostThreads), errors);
    check("FLOTILLA_SIMD", is_instruction_set, "scalar, avx2 or avx512", errors);
    errors.throw_if_any();
}

} // namespace flotilla
