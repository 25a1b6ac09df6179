// SPDX-License-Identifier: MIT
#include "run_folder/run_inputs.hpp"

#include <algorithm>
#include <functional>
#include <string_view>

#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "run_folder/run_files.hpp"

namespace flotilla::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kInputs[] = {"scene_hash", "seed", "settings", "time_step", "trajectory"};
constexpr std::string_view kChanging[] = {"started", "updated", "frames", "status"};

bool contains(std::span<const std::string_view> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

constexpr std::size_t kLongestText = 200; // of a value, for people: meshes may stand in scene files

std::string text_of(const Json* value) {
    if (value == nullptr) return "";
    const std::string text = value->is_string() ? value->get<std::string>() : value->dump();
    return text.size() <= kLongestText ? text : text.substr(0, kLongestText) + "...";
}

using Report = std::function<void(const std::string& path, const Json* a, const Json* b)>;

/// Calls `report` for every member, at any depth, that only one has or whose values differ.
void find_differences(const std::string& path, const Json* a, const Json* b, const Report& report) {
    const bool both = a != nullptr && b != nullptr;
    if (both && *a == *b) return;
    // A vector or a command line is one value; a list of bodies is not.
    const auto is_list = [](const Json& json) { return json.is_array() && !json.empty() && json[0].is_structured(); };
    if (both && is_list(*a) && is_list(*b) && a->size() == b->size()) {
        for (std::size_t i = 0; i < a->size(); ++i)
            find_differences(path + "/" + std::to_string(i), &(*a)[i], &(*b)[i], report);
        return;
    }
    if (!both || !a->is_object() || !b->is_object()) return report(path, a, b);
    const auto member = [](const Json& object, const std::string& key) {
        const auto found = object.find(key);
        return found == object.end() ? nullptr : &*found;
    };
    const std::string prefix = path.empty() ? "" : path + "/";
    for (const auto& [key, value] : a->items()) find_differences(prefix + key, &value, member(*b, key), report);
    for (const auto& [key, value] : b->items())
        if (!a->contains(key)) find_differences(prefix + key, nullptr, &value, report);
}

std::string_view first_part(std::string_view path) { return path.substr(0, path.find('/')); }

/// A scene as text may be missing or nonsense in folders that others wrote: then there is nothing to compare.
Json scene_of(const RunReader& run) {
    Json scene;
    try {
        scene = Json::parse(read_text(run.folder() / kSceneJson), nullptr, false);
    } catch (const IoError&) {
        return Json::object();
    }
    if (!scene.is_object()) return Json::object();
    scene.erase("settings");
    if (scene.contains("shapes") && scene["shapes"].is_array())
        for (auto& shape : scene["shapes"])
            if (shape.is_object()) shape.erase("mesh");
    return scene;
}

bool same_shape(const RunShape& a, const RunShape& b) {
    return a.mesh.vertices == b.mesh.vertices && a.mesh.triangles == b.mesh.triangles &&
           a.center_of_mass == b.center_of_mass;
}

} // namespace

std::vector<RecordDifference> record_differences(const RunReader& a, const RunReader& b) {
    std::vector<RecordDifference> differences;
    const Json run_a = Json::parse(a.run_json()), run_b = Json::parse(b.run_json());
    find_differences("", &run_a, &run_b, [&](const std::string& path, const Json* x, const Json* y) {
        const std::string_view top = first_part(path);
        if (!contains(kChanging, top)) differences.push_back({path, text_of(x), text_of(y), contains(kInputs, top)});
    });
    const Json scene_a = scene_of(a), scene_b = scene_of(b);
    if (scene_a.empty() || scene_b.empty()) return differences;
    find_differences("", &scene_a, &scene_b, [&](const std::string& path, const Json* x, const Json* y) {
        differences.push_back({"scene.json " + path, text_of(x), text_of(y), true});
    });
    return differences;
}

bool same_bodies(const RunScene& a, const RunScene& b) {
    if (a.bodies.size() != b.bodies.size() || a.shapes.size() != b.shapes.size()) return false;
    for (std::size_t i = 0; i < a.shapes.size(); ++i)
        if (!same_shape(a.shapes[i], b.shapes[i])) return false;
    for (std::size_t i = 0; i < a.bodies.size(); ++i)
        if (a.bodies[i].name != b.bodies[i].name || a.bodies[i].shape != b.bodies[i].shape ||
            a.bodies[i].type != b.bodies[i].type)
            return false;
    return true;
}

} // namespace flotilla::io
