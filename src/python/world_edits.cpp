// SPDX-License-Identifier: MIT
// Worlds that change between steps, and what they answer about their bodies.
#include <flotilla/query.hpp>

#include "python/bind.hpp"
#include "python/world_class.hpp"

namespace flotilla::python {
namespace {

constexpr std::array<std::string_view, 3> kBodyTypes{"dynamic", "static", "kinematic"};

void bind_values(py::module_& m) {
    auto id =
        value_class<BodyId>(m, "BodyId", "A body of a World; of one that was removed it is refused, never mistaken.");
    id.def(py::init<std::int32_t, std::uint32_t>(), py::arg("index"), py::arg("generation") = 0);
    id.def_readonly("index", &BodyId::index, "place in the arrays of the World");
    id.def_readonly("generation", &BodyId::generation, "how many bodies held the place before");
    id.def(
        "__eq__", [](const BodyId& a, const BodyId& b) { return a == b; }, py::is_operator());
    id.def("__hash__", [](const BodyId& b) { return py::hash(py::make_tuple(b.index, b.generation)); });

    auto hit = value_class<RayHit>(m, "RayHit", "What a ray meets first.");
    hit.def_readonly("body", &RayHit::body);
    hit.def_readonly("triangle", &RayHit::triangle, "of its shape");
    hit.def_readonly("distance", &RayHit::distance, "m, from the ray's origin");
    hit.def_readonly("point", &RayHit::point, "m, shape (3)");
    hit.def_readonly("normal", &RayHit::normal, "unit, of the triangle, against the ray, shape (3)");

    auto near = value_class<ClosestPoints>(m, "ClosestPoints", "Where two bodies are nearest.");
    near.def_readonly("distance", &ClosestPoints::distance, "m");
    near.def_readonly("point_a", &ClosestPoints::point_a, "m, shape (3)");
    near.def_readonly("point_b", &ClosestPoints::point_b, "m, shape (3)");
    near.def_readonly("triangle_a", &ClosestPoints::triangle_a, "of its shape");
    near.def_readonly("triangle_b", &ClosestPoints::triangle_b, "of its shape");
}

/// A shape or body of the World is described as one of a scene: by a Scene that holds it, last.
BodyId add_body(PythonWorld& w, const py::object& shape, const py::kwargs& options) {
    const auto scene = std::make_shared<SceneDescription>();
    scene->settings = w.world().settings();
    scene->shapes.push_back({});
    py::cast(scene).attr("add_body")(0, **options);
    BodyDescription body = scene->bodies.back();
    body.shape = shape.cast<std::int32_t>();
    if (!options.contains("name")) body.name.clear();
    return w.edit().add_body(std::move(body));
}
std::int32_t add_shape(PythonWorld& w, const py::object& mesh, const py::kwargs& options) {
    const auto scene = std::make_shared<SceneDescription>();
    py::cast(scene).attr("add_shape")(mesh, **options);
    return w.add_shape(scene->shapes.back());
}

void bind_bodies(WorldClass& type) {
    type.def("add_shape", &add_shape, py::arg("mesh"),
             "Adds a mesh with the options of Scene.add_shape and returns the number that add_body knows it by.");
    type.def(
        "add_body", &add_body, py::arg("shape"),
        "Adds a body with the options of Scene.add_body and returns its BodyId. shape: a number, of the scene's shapes "
        "or of add_shape. "
        "OverlapError where it would intersect another; then nothing has changed, as with every edit that is refused.");
    type.def(
        "remove_body", [](PythonWorld& w, BodyId body) { w.edit().remove_body(body); }, py::arg("body"),
        "Removes a body; its place is given to the next one that comes, with another generation.");
    type.def(
        "id", [](const PythonWorld& w, std::size_t index) { return w.world().id(index); }, py::arg("index"),
        "BodyId of the present body at a place.");
    type.def(
        "find", [](const PythonWorld& w, const std::string& name) { return w.world().find(name); }, py::arg("name"),
        "BodyId of the body with a name.");
    type.def(
        "contains", [](const PythonWorld& w, BodyId body) { return w.world().contains(body); }, py::arg("body"),
        "Whether the body was not removed.");
    type.def(
        "wake", [](PythonWorld& w, BodyId body) { w.edit().wake(body); }, py::arg("body"),
        "Wakes a body and what it touches.");
}

void bind_changes(WorldClass& type) {
    type.def(
        "set_pose", [](PythonWorld& w, BodyId b, const Vec3& x, const Quat& q) { w.edit().set_pose(b, x, q); },
        py::arg("body"), py::arg("position"), py::arg("rotation") = Quat{},
        "Puts a body elsewhere, m and unit quaternion w x y z, without having been on the way; its velocities stay.");
    type.def(
        "set_velocity", [](PythonWorld& w, BodyId b, const Vec3& v, const Vec3& o) { w.edit().set_velocity(b, v, o); },
        py::arg("body"), py::arg("velocity"), py::arg("angular_velocity") = Vec3{},
        "m/s of the centre of mass, and rad/s.");
    type.def(
        "set_type",
        [](PythonWorld& w, BodyId b, const std::string& t) {
            w.edit().set_type(b, choice<BodyType>("type of a body", t, kBodyTypes));
        },
        py::arg("body"), py::arg("type"), "Makes a body dynamic or static; what becomes dynamic is at rest.");
    type.def(
        "set_material", [](PythonWorld& w, BodyId b, double f, double r) { w.edit().set_material(b, f, r); },
        py::arg("body"), py::arg("friction"), py::arg("restitution"), "Coefficients of a body.");
    type.def(
        "set_force", [](PythonWorld& w, BodyId b, const Vec3& f, const Vec3& t) { w.edit().set_force(b, f, t); },
        py::arg("body"), py::arg("force"), py::arg("torque") = Vec3{},
        "N and N m at the centre of mass, until it is set again.");
    type.def(
        "apply_force", [](PythonWorld& w, BodyId b, const Vec3& f, const Vec3& p) { w.edit().apply_force(b, f, p); },
        py::arg("body"), py::arg("force"), py::arg("point"), "N at a point (m, world), for the next step.");
    type.def(
        "apply_torque", [](PythonWorld& w, BodyId b, const Vec3& t) { w.edit().apply_torque(b, t); }, py::arg("body"),
        py::arg("torque"), "N m, for the next step.");
    type.def(
        "apply_impulse",
        [](PythonWorld& w, BodyId b, const Vec3& i, const Vec3& p) { w.edit().apply_impulse(b, i, p); },
        py::arg("body"), py::arg("impulse"), py::arg("point"),
        "N s at a point (m, world): the velocities change at once.");
    type.def(
        "set_gravity", [](PythonWorld& w, const Vec3& g) { w.edit().set_gravity(g); }, py::arg("gravity"),
        "m/s^2, shape (3).");
}

void bind_questions(WorldClass& type) {
    type.def(
        "ray",
        [](const PythonWorld& w, const Vec3& o, const Vec3& d, double reach) { return w.world().ray(o, d, reach); },
        py::arg("origin"), py::arg("direction"), py::arg("reach"),
        "RayHit of the first body on the ray within reach (m), or None. The direction need not be a unit vector.");
    type.def(
        "closest", [](const PythonWorld& w, BodyId a, BodyId b) { return w.world().closest(a, b); }, py::arg("a"),
        py::arg("b"), "ClosestPoints of two bodies.");
    type.def(
        "overlapping",
        [](const PythonWorld& w, std::int32_t s, const Vec3& x, const Quat& q) {
            return w.world().overlapping(s, x, q);
        },
        py::arg("shape"), py::arg("position"), py::arg("rotation") = Quat{},
        "Bodies that a shape at a pose would intersect: those that add_body would refuse it for.");
    type.def(
        "bodies_in", [](const PythonWorld& w, const Vec3& a, const Vec3& b) { return w.world().bodies_in(a, b); },
        py::arg("lower"), py::arg("upper"),
        "Bodies with a point of their surface in the box, boundary included; exact.");
    type.def_property_readonly(
        "gravity", [](const PythonWorld& w) { return w.world().gravity(); }, "m/s^2, shape (3)");
    type.def_property_readonly(
        "energy", [](const PythonWorld& w) { return w.world().energy(); },
        "J, kinetic and potential, of the dynamic bodies as they are now");
    type.def_property_readonly(
        "num_bodies", [](const PythonWorld& w) { return w.world().num_bodies(); },
        "present; len() counts the places of removed ones too");
}

} // namespace

void bind_edit_values(py::module_& m) { bind_values(m); }

void bind_edits(WorldClass& type) {
    bind_bodies(type);
    bind_changes(type);
    bind_questions(type);
}

} // namespace flotilla::python
