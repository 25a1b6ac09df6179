// SPDX-License-Identifier: MIT
// The proof of audit/sweep for two triangles that no plane of one direction keeps apart: feature by feature.
//
// Two triangles that are disjoint at the start of an interval can meet first only where a vertex of one meets the other
// or two edges meet: where one pierces the other elsewhere, it did so before. So it is enough that each of these 15
// pairs of features stays apart, and each may have a reason of its own:
// - a direction d, as for whole triangles, but for four points instead of six;
// - the determinant D = det(x1, x2, x3) of three differences of its four points keeps its sign: they are never in one
//   plane. Where the points move on straight lines D is a cubic of time, and over the interval it lies between its
//   smallest and its largest Bernstein coefficient. Faces that turn at a gap g leave any one direction after an angle
//   of g / size; their determinants do not mind.
//
// Error of D: every difference is known to eta, and L1, L2, L3 bound the three at both ends, hence between. Expanding
// the determinant, D errs by at most eta (L1 L2 + L1 L3 + L2 L3) + eta^2 (L1 + L2 + L3) + eta^3. Computing it errs by
// at most 64 u L1 L2 L3, u = 2^-53: cross and dot products by less than 16 u, a mean of three of them by less than 24
// u.
#pragma once

#include <cstdint>

#include "audit/separation.hpp"
#include "audit/triangle_distance.hpp"

namespace flotilla::audit {

/// Both triangles at one time.
struct Snapshot {
    double time;
    Corners a, b;
};

/// A set of the 15 pairs of features that are proved apart over an interval, and so over its parts.
using FeaturePairs = std::uint16_t;
inline constexpr FeaturePairs kAllFeaturePairs = (1 << 15) - 1;

/// `known`, and what is proved over the interval from s to e with its middle m.
[[nodiscard]] FeaturePairs features_apart(FeaturePairs known, const Snapshot& s, const Snapshot& m, const Snapshot& e,
                                          const Slack& slack);

} // namespace flotilla::audit
