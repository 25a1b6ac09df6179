// SPDX-License-Identifier: MIT
// Rows of steps.csv. Numbers are written so that reading them gives the same double; the state hash as 16 hex digits;
// an unknown (infinite) smallest distance as an empty field.
#pragma once

#include <string>
#include <string_view>

#include <flotilla/report.hpp>

namespace flotilla::io {

[[nodiscard]] std::string step_csv_header();
[[nodiscard]] std::string step_csv_row(const StepReport& row);

/// The rows of `text` (a whole steps.csv) up to and including step `last_step`, header included. A torn last line is dropped.
[[nodiscard]] std::string step_csv_until(std::string_view text, std::int64_t last_step);

} // namespace flotilla::io
