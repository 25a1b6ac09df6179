// SPDX-License-Identifier: MIT
// Stage 5, second part: the failsafe (paper, section 4.2, Algorithm 3) with the ladder of G4.
//
// As long as some pair has no proof, clusters are resolved pair by pair and merged: kinematically where all hits
// between them could be resolved, rigidly where not. Clusters never chain through a static or scripted body: against
// one, a cluster is resolved, and goes down a rung at the first conflict that is not resolved, or at its second with
// the same body since its last merge. The last rung is x^n, bit for bit. A scripted body that meets a held one (or
// another that cannot give way) goes 0.9 of the way to what it would hit, and back to x^n the second time, or where
// that is less than 1/64 of its way; its other pairs are proved again, as against a static body.
//
// Termination: every sweep that leaves a pair unproved has merged two clusters, or taken one a rung down, or shortened
// a script's way or put it back, or used up one of the finitely many first conflicts since the last merge. Bodies that
// stand at x^n are proved against each other by the step before.
#pragma once

#include "pair/inelastic.hpp"

namespace flotilla {

/// A scripted body that did not make its whole step.
struct DelayedScript {
    std::int32_t body;
    double share;        ///< of the step that it made, in [0, 1)
    std::int32_t victim; ///< a body that was in its way when it was first held
    friend bool operator<(const DelayedScript& p, const DelayedScript& q) { return p.body < q.body; }
};

struct FailsafeStats {
    StageCounters counters;
    std::int64_t merges = 0;
    std::int64_t rung_changes = 0;
    std::vector<DelayedScript> delayed_scripts; ///< ascending
    std::int32_t trigger_a = -1, trigger_b = -1;
};

FailsafeStats run_failsafe(const StepView& view, Movers movers, PairBook& book, Workers& workers);

} // namespace flotilla
