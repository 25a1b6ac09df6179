// SPDX-License-Identifier: MIT
// flotilla._core: the library as Python sees it. The package beside it, src/python/flotilla, adds what is easier said
// in Python.
#include <flotilla/build_info.hpp>

#include "python/bind.hpp"

namespace flotilla::python {

py::dict properties(const py::object& object) {
    py::dict out;
    for (const auto& [name, value] : py::type::of(object).attr("__dict__").cast<py::dict>())
        if (py::isinstance(value, py::module_::import("builtins").attr("property"))) out[name] = object.attr(name);
    return out;
}

std::string represent(const py::object& object) {
    std::string text = py::type::of(object).attr("__name__").cast<std::string>() + '(';
    const char* separator = "";
    for (const auto& [name, value] : properties(object)) {
        text += separator + name.cast<std::string>() + '=' + py::repr(value).cast<std::string>();
        separator = ", ";
    }
    return text + ')';
}

namespace {

py::dict build_info_dict() {
    const BuildInfo info = build_info();
    py::dict out;
    out["version"] = info.version;
    out["commit"] = info.commit;
    out["compiler"] = info.compiler;
    out["flags"] = info.flags;
    return out;
}

} // namespace
} // namespace flotilla::python

PYBIND11_MODULE(_core, m) {
    using namespace flotilla::python;
    m.doc() = "The compiled part of flotilla.";
    m.def("build_info", &build_info_dict, "What the library was built from: version, commit, compiler, flags.");
    bind_errors(m);
    bind_settings(m);
    bind_reports(m);
    bind_scene(m);
    bind_world(m);
    bind_run(m);
    bind_run_folder(m);
    bind_verify(m);
    bind_sweep(m);
    bind_tools(m);
}
