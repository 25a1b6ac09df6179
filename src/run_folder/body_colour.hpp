// SPDX-License-Identifier: MIT
// The colours of bodies in pictures and exports.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace flotilla::io {

/// sRGB 0..255. Muted boat-shed colours that stay apart from each other and from the grey of fixed bodies.
inline constexpr std::array<std::array<int, 3>, 12> kBodyColours{{{201, 75, 60},
                                                                  {226, 138, 60},
                                                                  {236, 190, 84},
                                                                  {126, 165, 82},
                                                                  {58, 141, 118},
                                                                  {63, 142, 178},
                                                                  {54, 97, 158},
                                                                  {123, 94, 158},
                                                                  {190, 98, 134},
                                                                  {229, 221, 203},
                                                                  {156, 106, 72},
                                                                  {98, 178, 190}}};
inline constexpr std::array<float, 3> kFixedColour{0.50F, 0.50F, 0.48F}; ///< linear

struct BodyColour {
    std::size_t colour = 0; ///< in kBodyColours
    float shade = 1;        ///< factor of linear values
};
/// Of the body with that number; neighbouring numbers are spread over the colours.
inline BodyColour colour_of(std::uint32_t body) {
    std::uint32_t h = body * 2654435769U;
    h ^= h >> 15U;
    h *= 2246822519U;
    h ^= h >> 13U;
    return {h % kBodyColours.size(), 0.88F + 0.24F * static_cast<float>((h >> 16U) & 255U) / 255.0F};
}

inline float linear_of_srgb(int value) { return std::pow(static_cast<float>(value) / 255.0F, 2.2F); }

} // namespace flotilla::io
