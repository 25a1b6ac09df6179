// SPDX-License-Identifier: MIT
// Scenes that Python builds and reads. Shape and Body are places in a scene by index, which they keep alive: no pointer
// into its lists, which grow, ever leaves.
#include "python/scene.hpp"

#include <algorithm>
#include <limits>

#include <flotilla/scene_file.hpp>

#include "python/bind.hpp"
#include "python/scene_files.hpp"
#include "python/settings_values.hpp"

namespace flotilla::python {
namespace {

constexpr std::array<std::string_view, 5> kMassKinds{"none", "surface_density", "density", "mass", "line_density"};

struct ShapeOf {
    ScenePointer scene;
    std::size_t index;
    [[nodiscard]] ShapeDescription& get() const { return scene->shapes.at(index); }
};
struct BodyOf {
    ScenePointer scene;
    std::size_t index;
    [[nodiscard]] BodyDescription& get() const { return scene->bodies.at(index); }
};

template <class Item, class Items>
py::tuple places(const ScenePointer& scene, const Items& items) {
    py::tuple out(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) out[i] = Item{scene, i};
    return out;
}

/// What numpy makes an array of; its own error where that is nothing.
template <class T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

std::vector<Vec3> vertices_of(const py::handle& source) {
    const Array<double> array(py::reinterpret_borrow<py::object>(source));
    if (array.ndim() != 2 || array.shape(1) != 3) throw InputError("vertices must be an array of shape (n, 3)");
    std::vector<Vec3> out(static_cast<std::size_t>(array.shape(0)));
    std::memcpy(static_cast<void*>(out.data()), array.data(), out.size() * sizeof(Vec3));
    return out;
}

/// Of any integer type: what does not fit into an index is refused, not cut. A row of two is a segment, of one a point.
std::vector<Triangle> triangles_of(const py::handle& source) {
    const py::array any(py::reinterpret_borrow<py::object>(source));
    if (any.ndim() != 2 || any.shape(1) < 1 || any.shape(1) > 3)
        throw InputError("faces must be an array of shape (n, 3), or (n, 2) of segments, or (n, 1) of points");
    const auto width = static_cast<std::size_t>(any.shape(1));
    if (any.size() > 0 && any.dtype().kind() != 'i' && any.dtype().kind() != 'u')
        throw InputError("faces must be whole numbers, indices of vertices");
    const Array<std::int64_t> array(py::reinterpret_borrow<py::object>(any));
    std::vector<Triangle> out(static_cast<std::size_t>(array.shape(0)));
    for (std::size_t i = 0; i < out.size() * 3; ++i) {
        const std::int64_t vertex = array.data()[i / 3 * width + std::min(i % 3, width - 1)];
        if (vertex < 0 || vertex > std::numeric_limits<std::int32_t>::max())
            throw InputError("faces: vertex " + std::to_string(vertex) + " does not exist");
        out[i / 3][i % 3] = static_cast<std::int32_t>(vertex);
    }
    return out;
}

struct MeshArrays {
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
};
MeshArrays mesh_of(const py::object& mesh) {
    if (py::hasattr(mesh, "vertices") && py::hasattr(mesh, "faces"))
        return {vertices_of(mesh.attr("vertices")), triangles_of(mesh.attr("faces"))};
    if ((py::isinstance<py::tuple>(mesh) || py::isinstance<py::list>(mesh)) && py::len(mesh) == 2) {
        const auto pair = mesh.cast<py::sequence>();
        return {vertices_of(pair[0]), triangles_of(pair[1])};
    }
    throw py::type_error("a mesh is an object with .vertices and .faces, or a pair of arrays (vertices, faces)");
}

/// The first name of "shape0", "shape1", ... from the list's length on that no item has.
template <class Items>
std::string free_name(const Items& items, const std::string& stem) {
    for (std::size_t k = items.size();; ++k) {
        const std::string name = stem + std::to_string(k);
        if (std::none_of(items.begin(), items.end(), [&](const auto& item) { return item.name == name; })) return name;
    }
}

void set_mass(ShapeDescription& shape, std::optional<double> surface_density, std::optional<double> density,
              std::optional<double> mass, std::optional<double> line_density) {
    if (surface_density.has_value() + density.has_value() + mass.has_value() + line_density.has_value() > 1)
        throw InputError("a shape has one of surface_density, density, line_density and mass");
    const auto set = [&](MassKind kind, std::optional<double> value) {
        if (value) shape.mass_kind = kind, shape.mass_value = *value;
    };
    set(MassKind::surface_density, surface_density);
    set(MassKind::density, density);
    set(MassKind::mass, mass);
    set(MassKind::line_density, line_density);
}

std::optional<Mat3> inertia_of(const py::object& source) {
    if (source.is_none()) return {};
    const Array<double> array(source);
    Mat3 out;
    if (array.size() == 9)
        std::memcpy(out.m.data(), array.data(), sizeof out.m);
    else if (array.size() == 3)
        for (std::size_t i = 0; i < 3; ++i) out.m[4 * i] = array.data()[i];
    else
        throw InputError("inertia must have shape (3), principal values, or (3, 3)");
    return out;
}

std::int32_t add_shape(SceneDescription& scene, const py::object& mesh, const std::optional<std::string>& name,
                       double scale, std::optional<double> surface_density, std::optional<double> density,
                       std::optional<double> mass, std::optional<double> line_density, const py::object& inertia,
                       std::optional<Vec3> center_of_mass) {
    MeshArrays arrays = mesh_of(mesh);
    ShapeDescription shape;
    shape.name = name ? *name : free_name(scene.shapes, "shape");
    shape.vertices = std::move(arrays.vertices);
    shape.triangles = std::move(arrays.triangles);
    for (Vec3& v : shape.vertices) v = {scale * v.x, scale * v.y, scale * v.z};
    set_mass(shape, surface_density, density, mass, line_density);
    shape.inertia = inertia_of(inertia);
    shape.center_of_mass = center_of_mass;
    scene.shapes.push_back(std::move(shape));
    return static_cast<std::int32_t>(scene.shapes.size() - 1);
}

std::int32_t shape_index(const SceneDescription& scene, const py::object& shape) {
    if (py::isinstance<py::str>(shape)) {
        const auto name = shape.cast<std::string>();
        std::vector<std::string_view> names;
        for (std::size_t i = 0; i < scene.shapes.size(); ++i) {
            if (scene.shapes[i].name == name) return static_cast<std::int32_t>(i);
            names.push_back(scene.shapes[i].name);
        }
        throw InputError(unknown_name("shape", name, names));
    }
    const auto index = shape.cast<std::int64_t>();
    if (index < 0 || static_cast<std::size_t>(index) >= scene.shapes.size())
        throw InputError("shape " + std::to_string(index) + " does not exist: there are " +
                         std::to_string(scene.shapes.size()));
    return static_cast<std::int32_t>(index);
}

/// (time, position) or (time, position, rotation).
Keyframe keyframe_of(const py::handle& source) {
    const auto values = source.cast<py::sequence>();
    if (values.size() != 2 && values.size() != 3)
        throw InputError("a keyframe is (time, position) or (time, position, rotation)");
    Keyframe out{values[0].cast<double>(), values[1].cast<Vec3>(), {}};
    if (values.size() == 3) out.rotation = values[2].cast<Quat>();
    return out;
}

/// World axes along which, and about which, a body does not move.
constexpr std::array<std::string_view, 3> kAlong{"x", "y", "z"}, kAbout{"rx", "ry", "rz"};

void set_locked(BodyDescription& body, const py::iterable& axes) {
    body.locked_translation = body.locked_rotation = {};
    for (const py::handle axis : axes) {
        const auto name = axis.cast<std::string>();
        const bool turns = !name.empty() && name[0] == 'r';
        const auto& names = turns ? kAbout : kAlong;
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) throw InputError("locked: an axis is x, y, z, rx, ry or rz, not \"" + name + '"');
        (turns ? body.locked_rotation : body.locked_translation)[static_cast<std::size_t>(found - names.begin())] =
            true;
    }
}
py::tuple locked_of(const BodyDescription& body) {
    py::list out;
    for (std::size_t k = 0; k < 3; ++k)
        if (body.locked_translation[k]) out.append(kAlong[k]);
    for (std::size_t k = 0; k < 3; ++k)
        if (body.locked_rotation[k]) out.append(kAbout[k]);
    return py::tuple(out);
}

std::int32_t add_body(SceneDescription& scene, const py::object& shape, const std::optional<std::string>& name,
                      const std::string& type, const Vec3& position, const Quat& rotation, const Vec3& velocity,
                      const Vec3& angular_velocity, std::optional<double> friction, std::optional<double> restitution,
                      const py::iterable& keyframes, const py::iterable& locked, const Vec3& force, const Vec3& torque,
                      const std::string& group) {
    BodyDescription body;
    body.name = name ? *name : free_name(scene.bodies, "body");
    body.shape = shape_index(scene, shape);
    body.type = choice<BodyType>("type of a body", type, kBodyTypes);
    body.keyframes = keyframes_of(keyframes);
    body.position = body.keyframes.empty() ? position : body.keyframes.front().position;
    body.rotation = body.keyframes.empty() ? rotation : body.keyframes.front().rotation;
    body.velocity = velocity;
    body.angular_velocity = angular_velocity;
    body.friction = friction.value_or(scene.settings.friction);
    body.restitution = restitution.value_or(scene.settings.restitution);
    set_locked(body, locked);
    body.force = force;
    body.torque = torque;
    body.group = group;
    scene.bodies.push_back(std::move(body));
    return static_cast<std::int32_t>(scene.bodies.size() - 1);
}

ScenePointer new_scene(const Vec3& gravity, const std::string& name, const py::object& settings) {
    auto scene = std::make_shared<SceneDescription>();
    scene->gravity = gravity;
    scene->settings = preset(name);
    for (const auto& [key, value] : overrides_of(settings)) set_setting(scene->settings, key, value);
    return scene;
}

std::string_view name_of_type(const BodyDescription& body) { return kBodyTypes[static_cast<std::size_t>(body.type)]; }

void bind_shape(py::module_& m) {
    auto type = value_class<ShapeOf>(m, "Shape", "A mesh of a scene, shared by its bodies.");
    type.def_property_readonly("name", [](const ShapeOf& s) { return s.get().name; });
    type.def_property_readonly(
        "mesh_path", [](const ShapeOf& s) { return s.get().mesh_path; }, "as written in the scene file; empty: inline");
    type.def_property_readonly(
        "scale", [](const ShapeOf& s) { return s.get().scale; }, "vertices are scaled already");
    type.def_property_readonly(
        "vertices", [](const ShapeOf& s) { return rows(std::vector(s.get().vertices)); },
        "m, mesh coordinates, shape (vertices, 3); a copy");
    type.def_property_readonly(
        "faces",
        [](const ShapeOf& s) {
            std::vector<Triangle> faces = s.get().triangles;
            const auto n = static_cast<py::ssize_t>(faces.size());
            return owning_array(std::move(faces), py::dtype::of<std::int32_t>(), {n, 3});
        },
        "indices of vertices, shape (triangles, 3), one twice in a row that is a segment, thrice in a point; a copy");
    type.def_property_readonly(
        "mass_kind", [](const ShapeOf& s) { return kMassKinds[static_cast<std::size_t>(s.get().mass_kind)]; },
        "none, surface_density (kg/m^2), density (kg/m^3), line_density (kg/m) or mass (kg)");
    type.def_property_readonly(
        "mass_value", [](const ShapeOf& s) { return s.get().mass_value; }, "in the unit of mass_kind");
    type.def_property_readonly(
        "inertia",
        [](const ShapeOf& s) -> std::optional<py::array> {
            if (!s.get().inertia) return {};
            return to_array(s.get().inertia->m).reshape({3, 3});
        },
        "kg m^2 about the centre of mass, mesh axes, shape (3, 3); None: computed");
    type.def_property_readonly(
        "center_of_mass", [](const ShapeOf& s) { return s.get().center_of_mass; },
        "m, mesh coordinates, shape (3); None: computed");
}

void bind_body(py::module_& m) {
    auto type = value_class<BodyOf>(m, "Body", "A body of a scene at its start; what is set here is set in the scene.");
    type.def_property(
        "name", [](const BodyOf& b) { return b.get().name; },
        [](const BodyOf& b, std::string v) { b.get().name = std::move(v); });
    type.def_property_readonly(
        "shape", [](const BodyOf& b) { return b.get().shape; }, "index of its shape");
    type.def_property(
        "type", [](const BodyOf& b) { return name_of_type(b.get()); },
        [](const BodyOf& b, const std::string& v) { b.get().type = choice<BodyType>("type of a body", v, kBodyTypes); },
        "dynamic, static or kinematic");
    const auto field = [&](const char* name, auto member, const char* doc) {
        using Value = std::remove_reference_t<decltype(std::declval<BodyDescription&>().*member)>;
        type.def_property(
            name, [member](const BodyOf& b) { return b.get().*member; },
            [member](const BodyOf& b, const Value& v) { b.get().*member = v; }, doc);
    };
    field("position", &BodyDescription::position, "of the mesh's own origin, m, shape (3)");
    field("rotation", &BodyDescription::rotation, "unit quaternion w x y z, shape (4)");
    field("velocity", &BodyDescription::velocity, "of the centre of mass, m/s, shape (3)");
    field("angular_velocity", &BodyDescription::angular_velocity, "rad/s, world axes, shape (3)");
    field("friction", &BodyDescription::friction, "coefficient, >= 0; pairs take the geometric mean");
    field("restitution", &BodyDescription::restitution, "in [0, 1]; pairs take the larger one");
    field("force", &BodyDescription::force, "N on a dynamic body, all the time, at its centre of mass, shape (3)");
    field("torque", &BodyDescription::torque, "N m, likewise");
    field("group", &BodyDescription::group, "name for Scene.ignore_groups; empty: none");
    type.def_property(
        "locked", [](const BodyOf& b) { return locked_of(b.get()); },
        [](const BodyOf& b, const py::iterable& axes) { set_locked(b.get(), axes); },
        "of a dynamic body: a tuple of the world axes along which its centre of mass never moves, x, y, z, and about "
        "which it never turns, rx, ry, rz");
    type.def_property(
        "keyframes",
        [](const BodyOf& b) {
            py::list out;
            for (const Keyframe& k : b.get().keyframes) out.append(py::make_tuple(k.time, k.position, k.rotation));
            return py::tuple(out);
        },
        [](const BodyOf& b, const py::iterable& keyframes) { b.get().keyframes = keyframes_of(keyframes); },
        "of a kinematic body: (time in s, position in m, rotation) each");
}

py::list pairs_of(const std::vector<NamedPair>& pairs) {
    py::list out;
    for (const NamedPair& pair : pairs) out.append(py::make_tuple(pair.a, pair.b));
    return out;
}

using SceneClass = py::class_<SceneDescription, ScenePointer>;

/// What may pass through what.
void bind_ignored(SceneClass& type) {
    const auto adds = [&](const char* name, auto list, const char* doc) {
        type.def(
            name,
            [list](SceneDescription& s, std::string a, std::string b) {
                (s.*list).push_back({std::move(a), std::move(b)});
            },
            py::arg("a"), py::arg("b"), doc);
    };
    adds("ignore_groups", &SceneDescription::ignored_groups,
         "Bodies of two groups, or of one where both names are the same, may pass through each other, and intersect at "
         "the start. Nothing is promised of them.");
    adds("ignore_bodies", &SceneDescription::ignored_bodies, "The same of two bodies, by name.");
    type.def_property_readonly(
        "ignored_groups", [](const SceneDescription& s) { return pairs_of(s.ignored_groups); },
        "pairs of names of groups");
    type.def_property_readonly(
        "ignored_bodies", [](const SceneDescription& s) { return pairs_of(s.ignored_bodies); },
        "pairs of names of bodies");
}

void bind_additions(SceneClass& type) {
    type.def(
        "add_shape", &add_shape, py::arg("mesh"), py::kw_only(), py::arg("name") = py::none(), py::arg("scale") = 1.0,
        py::arg("surface_density") = py::none(), py::arg("density") = py::none(), py::arg("mass") = py::none(),
        py::arg("line_density") = py::none(), py::arg("inertia") = py::none(), py::arg("center_of_mass") = py::none(),
        "Adds a mesh and returns its index. mesh: an object with .vertices (n, 3) and .faces (m, 3), or a pair of "
        "such arrays; rows of two numbers in place of three are segments, rows of one are points; "
        "vertices times scale are metres. Mass: surface_density (kg/m^2, thin shell), density (kg/m^3, closed "
        "mesh), line_density (kg/m, segments) or mass (kg, spread over the surface, of a closed mesh too, which is "
        "hollow then, the segments or the points); shapes of static and kinematic bodies need none. "
        "inertia: kg m^2 about the centre of mass, "
        "mesh axes, shape (3) or (3, 3); center_of_mass: m, mesh coordinates; both replace what is computed.");
    type.def("add_body", &add_body, py::arg("shape"), py::kw_only(), py::arg("name") = py::none(),
             py::arg("type") = "dynamic", py::arg("position") = Vec3{}, py::arg("rotation") = Quat{},
             py::arg("velocity") = Vec3{}, py::arg("angular_velocity") = Vec3{}, py::arg("friction") = py::none(),
             py::arg("restitution") = py::none(), py::arg("keyframes") = py::tuple(), py::arg("locked") = py::tuple(),
             py::arg("force") = Vec3{}, py::arg("torque") = Vec3{}, py::arg("group") = "",
             "Adds a body and returns its index. shape: index or name; type: dynamic, static or kinematic; position of "
             "the mesh's own "
             "origin, m; rotation: unit quaternion w x y z; velocity of the centre of mass, m/s; angular_velocity: "
             "rad/s. friction and "
             "restitution are the settings' unless given. keyframes of a kinematic body: (time, position[, rotation]) "
             "each, the first "
             "at time 0, which is its start. locked: world axes along which the centre of mass of a dynamic body never "
             "moves, x, y, z, and about which it never turns, rx, ry, rz. force (N, at the centre of mass) and torque "
             "(N m) act all the time, in world axes. group: a name for ignore_groups.");
}

void bind_text(SceneClass& type) {
    type.def("to_json", &as_json, py::arg("inline_meshes") = true,
             "The scene as JSON that reads back to the same bits; inline_meshes: with all vertices, else with the mesh "
             "paths as they were written.");
    type.def(
        "to_dict",
        [](const SceneDescription& s) { return py::module_::import("json").attr("loads")(self_contained_json(s)); },
        "The scene as a dict that every function takes as a scene.");
    type.def("__repr__", [](const SceneDescription& s) {
        return "Scene(" + std::to_string(s.shapes.size()) + " shapes, " + std::to_string(s.bodies.size()) + " bodies)";
    });
    type.def("__copy__", [](const SceneDescription& s) { return SceneDescription(s); });
    type.def(
        "__deepcopy__", [](const SceneDescription& s, const py::dict&) { return SceneDescription(s); },
        py::arg("memo"));
}

void bind_scene_class(py::module_& m) {
    SceneClass type(
        m, "Scene",
        "A scene: gravity, settings, shapes and bodies; SI units. It is checked when a World is made of it.");
    type.def(py::init(&new_scene), py::kw_only(), py::arg("gravity") = Vec3{0, 0, -9.8}, py::arg("preset") = "balanced",
             py::arg("settings") = py::none(),
             "An empty scene. gravity: m/s^2, shape (3); settings: a dict of changes to the preset.");
    type.def_readwrite("gravity", &SceneDescription::gravity, "m/s^2, shape (3)");
    type.def_readwrite("settings", &SceneDescription::settings, "Settings, to be changed in place or replaced");
    type.def_property_readonly(
        "shapes", [](const ScenePointer& s) { return places<ShapeOf>(s, s->shapes); }, "a tuple of Shape");
    type.def_property_readonly(
        "bodies", [](const ScenePointer& s) { return places<BodyOf>(s, s->bodies); }, "a tuple of Body");
    bind_additions(type);
    bind_ignored(type);
    bind_text(type);
}

} // namespace

std::vector<Keyframe> keyframes_of(const py::iterable& source) {
    std::vector<Keyframe> out;
    for (const py::handle k : source) out.push_back(keyframe_of(k));
    return out;
}

py::object lone_body(const BodyDescription& body) {
    const auto scene = std::make_shared<SceneDescription>();
    scene->bodies.push_back(body);
    return py::cast(BodyOf{scene, 0});
}

void bind_scene(py::module_& m) {
    bind_shape(m);
    bind_body(m);
    bind_scene_class(m);
    bind_scene_files(m);
}

} // namespace flotilla::python
