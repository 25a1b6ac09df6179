// SPDX-License-Identifier: MIT
// Worlds that change between steps, and what they answer about their bodies.
#include <flotilla/query.hpp>

#include "python/bind.hpp"
#include "python/world_class.hpp"

namespace flotilla::python {
namespace {

void bind_id(py::module_& m) {
    auto id =
        value_class<BodyId>(m, "BodyId", "A body of a World; of one that was removed it is refused, never mistaken.");
    id.def(py::init<std::int32_t, std::uint32_t>(), py::arg("index"), py::arg("generation") = 0);
    id.def_readonly("index", &BodyId::index, "place in the arrays of the World");
    id.def_readonly("generation", &BodyId::generation, "how many bodies held the place before");
    id.def(
        "__eq__", [](const BodyId& a, const BodyId& b) { return a == b; }, py::is_operator());
    id.def("__hash__", [](const BodyId& b) { return py::hash(py::make_tuple(b.index, b.generation)); });
}

void bind_answers(py::module_& m) {
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

    auto touching = value_class<BodyContacts>(m, "BodyContacts", "What touches a body, by the last step.");
    touching.def_property_readonly(
        "contacts",
        [](const BodyContacts& c) {
            const auto n = static_cast<py::ssize_t>(c.contacts.size());
            return owning_array(std::vector(c.contacts), contact_type(), {n});
        },
        "structured array of those that the body is part of, as World.contacts has them");
    touching.def_readonly("force", &BodyContacts::force, "N, of all of them on the body, shape (3)");
    touching.def_readonly("torque", &BodyContacts::torque, "N m, about its centre of mass, shape (3)");

    auto memory = value_class<MemoryUse>(m, "MemoryUse", "Bytes that grow with the scene.");
    memory.def_readonly("shapes", &MemoryUse::shapes, "meshes and their hierarchies");
    memory.def_readonly("bodies", &MemoryUse::bodies, "world vertices and boxes, at both ends of a step");
    memory.def_readonly("contacts", &MemoryUse::contacts, "and the impulses kept for the next step");
    memory.def_readonly("pairs", &MemoryUse::pairs, "what is known of pairs of bodies");
    memory.def_property_readonly(
        "total", [](const MemoryUse& use) { return use.total(); }, "of all four");
}

/// A shape or body of the World is described as one of a scene: by a Scene that holds it, last.
BodyId add_body(PythonWorld& w, const py::object& shape, const py::kwargs& options) {
    const auto scene = std::make_shared<SceneDescription>();
    scene->settings = w.world().settings();
    scene->shapes.push_back({});
    py::cast(scene).attr("add_body")(0, **options);
    BodyDescription body = scene->bodies.back();
    body.shape = w.shape_number(shape);
    if (!options.contains("name") || options["name"].is_none()) body.name.clear();
    return w.edit().add_body(std::move(body));
}
std::int32_t add_shape(PythonWorld& w, const py::object& mesh, const py::kwargs& options) {
    const auto scene = std::make_shared<SceneDescription>();
    py::cast(scene).attr("add_shape")(mesh, **options);
    ShapeDescription& shape = scene->shapes.back();
    if (!options.contains("name") || options["name"].is_none()) shape.name.clear();
    return w.edit().add_shape(std::move(shape));
}

void bind_bodies(WorldClass& type) {
    type.def(
        "add_shape", &add_shape, py::arg("mesh"),
        "Adds a mesh with the options of Scene.add_shape and returns the number that add_body knows it by. Without a "
        "name it gets a free one.");
    type.def(
        "remove_shape", [](PythonWorld& w, const py::object& shape) { w.edit().remove_shape(w.shape_number(shape)); },
        py::arg("shape"),
        "Lets go of a shape, a number or a name, that add_shape added and no body has. Its number is given to the next "
        "one that comes; those of others stay.");
    type.def(
        "add_body", &add_body, py::arg("shape"),
        "Adds a body with the options of Scene.add_body and returns its BodyId. shape: a number, of the scene's shapes "
        "or of add_shape, or a name. "
        "OverlapError where it would intersect another; then nothing has changed, as with every edit that is refused.");
    type.def(
        "remove_body", [](PythonWorld& w, BodyId body) { w.edit().remove_body(body); }, py::arg("body"),
        "Removes a body; its place is given to the next one that comes, with another generation.");
    type.def(
        "id", [](const PythonWorld& w, std::size_t index) { return w.world().id(index); }, py::arg("index"),
        "BodyId of the present body at a place.");
    type.def_property_readonly(
        "ids", [](const PythonWorld& w) { return w.world().ids(); }, "BodyId of all present bodies, by place");
    type.def(
        "find", [](const PythonWorld& w, const std::string& name) { return w.world().find(name); }, py::arg("name"),
        "BodyId of the body with a name.");
    type.def(
        "contains", [](const PythonWorld& w, BodyId body) { return w.world().contains(body); }, py::arg("body"),
        "Whether the body was not removed.");
    type.def(
        "wake", [](PythonWorld& w, BodyId body) { w.edit().wake(body); }, py::arg("body"),
        "Wakes a body and what it touches.");
    type.def(
        "generation", [](const PythonWorld& w, std::size_t index) { return w.world().generation(index); },
        py::arg("index"), "How many bodies a place held before.");
    type.def(
        "name", [](const PythonWorld& w, BodyId body) { return w.world().name(body); }, py::arg("body"),
        "Name of a body.");
    type.def(
        "description", [](const PythonWorld& w, BodyId body) { return lone_body(w.world().description(body)); },
        py::arg("body"),
        "A Body with what a body is now, but for pose and velocities, which World.body has; what is set there changes "
        "no World.");
    type.def(
        "set_user_data", [](PythonWorld& w, BodyId body, std::uint64_t data) { w.edit().set_user_data(body, data); },
        py::arg("body"), py::arg("data"),
        "A number of the caller's own, 0 to 2^64 - 1. In snapshots of an edited World, in no hash.");
    type.def(
        "user_data", [](const PythonWorld& w, BodyId body) { return w.world().user_data(body); }, py::arg("body"),
        "What set_user_data set; 0 at first.");
}

void bind_filters(WorldClass& type) {
    type.def(
        "set_group", [](PythonWorld& w, BodyId body, const std::string& group) { w.edit().set_group(body, group); },
        py::arg("body"), py::arg("group"), "The group that a body is of; empty: none.");
    type.def(
        "ignore_groups",
        [](PythonWorld& w, const std::string& a, const std::string& b, bool ignored) {
            w.edit().ignore_groups(a, b, ignored);
        },
        py::arg("a"), py::arg("b"), py::arg("ignored") = true,
        "Whether bodies of two groups, or of one where both names are the same, may pass through each other. "
        "OverlapError where they may no longer, and intersect.");
    type.def(
        "ignore_pair", [](PythonWorld& w, BodyId a, BodyId b, bool ignored) { w.edit().ignore_pair(a, b, ignored); },
        py::arg("a"), py::arg("b"), py::arg("ignored") = true, "The same of two bodies.");
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
        py::arg("body"), py::arg("type"),
        "Makes a body dynamic or static; what becomes dynamic is at rest, and has the locked axes and the constant "
        "force "
        "that it had as such.");
    type.def(
        "set_script",
        [](PythonWorld& w, BodyId b, const py::iterable& keyframes) {
            w.edit().set_script(b, keyframes_of(keyframes));
        },
        py::arg("body"), py::arg("keyframes"),
        "Makes a body kinematic: it goes from where it is to these places, (time, position[, rotation]) each, s, m and "
        "unit quaternion w x y z, whose times are all later than the World's.");
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
        [](const PythonWorld& w, const py::object& s, const Vec3& x, const Quat& q) {
            return w.world().overlapping(w.shape_number(s), x, q);
        },
        py::arg("shape"), py::arg("position"), py::arg("rotation") = Quat{},
        "Bodies that a shape at a pose would intersect: those that add_body would refuse it for.");
    type.def(
        "bodies_in", [](const PythonWorld& w, const Vec3& a, const Vec3& b) { return w.world().bodies_in(a, b); },
        py::arg("lower"), py::arg("upper"),
        "Bodies with a point of their surface in the box, boundary included; exact.");
    type.def(
        "contacts_of", [](const PythonWorld& w, BodyId body) { return w.world().contacts_of(body); }, py::arg("body"),
        "BodyContacts: the contact points of a body, and their force and torque on it.");
    type.def_property_readonly(
        "memory", [](const PythonWorld& w) { return w.world().memory(); }, "MemoryUse");
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

void bind_edit_values(py::module_& m) {
    bind_id(m);
    bind_answers(m);
}

void bind_edits(WorldClass& type) {
    bind_bodies(type);
    bind_changes(type);
    bind_filters(type);
    bind_questions(type);
}

} // namespace flotilla::python
