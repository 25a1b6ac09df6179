// SPDX-License-Identifier: MIT
// Files of CCD queries with known answers, one query per row.
//
// CSV: header line, then `kind,<24 coordinates>,expected,toi,source`: kind VF or EE; 8 points x y z, at t = 0 `v f0 f1
// f2` or `a0 a1 b0 b1`, then the same at t = 1; expected 0 or 1 (do the closed features meet in [0, 1]); toi empty or
// in [0, 1]. BIN (name ends in .bin): little-endian float64, 27 per row: kind (0 VF, 1 EE), 24 coordinates, expected,
// toi (-1: none).
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "geometry/ccd.hpp"

namespace flotilla {

struct CcdFileRow {
    CcdKind kind = CcdKind::vertex_face;
    CcdQuery query;
    bool expected = false;
    std::optional<double> toi; ///< exact time of first contact rounded to double, where the file gives one
};

/// Reads a whole file, chosen by its name. Throws IoError where it cannot be read and InputError naming file and line
/// (CSV) or row (BIN) for anything that is not exactly the form above.
[[nodiscard]] std::vector<CcdFileRow> read_ccd_file(const std::filesystem::path& path);

} // namespace flotilla
