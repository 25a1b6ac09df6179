// SPDX-License-Identifier: MIT
#include "islands/coloring.hpp"

#include <algorithm>
#include <bit>

#include "base/assert.hpp"

namespace flotilla {
namespace {

constexpr int kMaskColors = 64;

void mark(ColoringScratch& s, std::size_t body, int color) {
    if (color < kMaskColors)
        s.used[body] |= std::uint64_t{1} << color;
    else
        s.first_overflow[body] = color + 1;
}

int least_free(const ColoringScratch& s, const BodyPair& p, bool movable_a, bool movable_b) {
    const auto a = static_cast<std::size_t>(p.a), b = static_cast<std::size_t>(p.b);
    const std::uint64_t used = (movable_a ? s.used[a] : 0) | (movable_b ? s.used[b] : 0);
    if (~used != 0) return std::countr_one(used);
    return std::max(movable_a ? s.first_overflow[a] : kMaskColors, movable_b ? s.first_overflow[b] : kMaskColors);
}

} // namespace

int color_pairs(std::span<const BodyPair> pairs, std::span<const std::uint8_t> movable, ColoringScratch& scratch,
                std::span<std::int32_t> color) {
    scratch.used.assign(movable.size(), 0);
    scratch.first_overflow.assign(movable.size(), kMaskColors);
    int num_colors = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const auto a = static_cast<std::size_t>(pairs[k].a), b = static_cast<std::size_t>(pairs[k].b);
        FLOTILLA_ASSERT(movable[a] || movable[b]);
        const int c = least_free(scratch, pairs[k], movable[a] != 0, movable[b] != 0);
        if (movable[a]) mark(scratch, a, c);
        if (movable[b]) mark(scratch, b, c);
        color[k] = c;
        num_colors = std::max(num_colors, c + 1);
    }
    return num_colors;
}

} // namespace flotilla
