// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace flotilla::test {

/// The state hash of every row of a folder's steps.csv.
inline std::vector<std::string> step_hashes(const std::filesystem::path& folder) {
    std::ifstream in(folder / "steps.csv");
    const auto column = [](const std::string& row, std::size_t k) {
        std::size_t begin = 0;
        for (; k > 0; --k) begin = row.find(',', begin) + 1;
        return row.substr(begin, row.find(',', begin) - begin);
    };
    std::string line;
    std::getline(in, line);
    std::size_t k = 0;
    while (column(line, k) != "state_hash") ++k;
    std::vector<std::string> out;
    while (std::getline(in, line)) out.push_back(column(line, k));
    return out;
}

} // namespace flotilla::test
