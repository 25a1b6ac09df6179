// SPDX-License-Identifier: MIT
// What the page says in words and numbers: rows of text, formatted here so that the page only lays them out.
#pragma once

#include <string>
#include <vector>

#include "report/html_report.hpp"
#include "report/pose_track.hpp"
#include "report/step_columns.hpp"

namespace flotilla::report {

/// A titled table; a row is a label, a value and, where it needs one, an explanation.
struct Table {
    std::string title;
    std::vector<std::vector<std::string>> rows;
};

[[nodiscard]] Table summary_table(const io::RunReader& run, const StepColumns& steps);
/// Which warnings steps had, in words; one row saying that there were none where that is so.
[[nodiscard]] Table warning_table(const StepColumns& steps);
[[nodiscard]] Table provenance_table(const io::RunReader& run);
[[nodiscard]] Table settings_table(const io::RunInfo& info);
[[nodiscard]] Table verification_table(const Verification& verification);
/// How the page differs from the recorded run.
[[nodiscard]] Table page_table(const PoseTrack& track, std::size_t rows_every);

/// Six significant digits, "1.25e-05".
[[nodiscard]] std::string short_number(double value);

} // namespace flotilla::report
