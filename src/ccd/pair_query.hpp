// SPDX-License-Identifier: MIT
// Earliest collision of a body pair along the linear trajectories of all its vertices (paper, section 3.1).
//
// The continuous collision detection of the features is the conservative one, whose "no hit" is a proof, or as a
// baseline the paper's cubic, whose "no hit" proves nothing.
#pragma once

#include <span>
#include <vector>

#include <flotilla/settings.hpp>

#include "ccd/plane_features.hpp"
#include "ccd/query_aid.hpp"
#include "ccd/separation.hpp"

namespace flotilla {

/// The earliest hit of a pair. No hit of the conservative method: both bodies are proved farther apart than the
/// separation (relaxed for features that start closer, see CcdStart) during the whole motion.
struct PairHit {
    bool hit = false;
    double toi = 1;       ///< [0, 1]
    FeaturePair features; ///< of the hit
    Vec3 normal;          ///< unit, from a to b at the time of impact
    /// The bodies start too near each other for what they turn: as long as both turn so far there is a hit, wherever
    /// they go.
    bool by_turn = false;
};

struct QueryCounters {
    std::int64_t box_tests = 0, feature_queries = 0, pair_queries = 0;
    std::int64_t segments = 0; ///< of paths that were cut

    QueryCounters& operator+=(const QueryCounters& c) {
        box_tests += c.box_tests;
        feature_queries += c.feature_queries;
        pair_queries += c.pair_queries;
        segments += c.segments;
        return *this;
    }
};

/// Buffers of a pair query; one per thread, reused.
class CcdScratch {
  public:
    QueryCounters counters;
    ListingScratch listing;

  private:
    friend class EarliestHit;
    std::array<std::vector<FeaturePair>, 3> waiting_; ///< by kind
    std::vector<FeaturePair> asked_;
    std::vector<CcdCorners> corners_; ///< of those
    std::vector<CcdResult> results_;  ///< of those
    FeatureBuffer features_;
    SliceScratch slices_;
    friend class SegmentedPath;
    std::array<std::array<PlacedBody, 4>, 2> placed_; ///< by body, ends of segments and of blocks of them, even and odd
    std::vector<FeaturePair> near_;                   ///< of a block
};

/// What is asked of a pair.
struct HitOptions {
    double separation = 0; ///< m; the tolerance of the cubic
    CcdStart start = CcdStart::relaxed;
    CcdMethod method = CcdMethod::conservative;
};

/// A pure function of the two motions and the options. A feature pair whose own moving (coarse) boxes stay farther
/// apart than the separation cannot hit; among the others the least (time, feature key) wins, where the time is not
/// before the entry of their boxes: so the answer does not depend on how candidates were found or in which order they
/// were tried. A list that is given must reach swept_reach(separation).
[[nodiscard]] PairHit earliest_hit(const BodyMotion& a, const BodyMotion& b, const HitOptions& options,
                                   const QueryAid& aid, CcdScratch& scratch);
/// The same answer from `among`, which must have all feature pairs that hit.
[[nodiscard]] PairHit earliest_hit_among(const BodyMotion& a, const BodyMotion& b, const HitOptions& options,
                                         std::span<const FeaturePair> among, CcdScratch& scratch);
/// All feature pairs that are not proved farther apart than `separation` (m) during the whole motion, by the
/// conservative method; false where that takes more than `most` feature queries.
[[nodiscard]] bool find_near_features(const BodyMotion& a, const BodyMotion& b, double separation, std::int64_t most,
                                      CcdScratch& scratch, std::vector<FeaturePair>& near);

} // namespace flotilla
