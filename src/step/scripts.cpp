// SPDX-License-Identifier: MIT
#include "step/scripts.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "state/keyframes.hpp"

namespace flotilla {
namespace {

constexpr double kCatchingUp = 2;        // times the script's fastest speed
constexpr double kFineness = 1.0 / 64.0; // of the reach: how near to it the latest place is found

/// m, that no point of the body is beyond between the two.
double way(const RigidShape& shape, const Vec3& origin_a, const Quat& a, const Vec3& origin_b, const Quat& b) {
    const double turn = a == b ? 0.0 : length(rotation_vector(b * conjugate(a)));
    return length(origin_b - origin_a) + turn * (shape.radius + length(shape.center_of_mass));
}

Vec3 turn_between(const Pose& start, const Pose& end) {
    return end.rotation == start.rotation ? Vec3{} : rotation_vector(end.rotation * conjugate(start.rotation));
}

double speed_between(const RigidShape& shape, const Keyframe& a, const Keyframe& b) {
    return way(shape, a.position, a.rotation, b.position, b.rotation) / (b.time - a.time);
}

/// The share of the step that a script's clock goes on by if nothing stops it. One that was stopped of late tries every
/// 1, 2, 4 ... steps.
double pace_of(const Model& model, const State& state, std::int32_t body) {
    const std::int64_t stops = state.script_clock[at(body)].stops;
    if (stops == 0 || model.settings.unsatisfiable_script != UnsatisfiableScript::hold) return 1;
    const std::int64_t every = std::int64_t{1} << (stops - 1);
    return state.step % every == 0 ? std::ldexp(1.0, static_cast<int>(-stops)) : 0.0;
}

} // namespace

Pose scripted_pose(const RigidShape& shape, const Body& body, double time) {
    const KeyframePlace place = keyframe_place(body.keyframes, time);
    return pose_at_origin(shape, place.position, place.rotation);
}

double fastest_speed(const RigidShape& shape, const Body& body) {
    double speed = 0;
    for (std::size_t k = 1; k < body.keyframes.size(); ++k)
        speed = std::max(speed, speed_between(shape, body.keyframes[k - 1], body.keyframes[k]));
    return speed;
}

double latest_within(const RigidShape& shape, const Body& body, const Pose& pose, double from, double to,
                     double reach) {
    const auto& keys = body.keyframes;
    for (double time = to; time > from;) {
        const Pose place = scripted_pose(shape, body, time);
        const double beyond = way(shape, pose.origin, pose.rotation, place.origin, place.rotation) - reach;
        if (!(beyond > 0)) return time;
        // Between two keyframes no point is faster than this: nothing is within reach before so much is undone.
        const auto after =
            std::lower_bound(keys.begin(), keys.end(), time, [](const Keyframe& k, double t) { return k.time < t; });
        if (after == keys.begin()) return from;
        const double speed = after == keys.end() ? 0.0 : speed_between(shape, *(after - 1), *after);
        const double earlier = std::max((after - 1)->time, time - std::max(beyond, kFineness * reach) / speed);
        if (!(earlier < time)) return from; // steps below the rounding of the time
        time = earlier;
    }
    return from;
}

Scripts::Scripts(const Model& model) : due_(model.size(), 0.0) {
    for (std::size_t i = 0; i < model.size(); ++i)
        if (model.bodies[i].scripted()) scripted_.push_back(static_cast<std::int32_t>(i));
    if (any()) due_motion_.resize(model.size());
    if (model.settings.unsatisfiable_script != UnsatisfiableScript::follow) return;
    speed_.assign(model.size(), 0.0);
    for (const std::int32_t i : scripted_) speed_[at(i)] = fastest_speed(model.shape_of(at(i)), model.bodies[at(i)]);
}

void Scripts::move(const Model& model, const State& state, Trajectories& trajectories, Clusters& clusters) {
    const double dt = model.settings.time_step, now = static_cast<double>(state.step + 1) * dt;
    waiting_ = 0;
    for (const std::int32_t id : scripted_) {
        const std::size_t i = at(id);
        const Body& body = model.bodies[i];
        const RigidShape& shape = model.shape_of(i);
        const Pose& start = trajectories.start_pose(i);
        const double pace = pace_of(model, state, id);
        const double delay = state.script_clock[i].delay, last = static_cast<double>(state.step) * dt - delay;
        const bool follows = !speed_.empty();
        if (follows && (delay != 0 || start != scripted_pose(shape, body, last)))
            due_[i] = latest_within(shape, body, start, last, now, kCatchingUp * speed_[i] * dt);
        else // on time, or waited for
            due_[i] = pace == 1 ? now - delay : last + pace * dt;
        const Pose end = pace == 0 ? start : scripted_pose(shape, body, due_[i]);
        const Vec3 turn = turn_between(start, end);
        const Motion motion{(end.com - start.com) / dt, turn / dt};
        trajectories.set_end(i, end, turn);
        clusters.set_script(id, motion);
        if (pace < 1) {
            ++waiting_;
            const Pose next = scripted_pose(shape, body, now - delay);
            due_motion_[i] = {(next.com - start.com) / dt, turn_between(start, next) / dt};
        } else {
            due_motion_[i] = motion;
        }
    }
}

void Scripts::commit(const Model& model, const FailsafeStats& failsafe, State& state) const {
    const double dt = model.settings.time_step, now = static_cast<double>(state.step + 1) * dt;
    if (!speed_.empty()) {
        for (const std::int32_t i : scripted_) state.script_clock[at(i)].delay = now - due_[at(i)];
        return;
    }
    const auto& delayed = failsafe.delayed_scripts; // ascending
    for (const DelayedScript& d : delayed)
        state.script_clock[at(d.body)].delay += (1 - d.share) * pace_of(model, state, d.body) * dt;
    for (const std::int32_t i : scripted_) {
        ScriptClock& clock = state.script_clock[at(i)];
        const double pace = pace_of(model, state, i);
        clock.delay += (1 - pace) * dt;
        if (std::ranges::binary_search(delayed, i, {}, &DelayedScript::body))
            clock.stops = std::min(clock.stops + 1, ScriptClock::kMostStops);
        else if (pace > 0 && clock.stops > 0)
            --clock.stops;
    }
}

} // namespace flotilla
