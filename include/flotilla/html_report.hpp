// SPDX-License-Identifier: MIT
// A run as one HTML file: animation, plots and tables, without a network or any other file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <flotilla/verify.hpp>

namespace flotilla {

struct HtmlReportOptions {
    bool verify = false;        ///< prove the run first and show the verdict; cost: that of verify_run
    VerifyOptions verification; ///< of that proof; its number of threads is that of the page as well
    /// Frames of the run per frame of the page; 0: as few as keep the poses below 64 MiB before compression.
    std::int64_t frame_every = 0;
};

/// What a page holds.
struct HtmlReport {
    std::int64_t frames = 0, frames_shown = 0; ///< of the run; in the page
    double position_error = 0;                 ///< m, largest error of a drawn body's position
    double rotation_error = 0;                 ///< rad, largest error of a drawn body's rotation
    std::uintmax_t bytes = 0;                  ///< of the file
    std::vector<std::string> problems;         ///< what cannot be read, naming files and frames; the page names it too
    std::optional<VerifyReport> verification;  ///< where it was asked for
};

/// Writes `output`; an existing file is replaced once the new one is complete. What can be read of a damaged run is
/// shown. IoError where `folder` is no run folder or the file cannot be written; InputError where options are out of
/// range.
HtmlReport write_html_report(const std::filesystem::path& folder, const std::filesystem::path& output,
                             const HtmlReportOptions& options = {});

} // namespace flotilla
