// SPDX-License-Identifier: MIT
// The external files of CCD queries. They are not part of the project: tests skip where they are absent.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/ccd_file.hpp"

namespace flotilla::test {

inline constexpr std::array<const char*, 7> kCcdDataFiles{"unit.csv",          "erleben.csv",       "toolkit_cases.csv",
                                                          "simulation_vf.bin", "simulation_ee.bin", "nearmiss_vf.bin",
                                                          "nearmiss_ee.bin"};

inline std::filesystem::path ccd_data_path(const std::string& file) {
    return std::filesystem::path(FLOTILLA_TEST_DATA) / "ccd" / file;
}

/// The rows of one of the files above; nothing where the data is not installed.
inline std::optional<std::vector<CcdFileRow>> load_ccd_data(const std::string& file) {
    const auto path = ccd_data_path(file);
    if (!std::filesystem::exists(path)) return std::nullopt;
    return read_ccd_file(path);
}

} // namespace flotilla::test
