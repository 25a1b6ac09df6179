// SPDX-License-Identifier: MIT
// The triangle test against CGAL's, which decides the same question with other code and other numbers.
#pragma once

#include <cstdint>

#include "geometry/exact_pairs.hpp"

namespace flotilla::test {

struct Agreement {
    std::int64_t pairs = 0, intersecting = 0, disagreements = 0, degenerate = 0, segments = 0, segments_hit = 0;
};

/// Compares triangles_intersect on the pairs, and segment_intersects_triangle on one edge of each, with CGAL.
Agreement compare_with_cgal(const PairClass& pair_class, std::int64_t pairs, std::uint64_t seed);

/// The comparison as a test: prints the counts, expects no disagreement and both answers often enough.
void expect_agreement_with_cgal(const PairClass& pair_class, std::int64_t pairs, std::uint64_t seed);

} // namespace flotilla::test
