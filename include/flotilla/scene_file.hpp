// SPDX-License-Identifier: MIT
// Scene files: JSON, SI units. src/io/README.md describes the format; src/io/scene.schema.json is its JSON Schema.
// Scene files of Rigid-IPC are read as well, known by their content.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla {

/// Settings that do not come from the file. What the file's `settings` give replaces the preset, `overrides` replace
/// both; bodies without a friction or restitution of their own take the result.
struct SceneFileOptions {
    std::string preset = "balanced";
    std::vector<std::pair<std::string, std::string>> overrides; ///< key and value, as --set gives them
};

/// What a scene file of another program says beside the scene. Of files of ours all of it stays empty.
struct SceneOrigin {
    std::string format;                ///< the other program
    std::vector<std::string> warnings; ///< what was left out, without changing the outcome: "file: /place: reason"
    double duration = 0;               ///< s, how long the file wants to be run
};

/// Reads and validates a scene file and the meshes it names. Throws IoError where the scene file cannot be read, and
/// InputError with one line per problem ("file: /bodies/3/position: reason") where anything in it is wrong.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& file, const SceneFileOptions& options = {},
                                          SceneOrigin* origin = nullptr);

/// The same from text in memory. `source` names it in messages; mesh paths are relative to `folder`.
[[nodiscard]] SceneDescription parse_scene(std::string_view text, const std::string& source,
                                           const std::filesystem::path& folder, const SceneFileOptions& options = {},
                                           SceneOrigin* origin = nullptr);

/// Writes a scene as JSON that parse_scene reads back to the same bits. Shapes with a mesh path refer to it, others are
/// written with their vertices; settings and body fields equal to their defaults are left out.
void write_scene(std::ostream& out, const SceneDescription& scene);

} // namespace flotilla
