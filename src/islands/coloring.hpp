// SPDX-License-Identifier: MIT
// Colours for body pairs: no two pairs of one colour share a movable body, so the pairs of a colour can be solved in
// any order, side by side or in the lanes of a vector, with the same bits. Bodies of infinite mass are only read and
// use no colour: a floor would make every pair that stands on it a colour of its own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "islands/body_pair.hpp"

namespace flotilla {

/// Reused between calls; holds one entry per body.
struct ColoringScratch {
    std::vector<std::uint64_t> used;          ///< bit c: some pair of the body has colour c < 64
    std::vector<std::int32_t> first_overflow; ///< least colour >= 64 above all of the body's colours
};

/// Greedy first fit in the order of `pairs`: colour[k] of pairs[k]; returns the number of colours. A pair gets the
/// least colour below 64 that both its movable bodies have free; where there is none (a body with many neighbours), the
/// least colour above all those of its bodies. The colour of a pair depends only on earlier pairs of its own island.
/// Precondition: at least one body of each pair is movable.
int color_pairs(std::span<const BodyPair> pairs, std::span<const std::uint8_t> movable, ColoringScratch& scratch,
                std::span<std::int32_t> color);

} // namespace flotilla
