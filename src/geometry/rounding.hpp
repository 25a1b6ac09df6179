// SPDX-License-Identifier: MIT
// Allowances for rounding that proofs share, u = 2^-53. They are far above what rounding does, by a factor of hundreds,
// so that the sums around them need no count of their own; and far below what they are taken from: at 1 km from the
// origin the first one is a nanometre, beside a separation of 0.2 mm of the paper's boat. What continuous collision
// detection itself allows for is tighter and counted: ccd_error() and ccd_floor() (ccd.hpp).
#pragma once

namespace flotilla {

/// m, for places computed from a pose (world vertices, centres, their projections on a unit vector), which are off by
/// some 8 u of the largest coordinate: 2^13 u.
[[nodiscard]] constexpr double place_rounding(double max_abs) { return 0x1p-40 * max_abs; }

/// For the comparison of lengths that a few operations made, each rounded to a relative u: 2^33 u. The length that must
/// be the greater one is taken times (1 - kLengthRounding), the other one times (1 + kLengthRounding).
inline constexpr double kLengthRounding = 0x1p-20;

} // namespace flotilla
