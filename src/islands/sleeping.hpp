// SPDX-License-Identifier: MIT
// Resting islands sleep: an island whose bodies have all been quiet for a while stands still until something comes
// near it. Sleeping bodies are obstacles like static ones, so the guarantee does not depend on who sleeps.
#pragma once

#include <span>

#include "islands/contact_graph.hpp"
#include "state/model.hpp"

namespace flotilla {

struct SleepRule {
    double speed =
        0; ///< m/s: a body is quiet while |v| + |omega| radius stays below (less where less pulls on it than gravity)
    std::int32_t steps = 0; ///< a body may fall asleep after so many quiet steps
};
/// Twelve steps below a fiftieth of what gravity adds in one: whatever is not at rest gathers more in that time.
[[nodiscard]] SleepRule sleep_rule(const Model& model);

/// Counts the quiet steps of the bodies after a step; `disturbed` bodies begin anew.
void count_quiet_steps(const Model& model, const SleepRule& rule, std::span<const std::uint8_t> disturbed,
                       State& state);

struct SleepScratch {
    ContactGraphScratch graph;
    std::vector<std::uint8_t> movable, restless;
    std::vector<std::int32_t> island, lowest;
};

/// Puts islands to rest: all bodies quiet long enough, none touching a scripted one. `pairs`: touching bodies, sorted;
/// one of each at least is movable. Velocities of bodies that fall asleep become zero. Returns whether any did.
bool fall_asleep(const Model& model, const SleepRule& rule, std::span<const BodyPair> pairs, SleepScratch& scratch,
                 State& state);

/// Wakes everyone who fell asleep with `body`. `quiet_steps`: of who wakes them, so that those who are quiet already
/// fall asleep together, and do not wake each other for ever.
void wake_island(std::size_t body, std::int32_t quiet_steps, State& state);

[[nodiscard]] inline bool asleep(const State& state, std::size_t body) { return state.sleep[body].island >= 0; }

} // namespace flotilla
