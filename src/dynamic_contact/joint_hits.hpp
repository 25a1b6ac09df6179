// SPDX-License-Identifier: MIT
// Where sweeps of dynamic contact gain nothing, come to their limit or leave a pair unresolved: its hits solved
// together.
//
// A light body between heavy ones, or between one and the ground, hands on in a sweep no more than its own mass takes:
// pushes fall by the ratio of the masses, and the links of a chain under a load of 100 times theirs take thousands of
// sweeps. So hits are kept here, each as the contact that it is: what it asks for along its normal, with friction.
// After each round of queries all of an island's are solved at once, as stage 3 solves its contacts. What that makes
// hit elsewhere is met in the next round. Rounds end where nothing hits any more. The failsafe takes
// what they do not end.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pair/inelastic.hpp"
#include "state/contact.hpp"

namespace flotilla {

/// Solves contacts, sorted by bodies, of bodies that move as `motion` (by body) without them. `impulses`: N s, on b, by
/// contact; in, what was found in the last round. Returns flags by body: islands for which nothing near a solution was
/// found.
using SolveHits = std::function<std::span<const std::uint8_t>(
    std::span<const Contact> hits, std::span<const Motion> motion, std::span<Vec3> impulses)>;

/// Hits of an island, of all rounds: what a solve takes grows faster than their number. Cups in each other hit at more
/// and more points until they stay: twelve at more than 128.
inline constexpr std::ptrdiff_t kMostHitsTogether = 512;

/// What solves hits, and the bodies that it did not help, as flags by body: those are left to the failsafe at once
/// where a step goes through stages 4 and 5 again.
struct JointSolve {
    SolveHits solve;
    std::vector<std::uint8_t> left;
};

/// Whether nothing hits any more. Clusters must be single bodies. `counters`: added to.
[[nodiscard]] bool resolve_jointly(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                   JointSolve& joint, StageCounters& counters);

} // namespace flotilla
