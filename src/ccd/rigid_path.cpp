// SPDX-License-Identifier: MIT
#include "ccd/rigid_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ccd/separation.hpp"
#include "geometry/rounding.hpp"

namespace flotilla {
namespace {

constexpr double kLeastOnArcs = 0.5; // of the separation, that a certificate must prove on the arcs
constexpr int kBlock = 8;            // segments whose near features are found together

double both_gaps(const BodyMotion& a, const BodyMotion& b, int segments) {
    return a.arc_gap(segments) + b.arc_gap(segments);
}

} // namespace

/// The paths of two bodies, segment by segment.
class SegmentedPath {
  public:
    SegmentedPath(const BodyMotion& a, const BodyMotion& b, const PathCut& cut, CcdScratch& scratch)
        : motion_{&a, &b}, segments_(cut.segments), gap_(cut.gap), scratch_(scratch) {}

    /// The earliest hit on the chords, in time of the whole path.
    PairHit earliest(const HitOptions& options) {
        const std::int64_t before = scratch_.counters.feature_queries;
        const int single = options.method == CcdMethod::conservative ? std::min(kBlock, segments_) : segments_;
        for (int i = 0; i < single; ++i)
            if (const auto hit = in_segment(i, options)) return *hit;
        // A search that takes more queries than the first block did without one is given up, and is the last.
        most_queries_ = scratch_.counters.feature_queries - before;
        for (int begin = single; begin < segments_; begin += kBlock)
            if (const auto hit = in_block(begin, options)) return *hit;
        return {};
    }

    /// `near`: null, or all feature pairs that can hit.
    std::optional<PairHit> in_segment(int i, const HitOptions& options,
                                      const std::vector<FeaturePair>* near = nullptr) {
        if (balls_apart(i, i + 1, options.separation)) return std::nullopt;
        ++scratch_.counters.segments;
        const BodyMotion a = chord(0, i, i + 1, 0), b = chord(1, i, i + 1, 0);
        PairHit hit = near != nullptr ? earliest_hit_among(a, b, options, *near, scratch_)
                                      : earliest_hit(a, b, options, {}, scratch_);
        if (!hit.hit) return std::nullopt;
        hit.toi = std::min((i + hit.toi) / segments_, 1.0);
        return hit;
    }

  private:
    /// The same for the segments of a block, which share one search for near features. The chords of a segment are
    /// within `gap_` of the arcs, and these are within the gap of a block of its own chords: features that these keep
    /// farther apart than both gaps, the rounding of placed ends and what a hit can be found at have none.
    std::optional<PairHit> in_block(int begin, const HitOptions& options) {
        if (balls_apart(begin, begin + kBlock, options.separation)) return std::nullopt;
        const BodyMotion a = chord(0, begin, begin + kBlock, 2), b = chord(1, begin, begin + kBlock, 2);
        const double gap = both_gaps(*motion_[0], *motion_[1], segments_ / kBlock);
        const double placed = place_rounding(motion_[0]->max_abs()) + place_rounding(motion_[1]->max_abs());
        const double apart = kNodeReach * options.separation + (gap + gap_) + placed;
        const bool shared =
            most_queries_ > 0 && find_near_features(a, b, apart, most_queries_, scratch_, scratch_.near_);
        if (!shared) most_queries_ = 0;
        for (int i = begin; i < begin + kBlock; ++i)
            if (const auto hit = in_segment(i, options, shared ? &scratch_.near_ : nullptr)) return hit;
        return std::nullopt;
    }

    /// Whether the balls about the centres of mass stay apart between two ends of segments.
    [[nodiscard]] bool balls_apart(int begin, int end, double separation) const {
        const auto between = [&](double t) {
            const auto com = [&](const BodyMotion& m) {
                return m.at0.pose->com + t * (m.at1.pose->com - m.at0.pose->com);
            };
            return com(*motion_[1]) - com(*motion_[0]);
        };
        const Vec3 from = between(time(begin)), to = between(time(end)), along = to - from;
        const double square = length_sq(along);
        const double nearest = square > 0 ? std::clamp(-dot(from, along) / square, 0.0, 1.0) : 0.0;
        const double room = place_rounding(std::max(motion_[0]->max_abs(), motion_[1]->max_abs()));
        return length(from + nearest * along) >
               motion_[0]->shape->radius + motion_[1]->shape->radius + kClear * separation + room;
    }

    [[nodiscard]] double time(int i) const { return static_cast<double>(i) / segments_; }

    /// From one end of a segment to another. `slots`: where the two that are even or odd multiples of their distance
    /// stay placed.
    BodyMotion chord(std::size_t body, int begin, int end, std::size_t slots) {
        const auto slot = [&](int i) { return slots + static_cast<std::size_t>(i / (end - begin) % 2); };
        return {
            motion_[body]->shape, end_of_segment(body, begin, slot(begin)), end_of_segment(body, end, slot(end)), {}};
    }

    /// Both ends of the path are the committed placements themselves, bit for bit.
    BodyPlacement end_of_segment(std::size_t body, int i, std::size_t slot) {
        const BodyMotion& m = *motion_[body];
        if (i == 0 || m.still()) return m.at0;
        if (i == segments_) return m.at1;
        PlacedBody& placed = scratch_.placed_[body][slot];
        int& which = placed_at_[body][slot];
        if (which != i) placed.place(*m.shape, m.pose(time(i)));
        which = i;
        return placed.view();
    }

    std::array<const BodyMotion*, 2> motion_;
    int segments_;
    double gap_;                    ///< m, of a segment, both bodies together
    std::int64_t most_queries_ = 0; ///< that a search for near features may take
    CcdScratch& scratch_;
    std::array<std::array<int, 4>, 2> placed_at_{}; ///< which end of a segment is in scratch_.placed_; 0: none
};

namespace {

/// Gives a hit the normal that the bodies have on their paths, not on the chords.
PairHit on_path(const BodyMotion& a, const BodyMotion& b, PairHit hit) {
    if (!hit.hit) return hit;
    if (const Vec3 n = closest_direction(a, b, hit.features, hit.toi); n != Vec3{}) hit.normal = n;
    return hit;
}

/// The hit of a pair that starts too near for its turn: the first that approaches, else one that is near at the start.
PairHit hit_at_start(SegmentedPath& path, HitOptions options, double start_distance) {
    PairHit hit = path.earliest(options);
    if (!hit.hit) {
        options.start = CcdStart::strict;
        options.separation = std::max(options.separation, 1.1 * start_distance);
        hit = path.in_segment(0, options).value_or(PairHit{true, 0, {}, {}});
    }
    hit.by_turn = true;
    return hit;
}

} // namespace

PathCut cut_path(const BodyMotion& a, const BodyMotion& b, const PathLengths& lengths) {
    PathCut cut{1, both_gaps(a, b, 1), lengths.start_distance};
    const double limit = kArcShare * std::min(lengths.rest, lengths.start_distance);
    while (cut.segments < kMaxSegments && !(cut.gap < limit) && cut.gap > 0) {
        cut.segments *= 2;
        cut.gap = both_gaps(a, b, cut.segments);
    }
    return cut;
}

PairHit earliest_hit_on_path(const BodyMotion& a, const BodyMotion& b, const HitOptions& options, const PathCut& cut,
                             const QueryAid& aid, CcdScratch& scratch) {
    if (cut.gap == 0) return earliest_hit(a, b, options, aid, scratch);
    SegmentedPath path(a, b, cut, scratch);
    HitOptions chord = options;
    if (options.method == CcdMethod::conservative) {
        chord.separation += cut.gap;
        if (!(cut.start_distance >= kNotNear * chord.separation)) {
            const double kept = kKeptShare * cut.start_distance;
            if (!(kept - cut.gap >= kLeastOnArcs * std::min(options.separation, kept)))
                return on_path(a, b, hit_at_start(path, chord, cut.start_distance));
            chord.separation = kept;
        }
        chord.start = CcdStart::strict;
    }
    if (cut.segments == 1) return earliest_hit(a, b, chord, aid, scratch);
    // Strict starts hit at once only where they are nearer than the gap adds to the separation.
    PairHit hit = on_path(a, b, path.earliest(chord));
    hit.by_turn = chord.start == CcdStart::strict && hit.toi == 0;
    return hit;
}

} // namespace flotilla
