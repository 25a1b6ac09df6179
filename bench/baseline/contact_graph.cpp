// SPDX-License-Identifier: MIT
#include "contact_graph.hpp"

#include <algorithm>

namespace flotilla::baseline {
namespace {

/// reach[i][j]: i rests on j, directly or through others (Warshall). Scenes of a figure have some ten bodies.
std::vector<std::vector<char>> closure(std::size_t count,
                                       const std::vector<std::pair<std::size_t, std::size_t>>& edges) {
    std::vector<std::vector<char>> reach(count, std::vector<char>(count, 0));
    for (const auto& [upper, lower] : edges) reach[upper][lower] = 1;
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t i = 0; i < count; ++i)
            if (reach[i][k] != 0)
                for (std::size_t j = 0; j < count; ++j) reach[i][j] |= reach[k][j];
    return reach;
}

} // namespace

std::vector<int> contact_levels(std::size_t count, const std::vector<std::pair<std::size_t, std::size_t>>& rests_on) {
    const auto reach = closure(count, rests_on);
    const auto together = [&](std::size_t i, std::size_t j) { return reach[i][j] != 0 && reach[j][i] != 0; };
    std::vector<int> level(count, 0);
    // Longest paths; each pass settles one more level.
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j) {
                if (i == j || reach[i][j] == 0) continue;
                const int least = together(i, j) ? level[j] : level[j] + 1;
                if (level[i] < least) level[i] = least, changed = true;
            }
    }
    return level;
}

} // namespace flotilla::baseline
