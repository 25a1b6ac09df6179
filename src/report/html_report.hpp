// SPDX-License-Identifier: MIT
// One HTML file that shows a run: the page of src/report/page with the run's data inside. Everything that a run can
// name freely (bodies, shapes, the command line) enters the page as JSON text in which "<" is escaped, and the page's
// script writes it as text, never as markup.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "run_folder/run_folder.hpp"

namespace flotilla::report {

/// What the page says about the proof of the run.
struct Verification {
    enum class Verdict : std::uint8_t {
        not_verified,
        proved,
        failed,
        incomplete, ///< what could be read is proved, but part of the run cannot be read
    };
    Verdict verdict = Verdict::not_verified;
    std::string text;                                      ///< the verdict in words
    std::vector<std::pair<std::string, std::string>> rows; ///< numbers of the proof
    std::vector<std::string> faults;                       ///< one line each
};

struct PageReport {
    std::int64_t frames_shown = 0;
    double position_error = 0; ///< m
    double rotation_error = 0; ///< rad
    std::uintmax_t bytes = 0;  ///< of the file
    std::vector<std::string> problems;
};
/// Writes the page. IoError where it cannot be written; what cannot be read is named in the page and the report.
[[nodiscard]] PageReport write_page(io::RunReader& run, const Verification& verification, std::int64_t frame_every,
                                    int threads, const std::filesystem::path& output);

} // namespace flotilla::report
