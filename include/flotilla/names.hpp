// SPDX-License-Identifier: MIT
// What a misspelt name most likely meant; every message about an unknown name says it.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace flotilla {

/// The candidate that a misspelt name most likely meant, or an empty view: at most a third of the letters (and at least
/// two) inserted, deleted, replaced or swapped with a neighbour; where there is none, the shortest that contains the
/// name, of at least three letters. Ties go to the earlier candidate.
[[nodiscard]] std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates);

/// `unknown <kind> "name"`, with the nearest known name where there is one.
[[nodiscard]] std::string unknown_name(std::string_view kind, std::string_view name,
                                       std::span<const std::string_view> known);

} // namespace flotilla
