// SPDX-License-Identifier: MIT
#include <filesystem>
#include <sstream>

#include <flotilla/scene_file.hpp>

#include "python/bind.hpp"
#include "python/scene.hpp"
#include "python/settings_values.hpp"

namespace flotilla::python {
namespace {

bool is_json(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && text[first] == '{';
}

/// numpy's arrays and numbers as lists and numbers.
std::string json_of(const py::dict& scene) {
    const auto plain = py::cpp_function([](const py::object& value) -> py::object {
        if (py::hasattr(value, "tolist")) return value.attr("tolist")();
        throw py::type_error("a scene cannot hold a value of type " +
                             py::type::of(value).attr("__name__").cast<std::string>());
    });
    return py::module_::import("json").attr("dumps")(scene, py::arg("default") = plain).cast<std::string>();
}

SceneFileOptions file_options(const py::object& preset, const py::object& settings) {
    SceneFileOptions options;
    if (!preset.is_none()) options.preset = preset.cast<std::string>();
    options.overrides = overrides_of(settings);
    return options;
}

NamedScene named(SceneDescription&& scene, std::string source) {
    return {std::make_shared<SceneDescription>(std::move(scene)), std::move(source)};
}

} // namespace

NamedScene scene_argument(const py::object& scene, const py::object& preset, const py::object& settings) {
    if (py::isinstance<SceneDescription>(scene)) {
        if (!preset.is_none() || !settings.is_none())
            throw InputError("preset and settings are for scene files; a Scene has its own: change scene.settings");
        return {scene.cast<ScenePointer>(), "scene"};
    }
    const SceneFileOptions options = file_options(preset, settings);
    if (py::isinstance<py::dict>(scene))
        return named(parse_scene(json_of(scene.cast<py::dict>()), "scene", ".", options), "scene");
    if (py::isinstance<py::str>(scene) && is_json(scene.cast<std::string>()))
        return named(parse_scene(scene.cast<std::string>(), "scene", ".", options), "scene");
    if (!py::isinstance<py::str>(scene) && !py::hasattr(scene, "__fspath__"))
        throw py::type_error("a scene is a flotilla.Scene, the path of a file, JSON text or a dict, not " +
                             py::type::of(scene).attr("__name__").cast<std::string>());
    const auto path = scene.cast<std::filesystem::path>();
    return named(read_scene(path, options), path.string());
}

std::string self_contained_json(SceneDescription scene) {
    for (ShapeDescription& shape : scene.shapes) {
        shape.mesh_path.clear(); // the vertices are scaled already
        shape.scale = 1;
    }
    std::ostringstream out;
    write_scene(out, scene);
    return std::move(out).str();
}

} // namespace flotilla::python
