// SPDX-License-Identifier: MIT
// Continuous collision detection for whoever looks for the earliest of many hits.
#pragma once

#include "geometry/ccd.hpp"

namespace flotilla {

struct CcdHitOptions {
    double separation = 0; ///< m, >= 0
    CcdStart start = CcdStart::strict;
    double latest = 1; ///< hits after it are not wanted, [0, 1]
};

/// As ccd_batch(), but the results of misses have hit = false and nothing else, and so may those of hits after
/// `latest`. Nothing is found out that is not asked for: where a hit is late, and along which direction features are
/// apart.
void ccd_hits(CcdKind kind, const CcdPoints& points, std::span<const CcdCorners> corners, const CcdHitOptions& options,
              std::span<CcdResult> results, Isa isa);

} // namespace flotilla
