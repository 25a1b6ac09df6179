// SPDX-License-Identifier: MIT
// Edits from what Python has.
#pragma once

#include <vector>

#include <flotilla/edit.hpp>

#include "python/scene.hpp"

namespace flotilla::python {

/// What every function takes as edits of a scene: a list of Edit, the path of a file, JSON text, a dict, or None.
[[nodiscard]] std::vector<Edit> edits_argument(const py::object& edits, const SceneDescription& scene);

} // namespace flotilla::python
