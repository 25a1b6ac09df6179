// SPDX-License-Identifier: MIT
// Lines, arrows and dots over a picture. What a surface hides is drawn fainter, not left out: what they tell of lies
// inside of heaps.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <flotilla/types.hpp>

namespace flotilla {

using OverlayColour = std::array<std::uint8_t, 3>; ///< sRGB

struct OverlayLine {
    Vec3 from, to; ///< m, world
    float width;   ///< pixels
    OverlayColour colour;
};

struct OverlayArrow {
    Vec3 at;        ///< m, world
    Vec3 direction; ///< unit
    float length;   ///< in radii of what the camera is fitted to
    float width;    ///< pixels
    OverlayColour colour;
};

struct OverlayDot {
    Vec3 at;      ///< m, world
    float radius; ///< pixels
    OverlayColour colour;
};

/// Drawn in this order, each kind in its own.
struct Overlay {
    float fade = 0; ///< of the picture below, towards white: 0 none, 1 all of it
    std::vector<OverlayLine> lines;
    std::vector<OverlayArrow> arrows;
    std::vector<OverlayDot> dots;
};

} // namespace flotilla
