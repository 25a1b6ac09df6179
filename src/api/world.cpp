// SPDX-License-Identifier: MIT
#include <flotilla/world.hpp>

#include <algorithm>
#include <utility>

#include <flotilla/error.hpp>

#include "api/world_access.hpp"
#include "base/assumptions.hpp"
#include "base/floating_point.hpp"
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

/// A scene whose movable bodies do not intersect at the start. Exact, because continuous detection cannot see an overlap that is there
/// already.
struct CheckedStart {
    CheckedStart(const SceneDescription& description, const std::string& source)
        : described(build_scene(description, source)), scene(described) {
        if (scene.settings.initial_overlap == InitialOverlap::separate) moved = separate(described, scene, source);
        const InitialOverlaps overlaps = find_initial_overlaps(scene);
        if (!overlaps.movable.empty()) refuse(scene, source, overlaps.movable);
    }
    Scene described, scene;
    std::vector<MovedBody> moved;
};

std::uint64_t hash_of(const Scene& scene, const Model& model) { return scene_hash(model, initial_state(scene, model)); }

std::vector<std::string> names_of(const Scene& scene) {
    std::vector<std::string> names;
    for (const auto& body : scene.bodies) names.push_back(body.name);
    return names;
}

constexpr int kMostThreads = 1024;

StepperOptions stepper_options(const WorldOptions& options) {
    StepperOptions out;
    TeamOptions& team = out.team;
    if (options.threads < 0) throw InputError(std::to_string(options.threads) + " threads: at least one is needed");
    team.yields = options.threads == 0;
    team.threads = team.yields ? default_threads() : options.threads;
    if (team.threads > kMostThreads)
        throw InputError(std::to_string(team.threads) + " threads: at most " + std::to_string(kMostThreads) +
                         " are supported");
    if (options.executor == Executor::serial) team.threads = 1;
    return out;
}

template <class Work>
auto in_own_environment(Work&& work) {
    const DefaultFloatingPoint environment;
    if (const std::string fault = arithmetic_fault(); !fault.empty()) throw Error("arithmetic: " + fault);
    return work();
}

} // namespace

struct World::Impl {
    Impl(const CheckedStart& start, const WorldOptions& options)
        : model(make_model(start.scene)),
          names(names_of(start.scene)),
          scene_hash(hash_of(start.described, model)),
          moved(start.moved),
          stepper(model, initial_state(start.scene, model), stepper_options(options)) {}
    Impl(const Scene& scene, std::span<const std::byte> snapshot, const WorldOptions& options)
        : model(make_model(scene)),
          names(names_of(scene)),
          scene_hash(hash_of(scene, model)),
          stepper(model, read_snapshot(snapshot, scene_hash, model), stepper_options(options)) {}

    void check(std::size_t body) const {
        if (body < model.size()) return;
        throw InputError("body " + std::to_string(body) + " does not exist: there are " + std::to_string(model.size()));
    }
    [[nodiscard]] BodyNames pair(std::int32_t a, std::int32_t b) const {
        return {a, b, names[static_cast<std::size_t>(a)], names[static_cast<std::size_t>(b)]};
    }

    Model model;
    std::vector<std::string> names; ///< of the bodies
    std::uint64_t scene_hash;       ///< of the scene as it was described
    std::vector<MovedBody> moved;
    Stepper stepper;
    bool whole = true; ///< no step ended half-way
};

Team& WorldAccess::team(World& world) { return world.impl_->stepper.team(); }

World::World(const SceneDescription& scene, const std::string& source, const WorldOptions& options)
    : impl_(in_own_environment([&] { return std::make_unique<Impl>(CheckedStart(scene, source), options); })) {}
World::World(const SceneDescription& scene, std::span<const std::byte> snapshot, const std::string& source,
             const WorldOptions& options)
    : impl_(in_own_environment([&] { return std::make_unique<Impl>(build_scene(scene, source), snapshot, options); })) {
}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

StepReport World::step() {
    const DefaultFloatingPoint environment;
    if (!std::exchange(impl_->whole, false))
        throw Error("step " + std::to_string(steps() + 1) +
                    ": an earlier call failed half-way; the World cannot go on, a snapshot taken before can");
    try {
        StepReport report = impl_->stepper.step();
        impl_->whole = true;
        return report;
    } catch (const CertificateError& e) {
        const BodyNames pair = impl_->pair(e.pair.a, e.pair.b);
        throw BrokenPromise("step " + std::to_string(steps() + 1) + ": bodies " + in_quotes(pair.name_a) + " and " +
                                in_quotes(pair.name_b) + " could not be proved apart",
                            steps() + 1, pair);
    } catch (const BlockedScripts& e) {
        impl_->whole = true; // everything is as it was before
        std::string message;
        std::vector<BodyNames> pairs;
        for (const DelayedScript& d : e.scripts) {
            pairs.push_back(impl_->pair(d.body, d.victim));
            message += (message.empty() ? "step " : "\nstep ") + std::to_string(steps() + 1) + ": the script of body " +
                       in_quotes(pairs.back().name_a) + " cannot go on: it would crush body " +
                       in_quotes(pairs.back().name_b);
        }
        throw ScriptError(message, steps() + 1, std::move(pairs));
    }
}

std::size_t World::size() const { return impl_->model.size(); }
std::int64_t World::steps() const { return impl_->stepper.steps(); }
double World::time() const { return impl_->stepper.time(); }
const Settings& World::settings() const { return impl_->model.settings; }

BodyState World::body(std::size_t index) const {
    impl_->check(index);
    const DefaultFloatingPoint environment;
    const State& state = impl_->stepper.state();
    const Pose& pose = state.pose[index];
    const Motion& motion = state.motion[index];
    const Vec3 omega = impl_->model.bodies[index].movable()
                           ? angular_velocity(impl_->model.shape_of(index), pose.rotation, motion.momentum)
                           : motion.momentum;
    return {pose.origin, pose.rotation, pose.com, motion.velocity, omega};
}

Vec3 World::turn(std::size_t index) const {
    impl_->check(index);
    return impl_->stepper.turns()[index];
}

std::vector<WayPoint> World::way(std::size_t index) const {
    impl_->check(index);
    std::vector<WayPoint> points;
    const auto add = [&](const Pose& pose, const Vec3& turn) { points.push_back({pose.origin, pose.rotation, turn}); };
    for (const InnerState& inner : impl_->stepper.inner_states()) add(inner.pose[index], inner.turn[index]);
    add(impl_->stepper.state().pose[index], impl_->stepper.turns()[index]);
    return points;
}

std::vector<ContactState> World::contacts() const {
    std::vector<ContactState> out;
    const std::vector<Contact>& awake = impl_->stepper.contacts().contacts;
    const std::vector<Contact>& asleep = impl_->stepper.sleeping_contacts();
    const State& state = impl_->stepper.state();
    const auto bodies = [](const auto& x) { return std::pair(x.a, x.b); };
    std::span<const WarmImpulse> solved = state.warm_final,
                                 waiting = state.waiting_final; // all lists are sorted by bodies
    const double substeps = impl_->stepper.substeps();
    const auto add = [&](const Contact& c, bool sleeps) {
        std::span<const WarmImpulse>& list = sleeps ? waiting : solved;
        const auto first =
            std::find_if(list.begin(), list.end(), [&](const WarmImpulse& w) { return bodies(w) >= bodies(c); });
        list = list.subspan(static_cast<std::size_t>(first - list.begin()));
        ContactState contact{c.a, c.b, c.point, c.normal, c.distance, {}, sleeps};
        for (auto w = list.begin(); w != list.end() && bodies(*w) == bodies(c); ++w)
            if (w->feature_key == c.feature_key) contact.impulse = substeps * w->impulse;
        out.push_back(contact);
    };
    auto sleeper = asleep.begin();
    for (const Contact& c : awake) {
        for (; sleeper != asleep.end() && bodies(*sleeper) < bodies(c); ++sleeper) add(*sleeper, true);
        add(c, false);
    }
    for (; sleeper != asleep.end(); ++sleeper) add(*sleeper, true);
    return out;
}

std::vector<BodyActivity> World::activity() const {
    std::vector<BodyActivity> out = impl_->stepper.activity();
    for (const auto* contacts : {&impl_->stepper.contacts().contacts, &impl_->stepper.sleeping_contacts()})
        for (const Contact& c : *contacts)
            for (const std::int32_t body : {c.a, c.b}) ++out[static_cast<std::size_t>(body)].contacts;
    for (std::size_t i = 0; i < out.size(); ++i)
        if (asleep(impl_->stepper.state(), i)) out[i].cluster = ClusterState::asleep;
    return out;
}

std::vector<ThreadReport> World::threads() const {
    std::vector<ThreadReport> out;
    for (const ThreadTimes& t : impl_->stepper.team().times())
        out.push_back({t.busy_ms, t.waiting_ms, t.tasks, t.stolen});
    return out;
}

std::uint64_t World::state_hash() const { return flotilla::state_hash(impl_->stepper.state()); }
const std::vector<MovedBody>& World::moved_bodies() const { return impl_->moved; }
std::uint64_t World::scene_hash() const { return impl_->scene_hash; }
std::vector<std::byte> World::snapshot() const {
    if (!impl_->whole) throw Error("a step failed half-way: there is no whole state to take a snapshot of");
    return write_snapshot(impl_->stepper.state(), impl_->scene_hash);
}

} // namespace flotilla
