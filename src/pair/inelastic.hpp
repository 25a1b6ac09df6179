// SPDX-License-Identifier: MIT
// Inelastic resolution of two clusters, the operation of dynamic contact (paper, section 4.1) and of the failsafe
// (4.2).
#pragma once

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

/// Handles hits in consecutive order, at most `iterations` of them, each with the impulse that brings the bodies to
/// their rest distance at the end of the step: v'_n = (d_rest - d)/dt. Bodies that meet on a side go there without a
/// turn.
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
