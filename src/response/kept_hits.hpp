// SPDX-License-Identifier: MIT
// The hits of a step that were met so far, solved together.
//
// Pair by pair, a blow goes through a pile one body at a time, and every body that was hit has to be queried again.
// Here hits are kept, and after each round over the pairs an island's are solved by projected Gauss-Seidel, in rounds.
// First what the round meets rebounds, with restitution times the approach at which it was met; then all that was met
// so far is kept from approaching, without a second rebound. So hits that follow one another act as one after the
// other, and the last of a row of balls leaves. Points that are near each other before anything hits, contacts, wait:
// when a round makes one approach, it is met in the next round, and the pair need not be queried for that.
//
// A pair that hits at another point before any other pair pushed its bodies begins anew: its hits are solved as one,
// each for the rebound from the approach before all of them, as pair_manifold.hpp has it, and a crate lands flat.
//
// All impulses of a round are >= 0 along the normal and in the cone of friction, so their sums are. Where they would
// raise the kinetic energy of the island they are cut to the share that does not, all alike, which keeps momentum.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "response/impulse.hpp"

namespace flotilla {

/// A point where two bodies hit, or may. Those of an island are in one order: by bodies, then as they were added.
struct KeptHit {
    std::int32_t a = -1, b = -1; ///< bodies, or clusters of one
    /// relative_velocity: at first that of the points as they meet; once met, what that is on top of the rigid bodies'
    /// velocities.
    ContactPoint point{};
    double restitution = 0;
    // Of one that waits: it is met when it approaches faster than this, m/s, and as fast as brings it over the gap in
    // the step.
    double least = 0, gap = 0, room = 0; ///< m/s, m, m/s: the gap in a step
    bool met = false;                    ///< else it waits
    bool fresh = false;                  ///< to be met in the next round
    bool within = false;                 ///< of what others span (PairManifold::resolve): solved once they are
    double target = 0;                   ///< m/s, of its rebound
    Vec3 impulse{};                      ///< N s, on b, all of this step
    Vec3 change{};                       ///< of it, in the last solve
    std::int32_t found = -1;             ///< its place among what the last round found

    // Of a round.
    Vec3 start{}, next{}; ///< N s, what is solved for: of the round alone, or `impulse` where its pair begins anew
    bool live = false;    ///< takes part; one met before does from when it approaches faster than `least`
    double aim = 0;       ///< m/s
    double mass_normal = 0, mass_tangent = 0; ///< 1/kg, along the normal, and the largest across it
    std::int64_t seen = 0;                    ///< when the velocities were last looked at
};

/// By body; what several islands see, bodies of infinite mass, is only read.
struct HitBodies {
    std::vector<Impulsive> body;     ///< present velocities
    std::vector<Impulsive> before;   ///< of the round
    std::vector<std::int64_t> stamp; ///< when the velocities last changed
    std::vector<std::int64_t> owner; ///< the pair that pushed it in this step
    static constexpr std::int64_t kNone = -1, kMany = -2;
    std::vector<std::uint8_t> saved; ///< in `before`
};

/// Solves the hits at the given places, those of one island in their order. Whether sweeps got through with them.
bool solve_hits(std::span<KeptHit> hits, std::span<const std::int32_t> island, HitBodies& bodies);

} // namespace flotilla
