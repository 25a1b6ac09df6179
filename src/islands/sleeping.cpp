// SPDX-License-Identifier: MIT
#include "islands/sleeping.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

constexpr std::int32_t kQuietSteps = 12;
constexpr double kQuietShare = 1.0 / 50; // of |gravity| time_step

/// m/s: |gravity| is what moves a body that is not at rest, or what else does if that is less.
double quiet_speed(const Model& model, const SleepRule& rule, std::size_t i) {
    if (!model.bodies[i].driven() && !model.bodies[i].locked.any()) return rule.speed;
    return std::min(rule.speed, kQuietShare * least_acceleration(model, i) * model.settings.time_step);
}

} // namespace

SleepRule sleep_rule(const Model& model) {
    const double dt = model.settings.time_step;
    return {kQuietShare * length(model.gravity) * dt, kQuietSteps};
}

void count_quiet_steps(const Model& model, const SleepRule& rule, std::span<const std::uint8_t> disturbed,
                       State& state) {
    for (const std::int32_t body : model.active) {
        const std::size_t i = at(body);
        if (!model.bodies[i].movable()) continue;
        const Vec3 omega = angular_velocity(model, i, state.pose[i].rotation, state.motion[i].momentum);
        const double speed = length(state.motion[i].velocity) + length(omega) * model.shape_of(i).radius;
        std::int32_t& steps = state.sleep[i].quiet_steps;
        steps = speed < quiet_speed(model, rule, i) && disturbed[i] == 0 ? std::min(steps + 1, rule.steps) : 0;
    }
}

bool fall_asleep(const Model& model, const SleepRule& rule, std::span<const BodyPair> pairs, SleepScratch& s,
                 State& state) {
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
            if (state.sleep[at(body)].quiet_steps < rule.steps) s.restless[island] = 1;
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

void wake_island(std::size_t body, std::int32_t quiet_steps, State& state) {
    const std::int32_t island = state.sleep[body].island;
    Sleep awake;
    awake.quiet_steps = quiet_steps;
    for (Sleep& s : state.sleep)
        if (s.island == island) s = awake;
}

} // namespace flotilla
