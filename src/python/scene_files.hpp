// SPDX-License-Identifier: MIT
// Scenes as text, and from files and the library.
#pragma once

#include "python/bind.hpp"
#include "python/scene.hpp"

namespace flotilla::python {

void bind_scene_files(py::module_& m);

/// `inline_meshes`: with all vertices, else with the mesh paths as they were written.
[[nodiscard]] std::string as_json(const SceneDescription& scene, bool inline_meshes);

} // namespace flotilla::python
