// SPDX-License-Identifier: MIT
// Scenes from what Python has: files, JSON, dicts, meshes and arrays.
#pragma once

#include <memory>
#include <string>

#include <flotilla/scene.hpp>

#include "python/casters.hpp"

namespace flotilla::python {

using ScenePointer = std::shared_ptr<SceneDescription>;

/// A scene that a caller gave, and its name in messages.
struct NamedScene {
    ScenePointer scene;
    std::string source;
};

/// What every function takes as a scene: a Scene (shared, not copied), the path of a file, JSON text, or a dict as such
/// text has. `preset` (None: balanced) and `settings` (a dict or None) are those of a file, text or dict; a Scene has
/// its own.
[[nodiscard]] NamedScene scene_argument(const py::object& scene, const py::object& preset, const py::object& settings);

/// JSON that needs no other file: all vertices are in it.
[[nodiscard]] std::string self_contained_json(SceneDescription scene);

} // namespace flotilla::python
