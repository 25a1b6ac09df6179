// SPDX-License-Identifier: MIT
#include <flotilla/world.hpp>

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>
#include <utility>

#include <flotilla/environment.hpp>
#include <flotilla/error.hpp>

#include "api/contact_states.hpp"
#include "api/world_access.hpp"
#include "api/world_impl.hpp"
#include "base/assumptions.hpp"
#include "base/environment.hpp"
#include "base/floating_point.hpp"
#include "base/index.hpp"
#include "base/text.hpp"
#include "parallel/threads.hpp"
#include "scene/initial_overlap.hpp"
#include "scene/separate_overlaps.hpp"
#include "state/build_model.hpp"
#include "state/snapshot.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

std::string name_of(const Scene& scene, std::int32_t body) {
    return in_quotes(scene.bodies[static_cast<std::size_t>(body)].name);
}

std::vector<OverlapError::Pair> pairs_of(const Scene& scene, const std::vector<BodyOverlap>& overlaps) {
    std::vector<OverlapError::Pair> pairs;
    const auto name = [&](std::int32_t body) { return scene.bodies[static_cast<std::size_t>(body)].name; };
    for (const BodyOverlap& o : overlaps)
        pairs.push_back({{o.a, o.b, name(o.a), name(o.b)}, static_cast<std::int64_t>(o.triangles.size())});
    return pairs;
}

[[noreturn]] void refuse(const Scene& scene, const std::string& source, const std::vector<BodyOverlap>& overlaps) {
    std::string message;
    for (const BodyOverlap& o : overlaps) {
        if (!message.empty()) message += '\n';
        message += source + ": bodies " + name_of(scene, o.a) + " and " + name_of(scene, o.b) +
                   " intersect at t = 0 (" + std::to_string(o.triangles.size()) + " triangle pairs)";
    }
    throw OverlapError(message, pairs_of(scene, overlaps));
}

std::vector<MovedBody> separate(const Scene& described, Scene& scene, const std::string& source) {
    const SeparatedStart start = separate_overlaps(scene);
    if (!start.not_freed.empty()) {
        std::string message;
        for (const std::int32_t body : start.not_freed)
            message += (message.empty() ? "" : "\n") + source + ": body " + name_of(scene, body) +
                       " intersects others at t = 0, and no move of at most its own size frees it";
        throw OverlapError(message, pairs_of(scene, find_initial_overlaps(described).movable));
    }
    std::vector<MovedBody> moved;
    for (const InitialMove& m : start.moves) moved.push_back({m.body, m.by});
    return moved;
}

std::uint64_t hash_of(const Scene& scene, const Model& model) { return scene_hash(model, initial_state(scene, model)); }

StepperOptions stepper_options(const WorldOptions& options) {
    StepperOptions out;
    TeamOptions& team = out.team;
    check_environment();
    if (options.threads < 0)
        throw InputError(std::to_string(options.threads) + " threads: must be one or more, or 0 for the default");
    team.yields = options.threads == 0;
    team.threads = team.yields ? default_threads() : options.threads;
    if (team.threads > kMostThreads)
        throw InputError(std::to_string(team.threads) + " threads: at most " + std::to_string(kMostThreads) +
                         " are supported");
    if (options.executor == Executor::serial) team.threads = 1;
    return out;
}

/// What edits change of a scene, as it begins. The shapes are those of `description`, without their meshes.
EditedBodies edited_bodies(const SceneDescription& description, const Scene& scene) {
    EditedBodies out;
    out.gravity = scene.gravity;
    for (const ShapeDescription& shape : description.shapes) {
        out.shapes.emplace_back();
        out.shapes.back().name = shape.name;
        out.shapes.back().mass_kind = shape.mass_kind;
        out.shapes.back().mass_value = shape.mass_value;
    }
    out.scene_shapes = out.shapes.size();
    out.bodies = scene.bodies;
    for (std::size_t i = 0; i < out.bodies.size(); ++i) out.bodies[i].shape = description.bodies[i].shape;
    out.present.assign(out.bodies.size(), 1);
    out.generation.assign(out.bodies.size(), 0);
    out.user_data.assign(out.bodies.size(), 0);
    out.ignored_groups = description.ignored_groups;
    out.ignored_bodies = description.ignored_bodies;
    return out;
}

template <class Work>
auto in_own_environment(Work&& work) {
    const DefaultFloatingPoint environment;
    if (const std::string fault = arithmetic_fault(); !fault.empty()) throw Error("arithmetic: " + fault);
    return work();
}

} // namespace

/// A scene whose movable bodies do not intersect at the start. Exact, because continuous detection cannot see an
/// overlap that is there already.
struct CheckedStart {
    CheckedStart(const SceneDescription& given, const std::string& source)
        : description(given), described(build_scene(given, source)), scene(described) {
        if (scene.settings.initial_overlap == InitialOverlap::separate) moved = separate(described, scene, source);
        const InitialOverlaps overlaps = find_initial_overlaps(scene);
        if (!overlaps.movable.empty()) refuse(scene, source, overlaps.movable);
    }
    const SceneDescription& description;
    Scene described, scene;
    std::vector<MovedBody> moved;
};

World::Impl::Impl(const CheckedStart& checked, const WorldOptions& given)
    : settings(checked.scene.settings),
      shape_of(checked.scene.shape_of),
      start(edited_bodies(checked.description, checked.scene)),
      now(start),
      moved(checked.moved),
      options(given) {
    const Model model = make_model(checked.scene);
    scene_hash = hash_of(checked.described, model);
    stepper = std::make_unique<Stepper>(model, initial_state(checked.scene, model), stepper_options(given));
    name_places();
}

World::Impl::Impl(const SceneDescription& description, const Scene& scene, std::span<const std::byte> snapshot,
                  const WorldOptions& given)
    : settings(scene.settings), shape_of(scene.shape_of), start(edited_bodies(description, scene)), options(given) {
    const Model model = make_model(scene);
    scene_hash = hash_of(scene, model);
    go_to(model, snapshot);
}

World::Impl::Impl(const Impl& other, const WorldOptions& given)
    : settings(other.settings),
      shape_of(other.shape_of),
      start(other.start),
      now(other.now),
      scene_hash(other.scene_hash),
      moved(other.moved),
      options(given) {
    Model model = other.stepper->model();
    model.settings = settings;
    stepper = std::make_unique<Stepper>(model, other.stepper->state(), stepper_options(given));
    stepper->set_edits_hash(now.hash);
    stepper->set_moved(other.stepper->moved());
    name_places();
}

/// Takes the state of a snapshot of the scene, which `model` is before all edits.
void World::Impl::go_to(Model model, std::span<const std::byte> snapshot) {
    SplitSnapshot split = split_snapshot(snapshot, start);
    std::vector<std::int32_t> shapes(shape_of.begin(),
                                     shape_of.begin() + static_cast<std::ptrdiff_t>(start.scene_shapes));
    if (split.edited) take_edits(split.bodies, shapes, model);
    State state = read_snapshot(split.state, scene_hash, model);
    const bool same_places = stepper != nullptr && state.pose.size() == stepper->state().pose.size();
    if (stepper != nullptr && !same_places) refuse_where_pinned("the snapshot has another number of places");
    auto restarted = std::make_unique<Stepper>(model, std::move(state), stepper_options(options));
    now = split.edited ? std::move(split.bodies) : start;
    restarted->set_edits_hash(now.hash);
    if (split.edited) restarted->set_moved(std::move(now.moved));
    if (same_places) restarted->take_places(*stepper);
    stepper = std::move(restarted);
    shape_of = std::move(shapes);
    name_places();
}

void World::Impl::name_places() {
    place_of.clear();
    for (std::size_t i = 0; i < now.bodies.size(); ++i)
        if (now.present[i] != 0) place_of.emplace(now.bodies[i].name, static_cast<std::int32_t>(i));
    contacts_of_step = -1;
}

void World::Impl::check(std::size_t body) const {
    if (body < now.bodies.size()) return;
    throw InputError("body " + std::to_string(body) + " does not exist: there are " +
                     std::to_string(now.bodies.size()));
}

const ShapeDescription& World::Impl::shape(std::int32_t number) const {
    if (number < 0 || static_cast<std::size_t>(number) >= now.shapes.size())
        throw InputError("shape " + std::to_string(number) + " does not exist: there are " +
                         std::to_string(now.shapes.size()));
    const ShapeDescription& found = now.shapes[static_cast<std::size_t>(number)];
    if (was_removed(found)) throw InputError("shape " + std::to_string(number) + " was removed");
    return found;
}

void World::Impl::refuse_where_pinned(const std::string& doing) const {
    if (pin.use_count() > 1)
        throw InputError(doing + ", and somebody uses the memory of those that there are: let go of it first");
}

BodyNames World::Impl::pair(std::int32_t a, std::int32_t b) const {
    return {a, b, now.bodies[static_cast<std::size_t>(a)].name, now.bodies[static_cast<std::size_t>(b)].name};
}

void World::Impl::refresh() const {
    const DefaultFloatingPoint environment;
    stepper->refresh();
}

std::uint64_t World::Impl::state_hash() const {
    refresh();
    return with_edits(flotilla::state_hash(stepper->state()), now.hash);
}

Team& WorldAccess::team(World& world) { return world.impl_->stepper->team(); }
const TriangleMesh& WorldAccess::mesh(const World& world, std::size_t place) {
    return world.impl_->stepper->model().shape_of(place).mesh;
}

ProofWay WorldAccess::proved_by(const World& world, std::size_t a, std::size_t b) {
    return world.impl_->stepper->proved_by(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b));
}

World::World(const SceneDescription& scene, const std::string& source, const WorldOptions& options)
    : impl_(in_own_environment([&] { return std::make_unique<Impl>(CheckedStart(scene, source), options); })) {}
World::World(const SceneDescription& scene, std::span<const std::byte> snapshot, const std::string& source,
             const WorldOptions& options)
    : impl_(in_own_environment(
          [&] { return std::make_unique<Impl>(scene, build_scene(scene, source), snapshot, options); })) {}
World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

StepReport World::step() {
    if (impl_->force_callback && impl_->whole) {
        const auto callback = impl_->force_callback; // it may set another one
        callback(*this);
    }
    const DefaultFloatingPoint environment;
    Impl& w = *impl_;
    if (!std::exchange(w.whole, false))
        throw Error("step " + std::to_string(steps() + 1) +
                    ": an earlier call failed half-way; the World cannot go on, a snapshot taken before can");
    try {
        const auto observer = w.observer; // as above
        StepReport report = w.stepper->step(observer);
        w.clear_pushes();
        w.whole = true;
        w.contacts_of_step = -1;
        w.say_warnings(report);
        return report;
    } catch (const CertificateError& e) {
        const BodyNames pair = w.pair(e.pair.a, e.pair.b);
        throw BrokenPromise("step " + std::to_string(steps() + 1) + ": bodies " + in_quotes(pair.name_a) + " and " +
                                in_quotes(pair.name_b) + " could not be proved apart",
                            steps() + 1, pair);
    } catch (const BlockedScripts& e) {
        w.whole = true; // everything is as it was before
        std::string message;
        std::vector<BodyNames> pairs;
        for (const DelayedScript& d : e.scripts) {
            pairs.push_back(w.pair(d.body, d.victim));
            message += (message.empty() ? "step " : "\nstep ") + std::to_string(steps() + 1) + ": the script of body " +
                       in_quotes(pairs.back().name_a) + " cannot go on: it would crush body " +
                       in_quotes(pairs.back().name_b);
        }
        throw ScriptError(message, steps() + 1, std::move(pairs));
    } catch (const CancelledStep& e) {
        w.whole = true;
        if (e.thrown) std::rethrow_exception(e.thrown);
        throw StepCancelled("step " + std::to_string(steps() + 1) + ": cancelled by its observer after " +
                            std::string(kPhaseNames[static_cast<std::size_t>(e.phase)]));
    }
}

/// Those that the step before did not have.
void World::Impl::say_warnings(const StepReport& report) {
    constexpr std::array<std::pair<StepWarning, std::string_view>, 5> kTexts{
        {{kCollisionLimit, "stage 1 ended before it was quiet"},
         {kDynamicLimit, "dynamic contact was given up: the failsafe had to finish"},
         {kStaticLimit, "a contact solve ended above its tolerance"},
         {kScriptDelayed, "a scripted body waited, as bodies are in its way or were of late"},
         {kReboundLost, "a body that the failsafe held, or that was hit without end, lost a rebound"}}};
    const std::uint32_t fresh = report.warnings & ~last_warnings;
    last_warnings = report.warnings;
    if (!log) return; // nothing may fail any more: the step is done
    for (const auto& [bit, text] : kTexts)
        if ((fresh & bit) != 0) say("step " + std::to_string(report.step) + ": " + std::string(text));
}

std::size_t World::size() const { return impl_->now.bodies.size(); }
std::int64_t World::steps() const { return impl_->stepper->steps(); }
double World::time() const { return impl_->stepper->time(); }
const Settings& World::settings() const { return impl_->settings; }

BodyState World::body(std::size_t index) const {
    impl_->check(index);
    const DefaultFloatingPoint environment;
    const State& state = impl_->stepper->state();
    const Pose& pose = state.pose[index];
    const Motion& motion = state.motion[index];
    const Vec3 omega = impl_->stepper->model().bodies[index].dynamic()
                           ? angular_velocity(impl_->stepper->model(), index, pose.rotation, motion.momentum)
                           : motion.momentum;
    return {pose.origin, pose.rotation, pose.com, motion.velocity, omega};
}

Vec3 World::turn(std::size_t index) const {
    impl_->check(index);
    impl_->refresh();
    return impl_->stepper->turns()[index];
}

std::vector<WayPoint> World::way(std::size_t index) const {
    impl_->check(index);
    impl_->refresh();
    std::vector<WayPoint> points;
    const auto add = [&](const Pose& pose, const Vec3& turn) { points.push_back({pose.origin, pose.rotation, turn}); };
    for (const InnerState& inner : impl_->stepper->inner_states()) add(inner.pose[index], inner.turn[index]);
    add(impl_->stepper->state().pose[index], impl_->stepper->turns()[index]);
    return points;
}

const std::shared_ptr<std::vector<ContactState>>& World::Impl::contacts() {
    refresh();
    if (contacts_of_step == stepper->steps()) return contact_list;
    const DefaultFloatingPoint environment;
    if (contact_list.use_count() > 1) // somebody keeps what it was
        contact_list = std::make_shared<std::vector<ContactState>>();
    list_contact_states(*stepper, *contact_list);
    contacts_of_step = stepper->steps();
    contacts_by_body = false;
    return contact_list;
}

std::span<const std::size_t> World::Impl::contacts_of(std::size_t body) {
    const std::vector<ContactState>& list = *contacts();
    if (!contacts_by_body) { // a counting sort: ends are starts until all are placed
        end_of_body.assign(now.present.size() + 1, 0);
        for (const ContactState& c : list)
            for (const std::int32_t i : {c.body_a, c.body_b}) ++end_of_body[at(i) + 1];
        std::partial_sum(end_of_body.begin(), end_of_body.end(), end_of_body.begin());
        contact_places.resize(2 * list.size());
        for (std::size_t k = 0; k < list.size(); ++k)
            for (const std::int32_t i : {list[k].body_a, list[k].body_b}) contact_places[end_of_body[at(i)]++] = k;
        contacts_by_body = true;
    }
    const std::size_t first = body > 0 ? end_of_body[body - 1] : 0;
    return std::span(contact_places).subspan(first, end_of_body[body] - first);
}

std::vector<ContactState> World::contacts() const { return *impl_->contacts(); }

std::vector<BodyActivity> World::activity() const {
    impl_->refresh();
    std::vector<BodyActivity> out = impl_->stepper->activity();
    for (const auto* contacts : {&impl_->stepper->contacts().contacts, &impl_->stepper->sleeping_contacts()})
        for (const Contact& c : *contacts)
            for (const std::int32_t body : {c.a, c.b}) ++out[static_cast<std::size_t>(body)].contacts;
    for (std::size_t i = 0; i < out.size(); ++i)
        if (asleep(impl_->stepper->state(), i)) out[i].cluster = ClusterState::asleep;
    return out;
}

std::vector<ThreadReport> World::threads() const {
    std::vector<ThreadReport> out;
    for (const ThreadTimes& t : impl_->stepper->team().times())
        out.push_back({t.busy_ms, t.waiting_ms, t.tasks, t.stolen});
    return out;
}

std::uint64_t World::state_hash() const { return impl_->state_hash(); }
const std::vector<MovedBody>& World::moved_bodies() const { return impl_->moved; }
std::uint64_t World::scene_hash() const { return impl_->scene_hash; }

std::vector<std::byte> World::snapshot() const {
    if (!impl_->whole) throw Error("a step failed half-way: there is no whole state to take a snapshot of");
    impl_->refresh(); // distances of bodies that were placed belong to the state
    std::vector<std::byte> state = write_snapshot(impl_->stepper->state(), impl_->scene_hash);
    if (impl_->now.hash == 0) return state;
    EditedBodies edited = impl_->now;
    edited.moved = impl_->stepper->moved();
    return join_snapshot(edited, state);
}

World World::clone(const WorldOptions& options) const {
    const DefaultFloatingPoint environment;
    if (!impl_->whole) throw Error("a step failed half-way: there is no whole state to copy");
    impl_->refresh();
    return World(std::make_unique<Impl>(*impl_, options));
}

void World::restore(std::span<const std::byte> snapshot) {
    const DefaultFloatingPoint environment;
    Model model = impl_->stepper->model();
    model.settings = impl_->settings;
    impl_->undo_edits(model);
    impl_->go_to(std::move(model), snapshot);
    impl_->record.go_to(impl_->now.hash);
    impl_->whole = true;
}

} // namespace flotilla
