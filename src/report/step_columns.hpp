// SPDX-License-Identifier: MIT
// steps.csv as columns, for plots.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace flotilla::report {

/// Numbers by column name; nan where a field is empty. All columns have the same length.
struct StepColumns {
    std::map<std::string, std::vector<double>, std::less<>> columns;
    std::string last_state_hash;
    std::vector<std::string> problems; ///< lines that were left out

    [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.begin()->second.size(); }
    /// Empty where the file has no such column (it was written by another version).
    [[nodiscard]] const std::vector<double>& column(std::string_view name) const;
};

/// A torn last line, as a run that was killed leaves it, is dropped silently; other lines that are no rows are
/// problems.
[[nodiscard]] StepColumns read_step_columns(std::string_view csv);

} // namespace flotilla::report
