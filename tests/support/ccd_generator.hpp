// SPDX-License-Identifier: MIT
// Random and adversarial CCD queries. The query is a function of (class, index): any one of them can be made again
// alone.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/ccd.hpp"

namespace flotilla::test {

enum class QueryClass : std::uint8_t {
    uniform,    ///< independent points in a cube
    aimed,      ///< features meet, or miss by 1e-1..1e-16, at a random time
    resting,    ///< slow relative motion a small gap apart, fast common motion
    sliver,     ///< needle triangles, nearly parallel edges
    degenerate, ///< zero-area faces and zero-length edges
    coplanar,   ///< motion inside one plane, axis-parallel or tilted
    parallel,   ///< edges parallel throughout, vertices sliding along edges
    far_away,   ///< any class before, up to 1e6 m from the origin
    one_ulp,    ///< ends (or starts) on the other feature, or one unit in the last place to either side
    grazing,    ///< double roots and passing end points, exact or off by little
    at_start,   ///< contact at t = 0 exactly, most of them parting
    at_end,     ///< contact at t = 1 exactly
    fast,       ///< 1e2..1e8 times their size in one step
    denormal,   ///< subnormal coordinates, alone or among ordinary ones
    lattice,    ///< small integers: every kind of coincidence at once
    still,      ///< no motion
};
inline constexpr std::array<const char*, 16> kQueryClassNames{
    "uniform", "aimed",   "resting",  "sliver", "degenerate", "coplanar", "parallel", "far_away",
    "one_ulp", "grazing", "at_start", "at_end", "fast",       "denormal", "lattice",  "still"};

/// The query of this number; even ones are vertex-face, odd ones edge-edge (index % 2, see kind_of).
[[nodiscard]] CcdQuery make_query(QueryClass query_class, std::uint64_t index);
[[nodiscard]] inline CcdKind kind_of(std::uint64_t index) {
    return index % 2 == 0 ? CcdKind::vertex_face : CcdKind::edge_edge;
}

} // namespace flotilla::test
