// SPDX-License-Identifier: MIT
// Scenes for runs in which every promise is asked for: those of the survey of energy under settings of all kinds and
// with scripted bodies that go through them, extremes of three to five axes at once, and bodies whose faces nearly
// coincide or lie within each other.
#pragma once

#include <cstdint>
#include <string>

#include <flotilla/scene.hpp>

namespace flotilla::fuzz {

struct SeriesScene {
    SceneDescription scene;
    std::string name; ///< what it is made of
};

/// "survey", "survey, scripted", "extremes", "nested" or "coplanar".
[[nodiscard]] std::string series_kind(std::uint64_t index);

/// Scene `index` of the series `seed`, a pure function of both. Throws InputError where no free place is found for a
/// body.
[[nodiscard]] SeriesScene series_scene(std::uint64_t seed, std::uint64_t index);

} // namespace flotilla::fuzz
