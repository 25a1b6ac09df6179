// SPDX-License-Identifier: MIT
// The paper's continuous collision detection (section 3.1), kept as a baseline. IT PROVES NOTHING: use ccd() of
// ccd.hpp.
//
// Scheme of reference [27] (Bridson, Fedkiw, Anderson 2002): the four points are coplanar at the roots of a cubic in t;
// at each root in [0, 1], in ascending order, and at the end of the step, the distance of the features is compared with
// a tolerance. The start of the step is not looked at. What it misses: motions that stay coplanar, where the cubic
// vanishes identically and has no roots (everyday life of flat bodies), unless they end within the tolerance; grazing
// contacts, whose double root rounding may remove; features that come within the tolerance without ever becoming
// coplanar. What it reports too much: everything within the tolerance at a coplanar time.
#pragma once

#include "geometry/ccd.hpp"

namespace flotilla {

/// Absolute tolerance of the paper, m. Neither sufficient nor scale-free; see above.
inline constexpr double kCubicTolerance = 1e-4;

/// toi is the accepted root (not a bound: the features may meet earlier), direction the closest direction there,
/// iterations the number of distance tests.
[[nodiscard]] CcdResult ccd_cubic(CcdKind kind, const CcdQuery& query, double tolerance = kCubicTolerance);

} // namespace flotilla
