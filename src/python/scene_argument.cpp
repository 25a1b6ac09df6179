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
std::string json_of(const py::dict& document) {
    const auto plain = py::cpp_function([](const py::object& value) -> py::object {
        if (py::hasattr(value, "tolist")) return value.attr("tolist")();
        throw py::type_error("JSON cannot hold a value of type " +
                             py::type::of(value).attr("__name__").cast<std::string>());
    });
    return py::module_::import("json").attr("dumps")(document, py::arg("default") = plain).cast<std::string>();
}

SceneFileOptions file_options(const py::object& preset, const py::object& settings) {
    SceneFileOptions options;
    if (!preset.is_none()) options.preset = preset.cast<std::string>();
    options.overrides = overrides_of(settings);
    return options;
}

template <class Read>
NamedScene of_file(std::string source, Read&& read) {
    NamedScene out{nullptr, std::move(source)};
    out.scene = std::make_shared<SceneDescription>(read(&out.origin));
    return out;
}

} // namespace

std::optional<std::string> json_argument(const py::object& value) {
    if (py::isinstance<py::dict>(value)) return json_of(value.cast<py::dict>());
    if (!py::isinstance<py::str>(value)) return {};
    auto text = value.cast<std::string>();
    return is_json(text) ? std::optional(std::move(text)) : std::nullopt;
}

NamedScene scene_argument(const py::object& scene, const py::object& preset, const py::object& settings) {
    if (py::isinstance<SceneDescription>(scene)) {
        if (!preset.is_none() || !settings.is_none())
            throw InputError("preset and settings are for scene files; a Scene has its own: change scene.settings");
        return {scene.cast<ScenePointer>(), "scene"};
    }
    const SceneFileOptions options = file_options(preset, settings);
    if (const std::optional<std::string> text = json_argument(scene))
        return of_file("scene", [&](SceneOrigin* origin) { return parse_scene(*text, "scene", ".", options, origin); });
    if (!py::isinstance<py::str>(scene) && !py::hasattr(scene, "__fspath__"))
        throw py::type_error("a scene is a flotilla.Scene, the path of a file, JSON text or a dict, not " +
                             py::type::of(scene).attr("__name__").cast<std::string>());
    const auto path = scene.cast<std::filesystem::path>();
    return of_file(path.string(), [&](SceneOrigin* origin) { return read_scene(path, options, origin); });
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
