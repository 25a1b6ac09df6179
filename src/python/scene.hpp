// SPDX-License-Identifier: MIT
// Scenes from what Python has: files, JSON, dicts, meshes and arrays.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>
#include <flotilla/scene_file.hpp>

#include "python/casters.hpp"

namespace flotilla::python {

using ScenePointer = std::shared_ptr<SceneDescription>;

/// A scene that a caller gave, and its name in messages.
struct NamedScene {
    ScenePointer scene;
    std::string source;
    SceneOrigin origin{}; ///< of another program's file
};

/// What every function takes as a scene: a Scene (shared, not copied), the path of a file, JSON text, or a dict as such
/// text has. `preset` (None: balanced) and `settings` (a dict or None) are those of a file, text or dict; a Scene has
/// its own.
[[nodiscard]] NamedScene scene_argument(const py::object& scene, const py::object& preset, const py::object& settings);

/// The JSON text that a caller gave, as such or as a dict; none for anything else, such as the path of a file.
[[nodiscard]] std::optional<std::string> json_argument(const py::object& value);

/// From (time, position) or (time, position, rotation) each.
[[nodiscard]] std::vector<Keyframe> keyframes_of(const py::iterable& source);

/// A Body that is of no Scene: what is set there is set there alone.
[[nodiscard]] py::object lone_body(const BodyDescription& body);

/// JSON that needs no other file: all vertices are in it.
[[nodiscard]] std::string self_contained_json(SceneDescription scene);

} // namespace flotilla::python
