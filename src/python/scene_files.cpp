// SPDX-License-Identifier: MIT
// Scenes from files and from the library.
#include "python/scene_files.hpp"

#include <fstream>
#include <sstream>

#include <flotilla/scene_library.hpp>

namespace flotilla::python {
namespace {

void write(const SceneDescription& scene, const std::filesystem::path& path, bool inline_meshes) {
    std::ofstream out(path, std::ios::binary);
    out << as_json(scene, inline_meshes);
    if (!out.flush()) throw IoError(path.string() + ": cannot be written");
}

void bind_library(py::module_& m) {
    auto entry = value_class<LibraryScene>(m, "LibraryScene", "A scene that make_scene knows.");
    entry.def_readonly("name", &LibraryScene::name);
    entry.def_readonly("default_bodies", &LibraryScene::default_bodies);
    entry.def_readonly("min_bodies", &LibraryScene::min_bodies);
    entry.def_readonly("max_bodies", &LibraryScene::max_bodies);
    entry.def_readonly("description", &LibraryScene::description);
    m.def("list_scenes", &list_scenes, "Every scene of the library.");
    m.def(
        "make_scene",
        [](const std::string& name, int bodies, std::uint64_t seed) {
            return std::make_shared<SceneDescription>(make_scene(name, bodies, seed));
        },
        py::arg("name"), py::kw_only(), py::arg("bodies") = 0, py::arg("seed") = 0,
        "A scene of the library; bodies 0: its default number. The same bits on every machine.");
}

} // namespace

std::string as_json(const SceneDescription& scene, bool inline_meshes) {
    if (inline_meshes) return self_contained_json(scene);
    std::ostringstream out;
    write_scene(out, scene);
    return std::move(out).str();
}

void bind_scene_files(py::module_& m) {
    m.def(
        "read_scene",
        [](const py::object& scene, const py::object& preset, const py::object& settings) {
            return scene_argument(scene, preset, settings).scene;
        },
        py::arg("scene"), py::kw_only(), py::arg("preset") = py::none(), py::arg("settings") = py::none(),
        "A Scene from the path of a file, JSON text or a dict. What the file says replaces the preset's settings; "
        "`settings`, a dict, "
        "replaces both. Mesh paths in text and dicts are relative to the current folder.");
    auto origin =
        value_class<SceneOrigin>(m, "SceneOrigin", "What another program's scene file says beside the scene.");
    origin.def_readonly("format", &SceneOrigin::format, "the other program; empty: the file is flotilla's own");
    origin.def_readonly("warnings", &SceneOrigin::warnings, "what was left out, without changing the outcome");
    origin.def_readonly("duration", &SceneOrigin::duration, "s, how long the file wants to be run");
    m.def(
        "scene_origin", [](const py::object& scene) { return scene_argument(scene, py::none(), py::none()).origin; },
        py::arg("scene"), "SceneOrigin of what read_scene reads, files of Rigid-IPC among it.");
    m.def("write_scene", &write, py::arg("scene"), py::arg("path"), py::kw_only(), py::arg("inline_meshes") = true,
          "Writes a scene file; see Scene.to_json.");
    bind_library(m);
}

} // namespace flotilla::python
