// SPDX-License-Identifier: MIT
// Reading of scene files; what the values mean is checked afterwards, in scene/description_checks.
#include <algorithm>
#include <array>
#include <map>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "base/floating_point.hpp"
#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/file.hpp"
#include "io/json_reader.hpp"
#include "io/mesh_source.hpp"
#include "io/rigid_ipc.hpp"
#include "io/scene_keys.hpp"
#include "io/scene_parts.hpp"
#include "mesh/triangle_mesh.hpp"
#include "scene/description_checks.hpp"
#include "scene/settings_table.hpp"

namespace flotilla {

namespace {

using io::Json;
using io::JsonPlace;
using io::kBodyKeys;
using io::kIgnoreKeys;
using io::kind_of;
using io::kKeyframeKeys;
using io::kLockedAxes;
using io::kSceneKeys;
using io::kShapeKeys;
using std::string_view_literals::operator""sv;

class SceneReader : io::JsonReader {
  public:
    SceneReader(std::filesystem::path folder, ErrorList& errors) : JsonReader(errors), folder_(std::move(folder)) {}

    void read(const Json& document, const SceneFileOptions& options, SceneDescription& scene);
    void read_shape(const Json& value, const JsonPlace& at, ShapeDescription& shape);
    void read_body(const Json& value, const JsonPlace& at, const SceneDescription& scene, BodyDescription& body);
    void name_shapes(const SceneDescription& scene);

  private:
    /// Whether it is an object; its keys must be among `keys`.
    [[nodiscard]] bool has_keys(const Json& value, const JsonPlace& at, std::span<const std::string_view> keys);

    using JsonReader::to;
    bool to(Quat& out, const Json& value, const JsonPlace& at);
    bool to(Keyframe& out, const Json& value, const JsonPlace& at);
    bool to(NamedPair& out, const Json& value, const JsonPlace& at);
    bool to(std::int32_t& out, const Json& value, const JsonPlace& at);
    bool to(std::array<std::int32_t, 2>& out, const Json& value, const JsonPlace& at);
    template <class Value>
    bool to(std::vector<Value>& out, const Json& value, const JsonPlace& at);
    template <class Value>
    bool get(Value& out, const Json& object, const JsonPlace& at, std::string_view key, bool required = false);

    void read_version(const Json& document, const JsonPlace& at);
    void read_settings(const Json& value, const JsonPlace& at, Settings& settings);
    void read_surface(const Json& value, const JsonPlace& at, ShapeDescription& shape);
    void read_segments_and_points(const Json& value, const JsonPlace& at, ShapeDescription& shape);
    void read_mesh_file(const JsonPlace& at, ShapeDescription& shape);
    void read_mass(const Json& value, const JsonPlace& at, ShapeDescription& shape);
    void read_inertia(const Json& value, const JsonPlace& at, ShapeDescription& shape);
    void read_body_shape(const Json& value, const JsonPlace& at, BodyDescription& body);
    void read_body_type(const Json& value, const JsonPlace& at, BodyDescription& body);
    void read_locked(const Json& value, const JsonPlace& at, BodyDescription& body);
    void read_ignored(const Json& value, const JsonPlace& at, SceneDescription& scene);

    std::filesystem::path folder_;
    std::map<std::string, TriangleMesh> meshes_; ///< read so far, by path as written
    std::map<std::string_view, std::int32_t> shape_index_;
    std::vector<std::string_view> shape_names_;
};

bool SceneReader::has_keys(const Json& value, const JsonPlace& at, std::span<const std::string_view> keys) {
    if (!is_object(value, at)) return false;
    for (const auto& item : value.items())
        if (std::find(keys.begin(), keys.end(), item.key()) == keys.end())
            problem(at.member(item.key()), unknown_name("key", item.key(), keys));
    return true;
}

bool SceneReader::to(Quat& out, const Json& value, const JsonPlace& at) {
    std::array<double, 4> q{};
    if (!numbers(q, value, at, "an array of 4 numbers [w, x, y, z]")) return false;
    out = {q[0], q[1], q[2], q[3]};
    return true;
}

bool SceneReader::to(NamedPair& out, const Json& value, const JsonPlace& at) {
    if (!value.is_array() || value.size() != 2) {
        problem(at, "must be an array of 2 names, got " + kind_of(value));
        return false;
    }
    return to(out.a, value[0], at.element(0)) && to(out.b, value[1], at.element(1));
}

bool SceneReader::to(std::int32_t& out, const Json& value, const JsonPlace& at) {
    const bool good = value.is_number_unsigned() && value.get<std::uint64_t>() <= 0x7fffffffU;
    if (good)
        out = value.get<std::int32_t>();
    else
        problem(at, "must be a vertex number counted from 0, got " + kind_of(value));
    return good;
}

bool SceneReader::to(std::array<std::int32_t, 2>& out, const Json& value, const JsonPlace& at) {
    if (!value.is_array() || value.size() != 2) {
        problem(at, "must be an array of 2 vertex numbers, got " + kind_of(value));
        return false;
    }
    return to(out[0], value[0], at.element(0)) && to(out[1], value[1], at.element(1));
}

bool SceneReader::to(Keyframe& out, const Json& value, const JsonPlace& at) {
    if (!has_keys(value, at, kKeyframeKeys)) return false;
    get(out.time, value, at, "time", true);
    get(out.position, value, at, "position", true);
    get(out.rotation, value, at, "rotation");
    return true;
}

template <class Value>
bool SceneReader::to(std::vector<Value>& out, const Json& value, const JsonPlace& at) {
    if (!is_array(value, at, "an array")) return false;
    out.resize(value.size());
    bool good = true;
    for (std::size_t i = 0; i < out.size(); ++i) good &= to(out[i], value[i], at.element(i));
    return good;
}

template <class Value>
bool SceneReader::get(Value& out, const Json& object, const JsonPlace& at, std::string_view key, bool required) {
    const Json* value = member(object, at, key, required);
    return value != nullptr && to(out, *value, at.member(key));
}

void SceneReader::read_version(const Json& document, const JsonPlace& at) {
    const Json* version = member(document, at, "flotilla_scene", true);
    if (version != nullptr && !(version->is_number() && version->get<double>() == 1))
        problem(at.member("flotilla_scene"), "must be 1, the version of the format, got " + kind_of(*version));
}

void SceneReader::read_settings(const Json& value, const JsonPlace& at, Settings& settings) {
    if (!has_keys(value, at, setting_keys())) return;
    for (const auto& item : value.items()) {
        const SettingRow* row = find_setting(item.key());
        if (row == nullptr) continue;
        const Json& v = item.value();
        SettingValue given;
        if (v.is_boolean())
            given = v.get<bool>();
        else if (v.is_number_unsigned())
            given = v.get<std::uint64_t>();
        else if (v.is_number_integer())
            given = v.get<std::int64_t>();
        else if (v.is_number_float())
            given = v.get<double>();
        else if (v.is_string())
            given = v.get<std::string>();
        else {
            problem(at.member(item.key()), "must be a number, a boolean or a string, got " + kind_of(v));
            continue;
        }
        if (const auto reason = assign_setting(settings, *row, given)) problem(at.member(item.key()), *reason);
    }
}

void SceneReader::read_mesh_file(const JsonPlace& at, ShapeDescription& shape) {
    const auto known = meshes_.find(shape.mesh_path);
    try {
        const TriangleMesh& mesh = known != meshes_.end()
                                       ? known->second
                                       : (meshes_[shape.mesh_path] = io::read_mesh_source(folder_, shape.mesh_path));
        shape.vertices = mesh.vertices;
        shape.triangles = mesh.triangles;
    } catch (
        const std::runtime_error& error) { // InputError or IoError: either way the scene names a mesh that is not there
        problem(at.member("mesh"), error.what());
    }
}

/// Both follow the triangles.
void SceneReader::read_segments_and_points(const Json& value, const JsonPlace& at, ShapeDescription& shape) {
    std::vector<std::array<std::int32_t, 2>> segments;
    std::vector<std::int32_t> points;
    if (!get(segments, value, at, "segments")) segments.clear();
    if (!get(points, value, at, "points")) points.clear();
    const auto exists = [&](std::int32_t v, const char* key, std::size_t i) {
        const bool good = static_cast<std::size_t>(v) < shape.vertices.size();
        if (!good)
            problem(at.member(key).element(i), "vertex " + std::to_string(v) + " does not exist; there are " +
                                                   std::to_string(shape.vertices.size()));
        return good;
    };
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const auto [a, b] = segments[i];
        if (a == b)
            problem(at.member("segments").element(i), "has both ends at vertex " + std::to_string(a));
        else if (exists(a, "segments", i) && exists(b, "segments", i))
            shape.triangles.push_back(segment_element(a, b));
    }
    for (std::size_t i = 0; i < points.size(); ++i)
        if (exists(points[i], "points", i)) shape.triangles.push_back(point_element(points[i]));
}

void SceneReader::read_surface(const Json& value, const JsonPlace& at, ShapeDescription& shape) {
    const bool has_mesh = value.contains("mesh");
    const bool has_elements = value.contains("segments") || value.contains("points");
    const bool has_inline = value.contains("vertices") || value.contains("triangles") || has_elements;
    if (has_mesh && has_inline) problem(at.member("mesh"), "give either a mesh or vertices and triangles, not both");
    if (!has_mesh && !has_inline)
        problem(at.member("mesh"), "is missing: a shape needs a mesh, or vertices and triangles");
    if (has_inline) {
        get(shape.vertices, value, at, "vertices", true);
        get(shape.triangles, value, at, "triangles", !has_elements);
        read_segments_and_points(value, at, shape);
    } else if (has_mesh && get(shape.mesh_path, value, at, "mesh")) {
        read_mesh_file(at, shape);
    }
    get(shape.scale, value, at, "scale");
    for (Vec3& v : shape.vertices) v *= shape.scale;
    if (has_inline && shape.scale >= kMinScale && shape.scale <= kMaxScale) shape.scale = 1; // now part of the vertices
}

void SceneReader::read_mass(const Json& value, const JsonPlace& at, ShapeDescription& shape) {
    constexpr std::array kKinds{std::pair{"surface_density"sv, MassKind::surface_density},
                                std::pair{"density"sv, MassKind::density}, std::pair{"mass"sv, MassKind::mass},
                                std::pair{"line_density"sv, MassKind::line_density}};
    for (const auto& [key, kind] : kKinds) {
        double given = 0;
        if (!get(given, value, at, key)) continue;
        if (shape.mass_kind != MassKind::none) {
            problem(at.member(key), "give only one of surface_density, density, line_density and mass");
            continue;
        }
        shape.mass_kind = kind;
        shape.mass_value = given;
    }
}

void SceneReader::read_inertia(const Json& value, const JsonPlace& at, ShapeDescription& shape) {
    const Json* inertia = member(value, at, "inertia");
    if (inertia == nullptr) return;
    const JsonPlace place = at.member("inertia");
    Mat3 full;
    Vec3 principal;
    if (inertia->is_array() && inertia->size() == 9) {
        if (numbers(full.m, *inertia, place, "")) shape.inertia = full;
    } else if (inertia->is_array() && inertia->size() == 3) {
        if (to(principal, *inertia, place)) shape.inertia = diagonal(principal);
    } else {
        problem(place, "must be an array of 3 (principal values) or 9 (row-major) numbers, got " + kind_of(*inertia));
    }
}

void SceneReader::read_shape(const Json& value, const JsonPlace& at, ShapeDescription& shape) {
    if (!has_keys(value, at, kShapeKeys)) return;
    get(shape.name, value, at, "name", true);
    read_surface(value, at, shape);
    read_mass(value, at, shape);
    read_inertia(value, at, shape);
    if (Vec3 center; get(center, value, at, "center_of_mass")) shape.center_of_mass = center;
}

void SceneReader::name_shapes(const SceneDescription& scene) {
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
        shape_index_.try_emplace(scene.shapes[i].name, static_cast<std::int32_t>(i));
        shape_names_.push_back(scene.shapes[i].name);
    }
}

void SceneReader::read_body_shape(const Json& value, const JsonPlace& at, BodyDescription& body) {
    std::string name;
    if (!get(name, value, at, "shape", true)) return;
    const auto found = shape_index_.find(name);
    if (found == shape_index_.end())
        problem(at.member("shape"), unknown_name("shape", name, shape_names_));
    else
        body.shape = found->second;
}

void SceneReader::read_body_type(const Json& value, const JsonPlace& at, BodyDescription& body) {
    constexpr std::array kTypes{"dynamic"sv, "static"sv, "kinematic"sv}; // in the order of BodyType
    std::string name;
    if (!get(name, value, at, "type")) return;
    const auto found = std::find(kTypes.begin(), kTypes.end(), name);
    if (found == kTypes.end())
        problem(at.member("type"), unknown_name("body type", name, kTypes) + " (dynamic, static, kinematic)");
    else
        body.type = static_cast<BodyType>(found - kTypes.begin());
}

void SceneReader::read_locked(const Json& value, const JsonPlace& at, BodyDescription& body) {
    std::vector<std::string> names;
    if (!get(names, value, at, "locked")) return;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const JsonPlace list = at.member("locked"), place = list.element(i);
        const auto found = std::find(kLockedAxes.begin(), kLockedAxes.end(), names[i]);
        if (found == kLockedAxes.end()) {
            problem(place, unknown_name("axis", names[i], kLockedAxes) + " (x, y, z, rx, ry, rz)");
            continue;
        }
        const auto axis = static_cast<std::size_t>(found - kLockedAxes.begin());
        bool& locked = axis < 3 ? body.locked_translation[axis] : body.locked_rotation[axis - 3];
        if (locked) problem(place, "names " + in_quotes(names[i]) + " again");
        locked = true;
    }
}

void SceneReader::read_body(const Json& value, const JsonPlace& at, const SceneDescription& scene,
                            BodyDescription& body) {
    body.friction = scene.settings.friction;
    body.restitution = scene.settings.restitution;
    if (!has_keys(value, at, kBodyKeys)) return;
    get(body.name, value, at, "name", true);
    read_body_shape(value, at, body);
    read_body_type(value, at, body);
    get(body.position, value, at, "position");
    get(body.rotation, value, at, "rotation");
    get(body.velocity, value, at, "velocity");
    get(body.angular_velocity, value, at, "angular_velocity");
    get(body.friction, value, at, "friction");
    get(body.restitution, value, at, "restitution");
    get(body.keyframes, value, at, "keyframes");
    read_locked(value, at, body);
    get(body.force, value, at, "force");
    get(body.torque, value, at, "torque");
    get(body.group, value, at, "group");
}

void SceneReader::read_ignored(const Json& value, const JsonPlace& at, SceneDescription& scene) {
    if (!has_keys(value, at, kIgnoreKeys)) return;
    get(scene.ignored_groups, value, at, "groups");
    get(scene.ignored_bodies, value, at, "bodies");
}

void SceneReader::read(const Json& document, const SceneFileOptions& options, SceneDescription& scene) {
    const JsonPlace top;
    if (!has_keys(document, top, kSceneKeys)) return;
    read_version(document, top);
    get(scene.gravity, document, top, "gravity");
    if (const Json* settings = member(document, top, "settings"))
        read_settings(*settings, top.member("settings"), scene.settings);
    for (const auto& [key, value] : options.overrides) set_setting(scene.settings, key, value);

    const JsonPlace shapes_at = top.member("shapes"), bodies_at = top.member("bodies");
    if (const Json* shapes = member(document, top, "shapes", true);
        shapes != nullptr && is_array(*shapes, shapes_at, "an array of shapes")) {
        scene.shapes.resize(shapes->size());
        for (std::size_t i = 0; i < shapes->size(); ++i)
            read_shape((*shapes)[i], shapes_at.element(i), scene.shapes[i]);
    }
    name_shapes(scene);
    if (const Json* bodies = member(document, top, "bodies", true);
        bodies != nullptr && is_array(*bodies, bodies_at, "an array of bodies")) {
        scene.bodies.resize(bodies->size());
        for (std::size_t i = 0; i < bodies->size(); ++i)
            read_body((*bodies)[i], bodies_at.element(i), scene, scene.bodies[i]);
    }
    if (const Json* ignored = member(document, top, "ignore")) read_ignored(*ignored, top.member("ignore"), scene);
}

} // namespace

ShapeDescription io::read_shape(const Json& value, const JsonPlace& at, const std::filesystem::path& folder,
                                ErrorList& errors) {
    ShapeDescription shape;
    SceneReader(folder, errors).read_shape(value, at, shape);
    return shape;
}

BodyDescription io::read_body(const Json& value, const JsonPlace& at, const SceneDescription& scene,
                              ErrorList& errors) {
    BodyDescription body;
    SceneReader reader({}, errors);
    reader.name_shapes(scene);
    reader.read_body(value, at, scene, body);
    return body;
}

SceneDescription parse_scene(std::string_view text, const std::string& source, const std::filesystem::path& folder,
                             const SceneFileOptions& options, SceneOrigin* origin) {
    const DefaultFloatingPoint environment;
    SceneDescription scene;
    scene.settings = preset(options.preset);
    ErrorList errors(source);
    SceneOrigin read_from;
    const Json document = io::parse_json(text, errors);
    const io::MemoryForTheEnd memory(text.size());
    if (io::is_rigid_ipc(document)) {
        io::read_rigid_ipc(document, folder, options, scene, read_from, errors);
    } else if (!document.is_discarded()) {
        SceneReader(folder, errors).read(document, options, scene);
        check_description(scene, errors);
    }
    errors.throw_if_any();
    if (origin != nullptr) *origin = std::move(read_from);
    return scene;
}

SceneDescription read_scene(const std::filesystem::path& file, const SceneFileOptions& options, SceneOrigin* origin) {
    const DefaultFloatingPoint environment;
    return parse_scene(io::read_text(file), file.string(), file.parent_path(), options, origin);
}

} // namespace flotilla
