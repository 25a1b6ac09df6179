// SPDX-License-Identifier: MIT
// Continuous collision detection judged on files of queries with known answers.
#pragma once

#include <cstddef>
#include <filesystem>

#include <flotilla/settings.hpp>

namespace flotilla {

struct CcdFileOptions {
    CcdMethod method = CcdMethod::conservative;
    /// m, finite, >= 0: features within this distance at any time of the step are to be reported. The cubic uses it as
    /// its tolerance, or 1e-4 where it is 0.
    double separation = 0;
};

/// One row of the table of `flotilla ccd`. A "hit" is the method's answer, "contact" the file's (distance exactly 0).
struct CcdFileReport {
    std::size_t rows = 0;
    std::size_t positives = 0; ///< rows with contact
    std::size_t missed = 0;    ///< no hit, although there is contact or the minimum distance is at most the separation
    std::size_t late = 0;      ///< hit after the exact contact time, on rows where the file gives one
    /// Hit without contact; with separation > 0 only if the minimum distance exceeds 1.01 separation.
    std::size_t false_hits = 0;
    double ns_per_query = 0; ///< wall time of whole passes over the file, one thread; median of at least 5
};

/// Reads a file (CSV or BIN), runs every query with the widest instruction set at hand and compares. Minimum distances
/// are bounded by branch and bound in time, independent of the methods under test; a row whose bounds cannot decide
/// counts neither as missed nor as false. Throws InputError (bad file or option) and IoError (file that cannot be
/// read).
[[nodiscard]] CcdFileReport evaluate_ccd_file(const std::filesystem::path& path, const CcdFileOptions& options = {});

} // namespace flotilla
