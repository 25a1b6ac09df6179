// SPDX-License-Identifier: MIT
#include "python/world.hpp"

#include <cstdio>

#include "python/bind.hpp"
#include "python/world_class.hpp"
#include "python/world_options.hpp"

namespace flotilla::python {
namespace {

World make_world(const SceneDescription& scene, const std::string& source, const WorldOptions& options,
                 const std::optional<std::string>& snapshot) {
    const py::gil_scoped_release unlocked;
    if (!snapshot) return World(scene, source, options);
    return World(scene, std::as_bytes(std::span(*snapshot)), source, options);
}

/// (bodies, ...) of what `get` gives for each body.
template <class Get>
py::array of_bodies(const PythonWorld& w, Get&& get) {
    const World& world = w.world();
    using Value = decltype(get(world, std::size_t{}));
    std::vector<Value> values(world.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = get(world, i);
    return rows(std::move(values));
}
template <auto Member>
py::array field(const PythonWorld& w) {
    return of_bodies(w, [](const World& world, std::size_t i) { return world.body(i).*Member; });
}

/// Whether the place has a body.
bool present(const World& world, std::size_t place) {
    return world.contains({static_cast<std::int32_t>(place), world.generation(place)});
}

/// What `get` gives of the description of each present body, by place.
template <class Value, class Get>
std::vector<Value> of_places(const PythonWorld& w, Get&& get) {
    const World& world = w.world();
    std::vector<Value> values(world.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (present(world, i)) values[i] = get(world.description(world.id(i)));
    return values;
}

py::array contacts_copy(const PythonWorld& w) {
    std::vector<ContactState> contacts = w.world().contacts();
    const auto n = static_cast<py::ssize_t>(contacts.size());
    return owning_array(std::move(contacts), contact_type(), {n});
}

py::array activity_of(const PythonWorld& w) {
    using A = BodyActivity;
    std::vector<A> activity = w.world().activity();
    py::list names, formats, offsets;
    for (const char* name : {"contacts", "cluster", "cost"}) names.append(name);
    for (const char* format : {"i8", "u1", "i8"}) formats.append(format);
    for (const std::size_t offset : {offsetof(A, contacts), offsetof(A, cluster), offsetof(A, cost)})
        offsets.append(offset);
    const auto n = static_cast<py::ssize_t>(activity.size());
    return owning_array(std::move(activity), structured(names, formats, offsets, sizeof(A)), {n});
}

py::bytes snapshot_of(const PythonWorld& w) {
    const std::vector<std::byte> data = w.world().snapshot();
    return {reinterpret_cast<const char*>(data.data()), data.size()};
}

std::unique_ptr<PythonWorld> new_world(const py::object& scene, const py::object& preset, const py::object& settings,
                                       const std::optional<py::bytes>& snapshot, int threads,
                                       const std::string& executor) {
    std::optional<std::string> data;
    if (snapshot) data = std::string(*snapshot);
    return std::make_unique<PythonWorld>(scene_argument(scene, preset, settings), world_options(threads, executor),
                                         data);
}

py::tuple pickle(const PythonWorld& w) {
    return py::make_tuple(self_contained_json(w.start()), snapshot_of(w), w.options().threads,
                          kExecutors[static_cast<std::size_t>(w.options().executor)]);
}
std::unique_ptr<PythonWorld> unpickle(const py::tuple& state) {
    return new_world(state[0], py::none(), py::none(), state[1].cast<py::bytes>(), state[2].cast<int>(),
                     state[3].cast<std::string>());
}

std::string text_of(const PythonWorld& w) {
    char text[96];
    std::snprintf(text, sizeof text, "World(%zu bodies, step %lld, %.6g s)", w.world().size(),
                  static_cast<long long>(w.world().steps()), w.world().time());
    return text;
}

void bind_motion(WorldClass& type) {
    type.def("__len__", [](const PythonWorld& w) { return w.world().size(); });
    type.def_property_readonly("positions", &field<&BodyState::position>,
                               "of the meshes' own origins, m, shape (bodies, 3); a copy, valid for good");
    type.def_property_readonly("rotations", &field<&BodyState::rotation>,
                               "mesh axes to world, unit quaternions w x y z, shape (bodies, 4); a copy");
    type.def_property_readonly("centers_of_mass", &field<&BodyState::center_of_mass>, "m, shape (bodies, 3); a copy");
    type.def_property_readonly("velocities", &field<&BodyState::velocity>,
                               "of the centres of mass, m/s, shape (bodies, 3); a copy");
    type.def_property_readonly("angular_velocities", &field<&BodyState::angular_velocity>,
                               "rad/s, world axes, shape (bodies, 3); a copy");
    type.def_property_readonly(
        "turns",
        [](const PythonWorld& w) { return of_bodies(w, [](const World& v, std::size_t i) { return v.turn(i); }); },
        "rotation vectors of the last inner step, with whole turns, rad, world axes, shape (bodies, 3)");
    type.def(
        "body", [](const PythonWorld& w, std::size_t index) { return w.world().body(index); }, py::arg("index"),
        "BodyState of one body.");
    type.def(
        "way", [](const PythonWorld& w, std::size_t index) { return w.world().way(index); }, py::arg("index"),
        "Where the inner steps of the last step ended: a list of WayPoint, the last of them the present pose.");
}

void bind_knowledge(WorldClass& type) {
    type.def_property_readonly(
        "names",
        [](const PythonWorld& w) { return of_places<std::string>(w, [](const BodyDescription& b) { return b.name; }); },
        "of the bodies, in their order; empty for the places of removed ones");
    type.def_property_readonly(
        "types",
        [](const PythonWorld& w) {
            return of_places<std::string_view>(
                w, [](const BodyDescription& b) { return kBodyTypes[static_cast<std::size_t>(b.type)]; });
        },
        "dynamic, static or kinematic, by body; empty for the places of removed ones");
    type.def_property_readonly(
        "steps", [](const PythonWorld& w) { return w.world().steps(); }, "made so far");
    type.def_property_readonly(
        "time", [](const PythonWorld& w) { return w.world().time(); }, "s");
    type.def_property_readonly(
        "settings", [](const PythonWorld& w) { return Settings(w.world().settings()); }, "a copy");
    type.def_property_readonly(
        "contacts", &contacts_copy,
        "structured array of the contact points at the present poses, sorted by bodies: body_a < body_b, point (m), "
        "normal (from a to b), distance along it (m), impulse on b (N s; divided by the time step, the force, without "
        "the blows of stage 1; a got its opposite), asleep, across (m, of bodies thinner than the distance at which "
        "they rest: from point to where the "
        "impulse acts on b; else zero); a copy");
    type.def_property_readonly(
        "activity", &activity_of,
        "structured array of what the last step did with each body: contacts, cluster (ClusterState), cost");
    type.def_property_readonly(
        "moved_bodies", [](const PythonWorld& w) { return w.world().moved_bodies(); },
        "what initial_overlap \"separate\" moved before the start");
    type.def_property_readonly(
        "state_hash", [](const PythonWorld& w) { return w.world().state_hash(); },
        "of all that can change a later bit; the same at any number of threads");
    type.def_property_readonly(
        "scene_hash", [](const PythonWorld& w) { return w.world().scene_hash(); },
        "of all that the bits of every step depend on");
    type.def_property_readonly(
        "threads", [](const PythonWorld& w) { return w.world().threads(); }, "a ThreadReport each");
    type.def(
        "scene", [](const PythonWorld& w) { return std::make_shared<SceneDescription>(w.start()); },
        "A copy of the scene that this World started from.");
    type.def(
        "scene_now", [](const PythonWorld& w) { return std::make_shared<SceneDescription>(w.scene_now()); },
        "The scene with the bodies where they are and as fast as they are; kinematic ones stand still in it.");
}

} // namespace

PythonWorld::PythonWorld(const NamedScene& scene, const WorldOptions& options,
                         const std::optional<std::string>& snapshot)
    : scene_(*scene.scene),
      source_(scene.source),
      options_(options),
      world_(make_world(scene_, source_, options_, snapshot)) {}

template <class Work>
auto PythonWorld::unlocked(Work&& work) const {
    struct Busy {
        explicit Busy(const PythonWorld& world) : w(world), was(std::exchange(w.busy_, true)) {
            w.busy_on_ = PyThread_get_thread_ident();
        }
        ~Busy() { w.busy_ = was; }
        Busy(const Busy&) = delete;
        Busy& operator=(const Busy&) = delete;
        const PythonWorld& w;
        bool was;
    } const busy(*this);
    const py::gil_scoped_release released;
    return work();
}

World& PythonWorld::edit() {
    static_cast<void>(world());
    return world_;
}

const World& PythonWorld::world() const {
    if (!busy_) return world_;
    if (busy_on_ != PyThread_get_thread_ident()) throw Error("the World is in a step of another thread");
    if (!in_force_callback_) throw Error("the World is in a step: only its force callback may use it");
    return world_;
}

StepReport PythonWorld::step(std::int64_t n) {
    if (n < 1) throw InputError("step: the number of steps must be at least 1, not " + std::to_string(n));
    static_cast<void>(world());
    if (busy_) throw Error("step: the World is in a step already");
    StepReport report;
    for (std::int64_t k = 0; k < n; ++k) {
        report = unlocked([&] { return world_.step(); });
        if (k + 1 < n && PyErr_CheckSignals() != 0) throw py::error_already_set();
    }
    return report;
}

void PythonWorld::restore(const std::string& snapshot) {
    static_cast<void>(world());
    unlocked([&] { world_.restore(std::as_bytes(std::span(snapshot))); });
}

PythonWorld::PythonWorld(const PythonWorld& other, World&& world, const WorldOptions& options)
    : scene_(other.scene_), source_(other.source_), options_(options), world_(std::move(world)) {}

std::unique_ptr<PythonWorld> PythonWorld::clone(const WorldOptions& options) const {
    const World& w = world();
    return std::unique_ptr<PythonWorld>(new PythonWorld(*this, unlocked([&] { return w.clone(options); }), options));
}

std::int32_t PythonWorld::shape_number(const py::object& shape) const {
    if (!py::isinstance<py::str>(shape)) return shape.cast<std::int32_t>();
    return world().find_shape(shape.cast<std::string>());
}

SceneDescription PythonWorld::scene_now() const {
    const World& w = world();
    SceneDescription now = scene_;
    now.gravity = w.gravity();
    std::vector<std::int32_t> shape_of; // by number: without those that were removed
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(w.num_shapes()); ++k) {
        const bool of_scene = static_cast<std::size_t>(k) < scene_.shapes.size(), there = w.contains_shape(k);
        if (there && !of_scene) now.shapes.push_back(w.shape(k));
        shape_of.push_back(of_scene ? k : static_cast<std::int32_t>(now.shapes.size()) - 1);
    }
    now.ignored_groups = w.ignored_groups();
    now.ignored_bodies = w.ignored_bodies();
    now.bodies.clear();
    for (std::size_t i = 0; i < w.size(); ++i) {
        if (!present(w, i)) continue;
        BodyDescription body = w.description(w.id(i));
        body.shape = shape_of[static_cast<std::size_t>(body.shape)];
        const BodyState state = w.body(i);
        body.position = state.position;
        body.rotation = state.rotation;
        body.keyframes.clear();
        if (body.type == BodyType::kinematic) body.type = BodyType::fixed;
        const bool moves = body.type == BodyType::dynamic;
        body.velocity = moves ? state.velocity : Vec3{};
        body.angular_velocity = moves ? state.angular_velocity : Vec3{};
        now.bodies.push_back(std::move(body));
    }
    // A World keeps groups whose bodies are yet to come, or are gone; a scene says nothing of them.
    const auto is_any = [&](const std::string& group) {
        return std::ranges::any_of(now.bodies, [&](const BodyDescription& body) { return body.group == group; });
    };
    std::erase_if(now.ignored_groups, [&](const NamedPair& pair) { return !is_any(pair.a) || !is_any(pair.b); });
    return now;
}

void bind_world(py::module_& m) {
    bind_edit_values(m);
    bind_edit_files(m);
    WorldClass type(m, "World",
                    "A scene in motion. No two of its bodies intersect at the end of a step: a step that could not be "
                    "proved throws "
                    "BrokenPromise. While a step runs on one thread of Python, calls from others throw Error.",
                    collected_with_callbacks());
    type.def(
        py::init(&new_world), py::arg("scene"), py::kw_only(), py::arg("preset") = py::none(),
        py::arg("settings") = py::none(), py::arg("snapshot") = py::none(), py::arg("threads") = 0,
        py::arg("executor") = "parallel",
        "scene: a Scene, the path of a file, JSON text or a dict; preset and settings as read_scene takes them. "
        "snapshot: goes on from "
        "one of a World of the same scene and settings, with the same bits. threads: 0 as many as the process may use; "
        "executor: "
        "parallel or serial. None of the last two changes a bit. Bodies that intersect are refused with OverlapError.");
    type.def("step", &PythonWorld::step, py::arg("n") = 1,
             "Makes n steps of settings.time_step and returns the StepReport of the last. Other threads of Python run "
             "meanwhile.");
    type.def("snapshot", &snapshot_of, "Everything that can change a later bit, as bytes.");
    type.def(
        "restore", [](PythonWorld& w, const py::bytes& data) { w.restore(std::string(data)); }, py::arg("snapshot"),
        "Goes on from a snapshot of a World of the same scene and settings. On an error nothing changes.");
    type.def(
        "clone",
        [](const PythonWorld& w, int threads, const std::string& executor) {
            return w.clone(world_options(threads, executor));
        },
        py::kw_only(), py::arg("threads") = 0, py::arg("executor") = "parallel",
        "Another World in the same state, with the same bits from here on; without callbacks and recorded edits. "
        "copy.copy does it with this World's own threads and executor.");
    bind_motion(type);
    bind_views(type);
    bind_knowledge(type);
    bind_edits(type);
    bind_recorded_edits(type);
    bind_callbacks(type);
    type.def("__repr__", &text_of);
    type.def("__copy__", [](const PythonWorld& w) { return w.clone(w.options()); });
    type.def(
        "__deepcopy__", [](const PythonWorld& w, const py::dict&) { return w.clone(w.options()); }, py::arg("memo"));
    type.def(py::pickle(&pickle, &unpickle));
}

} // namespace flotilla::python
