// SPDX-License-Identifier: MIT
// Inelastic resolution of two clusters, the operation of dynamic contact (paper, section 4.1) and of the failsafe
// (4.2).
#pragma once

#include "pair/cluster_query.hpp"
#include "pair/examine.hpp"
#include "pair/impulses.hpp"
#include "pair/pair_lists.hpp"

namespace flotilla {

struct Resolution {
    bool found = false;                      ///< there was a hit
    bool resolved = false;                   ///< there is none left: every pair of members is proved
    std::int32_t first_a = -1, first_b = -1; ///< bodies of the first hit
    double toi = 1;                          ///< of it, [0, 1]
};

/// What a hit is answered with.
struct HitAnswer {
    double target;           ///< m/s, along the normal
    bool on_centres = false; ///< the impulse turns no body
};
/// Of the hit that a pair has after so many impulses. `centres`: m/s, of the centres of mass along its normal.
[[nodiscard]] HitAnswer answer_to(double dt, const SweptContact& contact, double centres, const PairLengths& lengths,
                                  int iteration, int iterations);
/// Whether a body turns so far in the step that a hit is answered on its centre of mass.
[[nodiscard]] bool turns_far(const Vec3& angular_velocity, double dt);
/// Whether displacing impulses leave the turns of both bodies as they are, however many they are: then a hit by turn
/// stays.
[[nodiscard]] bool turns_stay(const Impulsive& a, const Impulsive& b, double dt);

/// Handles hits in consecutive order, at most `iterations` of them, each with the impulse that brings the bodies to
/// their rest distance at the end of the step: v'_n = (d_rest - d)/dt. Bodies that meet on a side go there without a
/// turn, those that meet along a line without one that parts its ends.
Resolution resolve_inelastic(const StepView& view, Movers& movers, PairTable& pairs, Worker& worker,
                             const CandidatePair& clusters, int iterations);

/// Pairs of clusters, sorted, each once.
struct ClusterPairs {
    std::vector<CandidatePair> pairs;
    std::vector<CandidatePair> buffer; ///< scratch
};

/// Freezes the pairs of bodies that are not proved apart, and fills `out` with the pairs of clusters that they are of,
/// sorted by (lower id, higher id).
FrozenList freeze_clusters(const StepView& view, PairBook& book, Team& team, ClusterPairs& out);

} // namespace flotilla
