// SPDX-License-Identifier: MIT
// Scenes made by program: the paper's and small ones to try things with.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla {

struct LibraryScene {
    std::string_view name;
    int default_bodies = 0; ///< the paper's number where it has one
    int min_bodies = 0, max_bodies = 0;
    std::string_view description;
};

/// Every scene that make_scene knows.
[[nodiscard]] std::vector<LibraryScene> list_scenes();

/// Makes a scene of `bodies` bodies in all (0: its default number). A pure function of its arguments, the same bits on
/// every machine; no two bodies of it intersect, whatever the seed. Throws InputError for an unknown name or a number
/// out of range.
[[nodiscard]] SceneDescription make_scene(std::string_view name, int bodies = 0, std::uint64_t seed = 0);

} // namespace flotilla
