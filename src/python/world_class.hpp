// SPDX-License-Identifier: MIT
#pragma once

#include "python/world.hpp"

namespace flotilla::python {

using WorldClass = py::class_<PythonWorld>;

/// Types of what edits and questions take and give; before the class World.
void bind_edit_values(py::module_& m);
void bind_edits(WorldClass& type);

} // namespace flotilla::python
