// SPDX-License-Identifier: MIT
#include "islands/sleeping.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

constexpr std::int32_t kQuietSteps = 12;
/// Of the tolerance of static contact: what solves leave of bodies at rest, and a boat that rocks on that. With the
/// most alone, frictionless bodies that slid by 8 mm/s at 1/24 s stopped, and what tips over slowly stood for ever.
constexpr double kQuietTolerances = 16;
/// Of what gravity adds in a step, whatever the tolerance; by default that is 1/4096 (static_contact/targets.cpp).
constexpr double kLeastQuiet = kQuietTolerances / 4096, kMostQuiet = 1.0 / 50;

/// m/s^2: |gravity| is what moves a body that is not at rest, or what else does if that is less.
double pull_on(const Model& model, std::size_t i) {
    const double gravity = length(model.gravity);
    if (!model.bodies[i].driven() && !model.bodies[i].locked.any()) return gravity;
    return std::min(gravity, least_acceleration(model, i));
}

} // namespace

double quiet_speed(const Model& model, std::size_t body) {
    const Settings& s = model.settings;
    const double least = kLeastQuiet * length(model.gravity) * s.time_step;
    const double quiet = s.static_tolerance >= 0 ? kQuietTolerances * s.static_tolerance : s.tolerance_share * least;
    return std::min(std::max(quiet, least), kMostQuiet * pull_on(model, body) * s.time_step);
}

namespace {

/// Whether a contact slides by more than static contact leaves undone, and than its friction stops within a step.
bool slides_on(const Model& model, const Contact& c, const State& state) {
    constexpr double kSlides = 2 / kQuietTolerances;
    if (c.friction >= 2 * kMostQuiet) return false; // stops within a step what is quiet
    double quiet = 0, stops = 0;                    // m/s
    Vec3 slip;
    for (const std::int32_t body : {c.a, c.b}) {
        const std::size_t i = at(body);
        const bool movable = model.bodies[i].movable();
        if (movable) quiet = std::max(quiet, quiet_speed(model, i));
        if (movable) stops = std::max(stops, c.friction * pull_on(model, i) * model.settings.time_step);
        const Motion& m = state.motion[i];
        const Vec3 omega = movable ? angular_velocity(model, i, state.pose[i].rotation, m.momentum) : m.momentum;
        const Vec3 v = m.velocity + cross(omega, point_on(c, body) - state.pose[i].com);
        slip += body == c.b ? v : -v;
    }
    slip -= dot(slip, c.normal) * c.normal;
    return length(slip) > std::max(kSlides * quiet, stops);
}

} // namespace

void disturb_sliding(const Model& model, std::span<const Contact> contacts, const State& state, SleepScratch& scratch,
                     std::span<std::uint8_t> disturbed) {
    const auto movable = [&](std::int32_t body) { return model.bodies[at(body)].movable(); };
    if (contacts.empty()) return;
    scratch.joined.assign(model.size(), 0);
    for (const Contact& c : contacts)
        if (movable(c.a) && movable(c.b)) scratch.joined[at(c.a)] = scratch.joined[at(c.b)] = 1;
    for (const Contact& c : contacts)
        if ((scratch.joined[at(c.a)] | scratch.joined[at(c.b)]) == 0 && slides_on(model, c, state))
            disturbed[at(c.a)] = disturbed[at(c.b)] = 1;
}

std::int32_t steps_to_rest(const Model& model, std::size_t body) {
    constexpr double kMost = 1 << 30;
    const double pull = pull_on(model, body);
    if (!(pull > 0)) return static_cast<std::int32_t>(kMost);
    const double steps = std::ceil(std::sqrt(2 * model.shape_of(body).radius / pull) / model.settings.time_step);
    return std::max(kQuietSteps, static_cast<std::int32_t>(std::min(kMost, steps)));
}

void count_quiet_steps(const Model& model, std::span<const std::uint8_t> disturbed, State& state) {
    for (const std::int32_t body : model.active) {
        const std::size_t i = at(body);
        if (!model.bodies[i].movable()) continue;
        const Vec3 omega = angular_velocity(model, i, state.pose[i].rotation, state.motion[i].momentum);
        const double speed = length(state.motion[i].velocity) + length(omega) * model.shape_of(i).radius;
        std::int32_t& steps = state.sleep[i].quiet_steps;
        const bool quiet = speed < quiet_speed(model, i) && disturbed[i] == 0;
        steps = quiet ? std::min(steps, steps_to_rest(model, i) - 1) + 1 : 0;
    }
}

bool fall_asleep(const Model& model, std::span<const BodyPair> pairs, SleepScratch& s, State& state) {
    if (pairs.empty()) return false;
    s.movable.assign(model.size(), 0);
    for (const std::int32_t i : model.active) s.movable[at(i)] = model.bodies[at(i)].movable() ? 1 : 0;
    s.island.resize(pairs.size());
    const auto num_islands = static_cast<std::size_t>(find_islands(pairs, s.movable, s.graph, s.island));
    s.restless.assign(num_islands, 0);
    s.lowest.assign(num_islands, static_cast<std::int32_t>(model.size()));
    for (std::size_t k = 0; k < pairs.size(); ++k)
        for (const std::int32_t body : {pairs[k].a, pairs[k].b}) {
            const std::size_t island = at(s.island[k]);
            if (model.bodies[at(body)].scripted()) s.restless[island] = 1;
            if (s.movable[at(body)] == 0) continue;
            s.lowest[island] = std::min(s.lowest[island], body);
            if (state.sleep[at(body)].quiet_steps < steps_to_rest(model, at(body))) s.restless[island] = 1;
        }
    bool any = false;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const std::size_t island = at(s.island[k]);
        if (s.restless[island] != 0) continue;
        any = true;
        for (const std::int32_t body : {pairs[k].a, pairs[k].b}) {
            if (s.movable[at(body)] == 0) continue;
            state.sleep[at(body)].island = s.lowest[island];
            state.motion[at(body)] = {};
        }
    }
    return any;
}

void wake_island(std::size_t body, State& state) {
    const std::int32_t island = state.sleep[body].island;
    for (Sleep& s : state.sleep)
        if (s.island == island) s = {};
}

void wake_island(const Model& model, std::size_t body, std::size_t waker, State& state) {
    const std::int32_t island = state.sleep[body].island,
                       missing = std::max(0, steps_to_rest(model, waker) - state.sleep[waker].quiet_steps);
    for (std::size_t i = 0; i < state.sleep.size(); ++i) {
        if (state.sleep[i].island != island) continue;
        state.sleep[i] = {};
        state.sleep[i].quiet_steps = std::max(0, steps_to_rest(model, i) - missing);
    }
}

} // namespace flotilla
