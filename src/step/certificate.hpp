// SPDX-License-Identifier: MIT
// The end-of-step check: every pair is proved apart in one of four ways, and no other
// (src/pair/README.md#the-four-ways-to-be-proved).
//   a  The bounds that both bodies sweep in the step, widened by the separation, do not overlap.
//   b  The continuous query found no hit for the end states that both have now, or bounds say that it would find none.
//   c  Both are movable members of one cluster, proved against each other before it moved by a common translation, or
//      rigidly from x^n by less than two radians on straight paths (response/cluster.cpp), and nearer at x^n than twice
//      the rounding floor of their coordinates only with a proof of their own (failsafe).
//   d  Both stand where the step began, bit for bit.
#pragma once

#include <exception>

#include "pair/pair_lists.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// The ways, as above; none: neither body could move in the step, or what is known of it has lapsed.
enum class ProofWay : std::uint8_t { none, boxes, query, cluster, still };

/// Thrown where the end of a step could not be proved free of intersections: the first pair of bodies without a proof.
struct CertificateError : std::exception {
    explicit CertificateError(const CandidatePair& bodies) : pair(bodies) {}
    CandidatePair pair;
};

/// Throws CertificateError.
void certify(const StepView& view, PairBook& book, Team& team);

} // namespace flotilla
