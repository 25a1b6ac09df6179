// SPDX-License-Identifier: MIT
// Islands and heights of the contact graph. Bodies of infinite mass join nothing: two piles on one floor are two
// islands.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "islands/body_pair.hpp"

namespace flotilla {

/// Reused between calls.
struct ContactGraphScratch {
    std::vector<std::int32_t> parent;        ///< union-find, per body
    std::vector<std::int32_t> island_number; ///< per body that is a root
    std::vector<std::int32_t> first, next;   ///< neighbours of body i: next[first[i]] .. next[first[i + 1] - 1]
    std::vector<std::int32_t> queue;
};

/// island[k] of pairs[k]: the connected components of the graph over movable bodies, numbered by their lowest body.
/// Returns their number. Precondition: at least one body of each pair is movable.
int find_islands(std::span<const BodyPair> pairs, std::span<const std::uint8_t> movable, ContactGraphScratch& scratch,
                 std::span<std::int32_t> island);

/// level[i] of body i: the least number of contacts between it and a body of infinite mass (reference [29]: stack
/// height), which has level 0 itself; -1 where no path leads to one.
void contact_levels(std::span<const BodyPair> pairs, std::span<const std::uint8_t> movable,
                    ContactGraphScratch& scratch, std::span<std::int32_t> level);

} // namespace flotilla
