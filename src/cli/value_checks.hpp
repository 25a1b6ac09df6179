// SPDX-License-Identifier: MIT
// Checks of options that CLI11's own leave out: its PositiveNumber lets nan pass, and an integer beyond 64 bits is read
// as the largest.
#pragma once

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <system_error>

namespace flotilla::cli {

/// The largest number up to which doubles count: no run has as many steps.
inline constexpr double kMostCount = 9007199254740992; // 2^53

/// An error message where `text` is not a finite number above zero, or of zero and above.
inline std::string judge_number(const std::string& text, bool zero_too) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || end != text.c_str() + text.size()) return "\"" + text + "\" is not a number";
    if (!std::isfinite(value)) return text + " is not a finite number";
    if (value < 0 || (value == 0 && !zero_too)) return text + " must be " + (zero_too ? "0 or more" : "above 0");
    return {};
}

/// As judge_number, of options that are whole numbers.
inline std::string judge_count(const std::string& text, bool zero_too) {
    if (std::string error = judge_number(text, zero_too); !error.empty()) return error;
    return std::strtod(text.c_str(), nullptr) <= kMostCount ? "" : text + " is too large";
}

/// As judge_number, of a whole number of 64 bits.
inline std::string judge_whole(const std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range) return text + " is too large";
    return error != std::errc{} || end != text.data() + text.size()
               ? "\"" + text + "\" is not a whole number of 0 or more"
               : "";
}

inline const CLI::Validator kPositive([](std::string& text) { return judge_number(text, false); }, "POSITIVE");
inline const CLI::Validator kNonNegative([](std::string& text) { return judge_number(text, true); }, "NONNEGATIVE");
inline const CLI::Validator kPositiveCount([](std::string& text) { return judge_count(text, false); }, "POSITIVE");
inline const CLI::Validator kCount([](std::string& text) { return judge_count(text, true); }, "NONNEGATIVE");
inline const CLI::Validator kWhole([](std::string& text) { return judge_whole(text); }, "UINT");
inline const CLI::Validator kNotEmpty([](std::string& text) { return text.empty() ? "a name must be given" : ""; }, "");

} // namespace flotilla::cli
