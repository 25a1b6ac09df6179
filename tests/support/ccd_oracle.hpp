// SPDX-License-Identifier: MIT
// The truth about swept vertex-triangle and edge-edge queries, by means that share nothing with the library's kernels.
//
// exact_ccd decides in integer arithmetic whether the closed features ever meet and encloses the earliest time. Its
// only shortcut, prove_apart, is a rigorous bound in extended precision; it may be switched off, and a test compares
// both ways.
//
// Notation: the features meet at t exactly if the origin lies in the convex hull (VF) or the parallelogram (EE) of the
// difference vectors w(t): VF w_k = p - f_k; EE w_ij = a_i - b_j in the order 00, 01, 10, 11. All w are linear in t.
#pragma once

#include <gmpxx.h>

#include <cmath>

#include "geometry/ccd.hpp"

namespace flotilla::test {

struct OracleToi {
    bool hit = false;
    mpq_class lower, upper; ///< with hit: the earliest contact time lies in [lower, upper], width <= 2^-bits
};

enum class OracleFilter : std::uint8_t { on, off };

/// Do the closed features meet at some t in [0, 1], and when first? Exact for all finite input, whatever degenerates.
[[nodiscard]] OracleToi exact_ccd(CcdKind kind, const CcdQuery& query, unsigned bits = 80,
                                  OracleFilter filter = OracleFilter::on);

/// reported > the exact earliest contact time of this query? Exact. Precondition: `truth` comes from the same query and
/// hits.
[[nodiscard]] bool is_late(CcdKind kind, const CcdQuery& query, const OracleToi& truth, double reported);

struct DistanceRange {
    long double lower, upper; ///< m; the minimum distance over t in [0, 1] lies between
};

/// When the search for the minimum distance may stop.
struct DistanceGoal {
    long double tolerance = 1e-9L; ///< m, upper - lower
    long double above = HUGE_VALL; ///< stop once lower > above ...
    long double below = -1;        ///< ... or upper <= below
    int budget = 200'000;          ///< evaluations; the range is right also where this runs out
};

/// Bounds of the minimum distance of the features over [0, 1], by branch and bound on t in extended precision; the
/// rounding error is inside the range.
[[nodiscard]] DistanceRange min_distance(CcdKind kind, const CcdQuery& query, const DistanceGoal& goal = {});

} // namespace flotilla::test
