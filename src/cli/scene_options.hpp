// SPDX-License-Identifier: MIT
// The scene that a command reads, with --preset and --set; the same for every command that reads one.
#pragma once

#include <string>
#include <vector>

#include <flotilla/scene_file.hpp>

namespace CLI {
class App;
}

namespace flotilla::cli {

struct SceneArguments {
    std::string preset = "balanced";
    std::vector<std::string> set; ///< "key=value"

    /// Throws InputError where a --set has no '=' or its key or value is wrong.
    [[nodiscard]] SceneFileOptions resolve() const;
    /// What the preset asks for and the scene's own settings replaced, a line each.
    [[nodiscard]] std::vector<std::string> overridden_by_scene(const Settings& settings) const;
};

/// A scene as it was read.
struct LoadedScene {
    std::string source; ///< names it in messages
    std::string text;   ///< JSON, as a scene of ours
    SceneDescription scene;
    SceneOrigin origin;
};

inline constexpr const char* kStandardInput =
    "-"; ///< instead of a file; mesh paths are then relative to the current folder

/// Reads a scene, of ours or of another program; what was left out of it is said on stderr.
[[nodiscard]] LoadedScene load_scene(const std::string& argument, const SceneFileOptions& options);

void add_scene_options(CLI::App& command, SceneArguments& arguments);

} // namespace flotilla::cli
