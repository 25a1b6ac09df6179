// SPDX-License-Identifier: MIT
// Resting islands sleep: an island whose bodies have all been quiet for a while stands still until something comes
// near it. Sleeping bodies are obstacles like static ones, so the guarantee does not depend on who sleeps.
#pragma once

#include <span>

#include "islands/contact_graph.hpp"
#include "state/contact.hpp"
#include "state/model.hpp"

namespace flotilla {

struct SleepScratch {
    ContactGraphScratch graph;
    std::vector<std::uint8_t> movable, joined, restless;
    std::vector<std::int32_t> island, lowest;
};

/// m/s, below which a body may be at rest: 1/256 of what gravity adds in a step, sixteen times what static contact may
/// leave undone of that; more where its tolerance is greater.
[[nodiscard]] double quiet_speed(const Model& model, std::size_t body);

/// Marks in `disturbed` what slides at a contact by more than static contact leaves undone, and than its friction stops
/// within a step: however slow it is, that does not come to rest. Of bodies that touch no other movable one: between
/// several, what solves leave undone adds up where no friction stops it, and stacks that stand would never sleep.
void disturb_sliding(const Model& model, std::span<const Contact> contacts, const State& state, SleepScratch& scratch,
                     std::span<std::uint8_t> disturbed);

/// Counts the quiet steps of the bodies after a step; `disturbed` bodies begin anew. A body is quiet while
/// |v| + |omega| radius is less than quiet_speed().
void count_quiet_steps(const Model& model, std::span<const std::uint8_t> disturbed, State& state);

/// Steps that the body must be quiet for before it may fall asleep: twelve, and as many as it takes to fall by its
/// radius. What is not at rest gathers more speed in that time, however short a step is.
[[nodiscard]] std::int32_t steps_to_rest(const Model& model, std::size_t body);

/// Puts islands to rest: all bodies quiet long enough, none touching a scripted one. `pairs`: touching bodies, sorted;
/// one of each at least is movable. Velocities of bodies that fall asleep become zero. Returns whether any did.
bool fall_asleep(const Model& model, std::span<const BodyPair> pairs, SleepScratch& scratch, State& state);

/// Wakes everyone who fell asleep with `body`.
void wake_island(std::size_t body, State& state);
/// The same for what comes near it. They may fall asleep again when that may, not before: those who are quiet already
/// fall asleep together, and do not wake each other for ever.
void wake_island(const Model& model, std::size_t body, std::size_t waker, State& state);

[[nodiscard]] inline bool asleep(const State& state, std::size_t body) { return state.sleep[body].island >= 0; }

} // namespace flotilla
