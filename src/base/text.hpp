// SPDX-License-Identifier: MIT
// Small text helpers for messages and files.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace flotilla {

/// The shortest decimal that reads back as the same double ("0.1", "1e-06"); "nan", "inf" and "-inf" for the rest.
[[nodiscard]] std::string to_text(double value);

/// `"name"`, with control characters and quotes made visible.
[[nodiscard]] std::string in_quotes(std::string_view name);

/// The candidate that a misspelt name most likely meant, or an empty view: at most a third of the letters (and at least
/// two) inserted, deleted, replaced or swapped with a neighbour. Ties go to the earlier candidate.
[[nodiscard]] std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates);

/// `unknown <kind> "name"`, with the nearest known name where there is one.
[[nodiscard]] std::string unknown_name(std::string_view kind, std::string_view name,
                                       std::span<const std::string_view> known);

} // namespace flotilla
