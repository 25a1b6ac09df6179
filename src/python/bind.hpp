// SPDX-License-Identifier: MIT
// The parts of the extension module, and what they share.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/names.hpp>

#include "python/casters.hpp"

namespace flotilla::python {

void bind_errors(py::module_& m);
void bind_settings(py::module_& m);
void bind_scene(py::module_& m);
void bind_reports(py::module_& m);
void bind_world(py::module_& m);
void bind_run(py::module_& m);
void bind_run_folder(py::module_& m);
void bind_verify(py::module_& m);
void bind_sweep(py::module_& m);
void bind_tools(py::module_& m);

/// By BodyType.
inline constexpr std::array<std::string_view, 3> kBodyTypes{"dynamic", "static", "kinematic"};

/// A value of an enumeration by its name; the values are those of the positions in `names`.
template <class Enum>
Enum choice(std::string_view kind, std::string_view name, std::span<const std::string_view> names) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return static_cast<Enum>(i);
    throw InputError(unknown_name(kind, name, names));
}

/// "StepReport(step=1, time=0.04, ...)": all properties of an object, in the order of their definition.
[[nodiscard]] std::string represent(const py::object& object);
/// The same as a dict.
[[nodiscard]] py::dict properties(const py::object& object);

/// A class of values that Python reads: repr shows all of them.
template <class T>
py::class_<T> value_class(py::module_& m, const char* name, const char* doc) {
    py::class_<T> type(m, name, doc);
    type.def("__repr__", [](const py::object& self) { return represent(self); });
    return type;
}

} // namespace flotilla::python
