// SPDX-License-Identifier: MIT
#include <flotilla/world.hpp>

#include <algorithm>
#include <utility>

#include <flotilla/error.hpp>

#include "api/world_access.hpp"
#include "parallel/parallel_for.hpp"
#include "scene/initial_overlap.hpp"
#include "state/build_model.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

/// The checks that come before the first step: exact, because continuous detection cannot see an overlap that is there already.
Scene checked(const SceneDescription& description, const std::string& source) {
    Scene scene = build_scene(description, source);
    const InitialOverlaps overlaps = find_initial_overlaps(scene);
    if (overlaps.movable.empty()) return scene;
    std::string message;
    for (const BodyOverlap& o : overlaps.movable) {
        if (!message.empty()) message += '\n';
        message += source + ": bodies \"" + scene.bodies[static_cast<std::size_t>(o.a)].name + "\" and \"" +
                   scene.bodies[static_cast<std::size_t>(o.b)].name + "\" intersect at t = 0 (" +
                   std::to_string(o.triangles.size()) + " triangle pairs)";
    }
    throw OverlapError(message);
}

constexpr int kMostThreads = 1024;

StepperOptions stepper_options(const WorldOptions& options) {
    StepperOptions out;
    out.threads = options.threads > 0 ? options.threads : default_threads();
    if (out.threads > kMostThreads)
        throw InputError(std::to_string(out.threads) + " threads: at most " + std::to_string(kMostThreads) +
                         " are supported");
    if (options.executor == Executor::serial) out.threads = 1;
    out.pin = options.pin;
    return out;
}

} // namespace

struct World::Impl {
    Impl(const Scene& scene, const WorldOptions& options)
        : model(make_model(scene)), stepper(model, initial_state(scene, model), stepper_options(options)) {}

    Model model;
    Stepper stepper;
};

Team& WorldAccess::team(World& world) { return world.impl_->stepper.team(); }

World::World(const SceneDescription& scene, const std::string& source, const WorldOptions& options)
    : impl_(std::make_unique<Impl>(checked(scene, source), options)) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

StepReport World::step() {
    try {
        return impl_->stepper.step();
    } catch (const CertificateError& e) {
        throw BrokenPromise(e.what());
    }
}

std::size_t World::size() const { return impl_->model.size(); }
std::int64_t World::steps() const { return impl_->stepper.state().step; }
double World::time() const { return impl_->stepper.state().time; }
const Settings& World::settings() const { return impl_->model.settings; }

BodyState World::body(std::size_t index) const {
    const State& state = impl_->stepper.state();
    const Pose& pose = state.pose[index];
    const Motion& motion = state.motion[index];
    const Vec3 omega = impl_->model.bodies[index].movable()
                           ? angular_velocity(impl_->model.shape_of(index), pose.rotation, motion.momentum)
                           : motion.momentum;
    return {pose.origin, pose.rotation, pose.com, motion.velocity, omega};
}

Vec3 World::turn(std::size_t index) const { return impl_->stepper.turns()[index]; }

std::vector<ContactState> World::contacts() const {
    std::vector<ContactState> out;
    const std::vector<WarmImpulse>& solved = impl_->stepper.state().warm_final;
    auto pair = solved.begin(); // both lists are sorted by bodies
    for (const Contact& c : impl_->stepper.contacts().contacts) {
        pair = std::find_if(pair, solved.end(),
                            [&](const WarmImpulse& w) { return std::pair(w.a, w.b) >= std::pair(c.a, c.b); });
        ContactState state{c.a, c.b, c.point, c.normal, c.distance, {}};
        for (auto w = pair; w != solved.end() && w->a == c.a && w->b == c.b; ++w)
            if (w->feature_key == c.feature_key) state.impulse = w->impulse;
        out.push_back(state);
    }
    return out;
}

std::vector<BodyActivity> World::activity() const {
    std::vector<BodyActivity> out = impl_->stepper.activity();
    for (const Contact& c : impl_->stepper.contacts().contacts)
        for (const std::int32_t body : {c.a, c.b}) ++out[static_cast<std::size_t>(body)].contacts;
    return out;
}

std::vector<ThreadReport> World::threads() const {
    std::vector<ThreadReport> out;
    for (const ThreadTimes& t : impl_->stepper.team().times())
        out.push_back({t.busy_ms, t.waiting_ms, t.tasks, t.stolen});
    return out;
}

std::uint64_t World::state_hash() const { return flotilla::state_hash(impl_->stepper.state()); }

} // namespace flotilla
