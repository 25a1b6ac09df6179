// SPDX-License-Identifier: MIT
// The class World, part by part.
#pragma once

#include "python/world.hpp"

namespace flotilla::python {

using WorldClass = py::class_<PythonWorld>;

/// Types of what edits and questions take and give; before the class World.
void bind_edit_values(py::module_& m);
/// Edit and the functions on files of edits; before the class World.
void bind_edit_files(py::module_& m);
void bind_edits(WorldClass& type);
void bind_recorded_edits(WorldClass& type);
void bind_views(WorldClass& type);
void bind_callbacks(WorldClass& type);

/// For the class: a callback that holds its World is found by Python's collector of cycles.
[[nodiscard]] py::custom_type_setup collected_with_callbacks();

/// Of an array of ContactState.
[[nodiscard]] py::dtype contact_type();
/// A structured type as it lies in memory.
[[nodiscard]] py::dtype structured(const py::list& names, const py::list& formats, const py::list& offsets,
                                   std::size_t size);

} // namespace flotilla::python
