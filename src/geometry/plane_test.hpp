// SPDX-License-Identifier: MIT
// A quick look at whether two features are farther apart than a distance: by the plane of the face, or by the planes
// that hold one edge each and are parallel to the other. An eighth of the work of the closest points.
#pragma once

#include "geometry/ccd.hpp"

namespace flotilla {

/// Writes the numbers of the feature pairs that are not known to be farther apart than `distance` (m) at t = 0, in
/// their order; returns how many. `out` has room for all and one more. Features whose directions span no plane are
/// never ruled out.
[[nodiscard]] long near_by_planes(CcdKind kind, const CcdPoints& points, std::span<const CcdCorners> corners,
                                  double distance, std::int32_t* out, Isa isa);

/// Compiled for its instruction set: call only where the processor has it. `corners`: four per pair.
long near_by_planes_avx2(CcdKind kind, const CcdPoints& points, const std::int32_t* corners, long count,
                         double distance, std::int32_t* out);

} // namespace flotilla
