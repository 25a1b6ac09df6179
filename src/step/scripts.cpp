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

/// Whether no keyframe is between the two times.
bool in_one_piece(std::span<const Keyframe> keys, double from, double to) {
    const auto after = [&](double time) {
        return std::ranges::upper_bound(keys, time, {}, &Keyframe::time) - keys.begin();
    };
    return after(from) == after(to);
}

/// From one time of a body's clock to another.
Motion mean_motion(const Model& model, std::size_t i, double from, double to) {
    const Pose start = scripted_pose(model.shape_of(i), model.bodies[i], from);
    const Pose end = scripted_pose(model.shape_of(i), model.bodies[i], to);
    return {(end.com - start.com) / (to - from), turn_between(start, end) / (to - from)};
}

/// Between two steps, from their mean velocities, that of the step before and that of the step after both: the mean,
/// kept between what the acceleration up to there and that from there on make of it. Where one even acceleration ends
/// and another begins these two agree.
Vec3 velocity_between(const Vec3& before, const Vec3& now, const Vec3& next, const Vec3& after) {
    const Vec3 up_to = now + 0.5 * (now - before), from = next - 0.5 * (after - next);
    const Vec3 change = max(min(up_to, from), min(0.5 * (now + next), max(up_to, from))) - now;
    const double most = length(now - before), all = length(change);
    return now + (all > most ? most / all : 1.0) * change;
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

void Scripts::reach_end(const Model& model, const State& state, std::span<Motion> motion) {
    const double dt = model.settings.time_step, now = static_cast<double>(state.step + 1) * dt;
    for (const std::int32_t id : scripted_) {
        const std::size_t i = at(id);
        Motion &mean = due_motion_[i], &end = motion[i];
        if (end.velocity != mean.velocity || end.momentum != mean.momentum) continue; // stopped
        if (!speed_.empty() && due_[i] != now) continue;                              // behind
        const bool turns_aside = mean.momentum != Vec3{} && model.shape_of(i).center_of_mass != Vec3{};
        if (!turns_aside && in_one_piece(model.bodies[i].keyframes, due_[i] - dt, due_[i] + dt)) continue;
        const Motion& before = state.motion[i];
        Motion next{2.0 * mean.velocity - before.velocity, 2.0 * mean.momentum - before.momentum}, after = next;
        // Where its script ends with this step, as that of one that is told step by step, it goes on as it did: nothing
        // else is known.
        if (std::abs(model.bodies[i].keyframes.back().time - due_[i]) >= 0.5 * dt) {
            next = mean_motion(model, i, due_[i], due_[i] + dt);
            after = mean_motion(model, i, due_[i] + dt, due_[i] + 2 * dt);
        }
        end.velocity = velocity_between(before.velocity, mean.velocity, next.velocity, after.velocity);
        end.momentum = velocity_between(before.momentum, mean.momentum, next.momentum, after.momentum);
        mean = end;
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
