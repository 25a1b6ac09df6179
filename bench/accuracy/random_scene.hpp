// SPDX-License-Identifier: MIT
// Scenes drawn at random from the whole range that the solver is made for, rather than from what looks natural: sizes,
// masses, speeds and time steps are log-uniform over decades, shapes may be needles, sheets without thickness or loose
// triangles.
#pragma once

#include <cstdint>
#include <string>

#include <flotilla/scene.hpp>

namespace flotilla::survey {

struct RandomScene {
    SceneDescription scene; ///< free of intersections at the start
    std::string kinds;      ///< of its dynamic bodies, with their numbers: "3 box, 1 needle"
    std::string place;      ///< what holds them: "free", "floor", "box", "bowl"
};

/// Scene `index` of the series `seed`, a pure function of both on one system (the logarithms are libm's). Throws
/// InputError should no free place be found for a body.
[[nodiscard]] RandomScene make_random_scene(std::uint64_t seed, std::uint64_t index);

} // namespace flotilla::survey
