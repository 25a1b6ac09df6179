// SPDX-License-Identifier: MIT
// Rows of steps.csv. Numbers are written so that reading them gives the same double; the state hash as 16 hex digits;
// an unknown (infinite) smallest distance as an empty field.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <flotilla/report.hpp>

namespace flotilla::io {

[[nodiscard]] std::string step_csv_header();
[[nodiscard]] std::string step_csv_row(const StepReport& row);

/// What the columns of `text` (a whole steps.csv) have that this version does not write, or the other way round: the
/// first difference, as a reason. Empty where there is none, and for an empty text.
[[nodiscard]] std::string step_csv_difference(std::string_view text);

/// The rows of `text` (a whole steps.csv) up to and including step `last_step`, header included. A torn last line is
/// dropped.
[[nodiscard]] std::string step_csv_until(std::string_view text, std::int64_t last_step);

/// A steps.csv taken apart: the fields of each row stay one text.
struct StepTable {
    std::vector<std::string> columns;
    std::vector<std::pair<std::int64_t, std::string>> rows; ///< step and line, in the order of the file
};
/// Lines that do not begin with a step are left out, and so is a torn last line.
[[nodiscard]] StepTable read_step_table(std::string_view text);
/// The fields of a line; steps.csv has no quotes. The views are into `line`.
[[nodiscard]] std::vector<std::string_view> step_csv_fields(std::string_view line);

} // namespace flotilla::io
