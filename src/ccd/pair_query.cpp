// SPDX-License-Identifier: MIT
#include "ccd/pair_query.hpp"

#include <algorithm>
#include <limits>

#include "ccd/separation.hpp"
#include "ccd/triangle_features.hpp"
#include "ccd/triangles_apart.hpp"
#include "geometry/ccd_cubic.hpp"
#include "geometry/ccd_hits.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBatch = 32; // queries between two updates of the earliest hit
constexpr float kNodeTimeSlack = 0x1p-19f;

} // namespace

class EarliestHit {
  public:
    EarliestHit(const BodyMotion& a, const BodyMotion& b, const HitOptions& options, CcdScratch& scratch)
        : a_(a),
          b_(b),
          options_(options),
          feature_reach_(options.separation * kFeatureReach, std::max(a.max_abs(), b.max_abs())),
          node_reach_(swept_reach(options.separation, a, b), std::max(a.max_abs(), b.max_abs())),
          scratch_(scratch) {}

    PairHit run(const QueryAid& aid) {
        ++scratch_.counters.pair_queries;
        if (sliced(aid))
            examine_all(scratch_.slices_.found());
        else if (aid.list.list != nullptr)
            scan(aid.list);
        else
            traverse();
        return best_;
    }

    PairHit run_among(std::span<const FeaturePair> among) {
        ++scratch_.counters.pair_queries;
        float entry = 0;
        for (const FeaturePair& f : among)
            if (meet(f, entry)) add(f);
        for (auto& waiting : scratch_.waiting_) flush(waiting);
        return best_;
    }

    /// All hits, not the earliest alone, unless that takes too many feature queries.
    bool collect(std::vector<FeaturePair>& hits, std::int64_t most) {
        hits_ = &hits;
        hits.clear();
        last_query_ = scratch_.counters.feature_queries + most;
        traverse();
        return scratch_.counters.feature_queries <= last_query_;
    }

  private:
    bool sliced(const QueryAid& aid) {
        return aid.direction != Vec3{} && options_.method == CcdMethod::conservative &&
               slice_features(FeatureTest::swept, a_, b_, aid.direction, kClear * options_.separation,
                              scratch_.slices_);
    }

    void scan(const CoveringList& list) {
        scratch_.counters.box_tests += static_cast<std::int64_t>(list.list->size());
        examine_all(list.list->select(FeatureTest::swept, a_, b_, list.strayed, node_reach_, scratch_.features_));
    }

    /// Of features by kind.
    void examine_all(std::span<const FeaturePair> left) {
        while (!left.empty()) {
            const auto other = [&](const FeaturePair& f) { return f.kind != left[0].kind; };
            const auto few = left.first(std::min(kBatch, left.size()));
            const auto n = static_cast<std::size_t>(std::find_if(few.begin(), few.end(), other) - few.begin());
            examine(left.first(n));
            left = left.subspan(n);
        }
    }

    void traverse() {
        float entry = 0;
        TrianglesApart apart(a_, b_, kClear * double{node_reach_.distance()});
        const auto meet = [&](const MovingCoarseBox& p, const MovingCoarseBox& q) {
            return coarse_overlap(p, q, node_reach_, node_reach_, entry, static_cast<float>(best_.toi) + kNodeTimeSlack,
                                  kNodeTimeSlack);
        };
        bvh_detail::traverse(
            a_.shape->bvh, b_.shape->bvh, a_.at1.nodes, b_.at1.nodes,
            [&](std::int32_t i, std::int32_t j, double& entry_time) {
                const bool live = meet(coarse_node(a_, i), coarse_node(b_, j));
                entry_time = entry;
                return live;
            },
            [&](double entry_time) {
                return !(entry_time > best_.toi + double{kNodeTimeSlack}) &&
                       scratch_.counters.feature_queries <= last_query_;
            },
            [&](std::int32_t i, std::int32_t j, double) {
                for (const std::int32_t p : a_.shape->bvh.leaf_triangles(i))
                    for (const std::int32_t q : b_.shape->bvh.leaf_triangles(j)) {
                        if (options_.method == CcdMethod::conservative && apart(p, q)) continue;
                        for_each_feature_pair(a_, b_, p, q, meet, [&](const FeaturePair& f) { add(f); });
                    }
            });
        for (auto& waiting : scratch_.waiting_) flush(waiting);
    }

    void add(const FeaturePair& f) {
        auto& waiting = scratch_.waiting_[static_cast<std::size_t>(f.kind)];
        waiting.push_back(f);
        if (waiting.size() == kBatch) flush(waiting);
    }
    void flush(std::vector<FeaturePair>& waiting) {
        examine(waiting);
        waiting.clear();
    }

    /// Whether the pair's own moving boxes meet before the earliest hit so far, and the time from which on they do.
    [[nodiscard]] bool meet(const FeaturePair& f, float& entry) const {
        const auto overlap = [&](const MovingCoarseBox& p, const MovingCoarseBox& q) {
            return coarse_overlap(p, q, feature_reach_, feature_reach_, entry, static_cast<float>(best_.toi));
        };
        const Topology &ta = a_.shape->topology, &tb = b_.shape->topology;
        const auto i = static_cast<std::size_t>(f.a), j = static_cast<std::size_t>(f.b);
        switch (f.kind) {
        case FeatureKind::vertex_face:
            return overlap(coarse_vertex(a_, f.a), coarse_triangle(b_, b_.shape->mesh.triangles[j]));
        case FeatureKind::face_vertex:
            return overlap(coarse_triangle(a_, a_.shape->mesh.triangles[i]), coarse_vertex(b_, f.b));
        default: return overlap(coarse_edge(a_, ta.edges[i]), coarse_edge(b_, tb.edges[j]));
        }
    }

    /// Queries feature pairs of one kind. Most are proved apart by a CCD that costs little more than the test of their
    /// own boxes, so that test comes after it, for the hits; before it only where there is an earliest hit to be late
    /// for and queries go one by one.
    void examine(std::span<const FeaturePair> features) {
        if (features.empty()) return;
        float entry = 0;
        if (best_.hit && (isa_ == Isa::scalar || options_.method == CcdMethod::cubic)) {
            scratch_.asked_.clear();
            for (const FeaturePair& f : features)
                if (meet(f, entry)) scratch_.asked_.push_back(f);
            features = scratch_.asked_;
        }
        ask(features);
        if (hits_ != nullptr) {
            for (std::size_t i = 0; i < features.size(); ++i)
                if (scratch_.results_[i].hit) hits_->push_back(features[i]);
            return;
        }
        for (std::size_t i = 0; i < features.size(); ++i)
            if (scratch_.results_[i].hit && meet(features[i], entry)) offer(features[i], scratch_.results_[i], entry);
    }

    /// Fills scratch_.results_.
    void ask(std::span<const FeaturePair> features) {
        scratch_.counters.feature_queries += static_cast<std::int64_t>(features.size());
        auto& results = scratch_.results_;
        if (results.size() < features.size()) results.resize(features.size());
        if (options_.method == CcdMethod::cubic) {
            for (std::size_t i = 0; i < features.size(); ++i)
                results[i] = ccd_cubic(ccd_kind(features[i].kind), ccd_query(a_, b_, features[i]), options_.separation);
            return;
        }
        scratch_.corners_.clear();
        for (const FeaturePair& f : features) scratch_.corners_.push_back(ccd_corners(a_, b_, f));
        if (features.empty()) return;
        const FeatureKind kind = features[0].kind;
        ccd_hits(ccd_kind(kind), ccd_points(a_, b_, kind), scratch_.corners_,
                 {options_.separation, options_.start, best_.toi}, std::span(results).first(features.size()), isa_);
    }

    void offer(const FeaturePair& f, const CcdResult& r, double entry) {
        const double toi = std::max(r.toi, entry);
        if (best_.hit && (toi > best_.toi || (toi == best_.toi && feature_key(f) > feature_key(best_.features))))
            return;
        best_ = {true, toi, f, from_a_to_b(f.kind, r.direction)};
    }

    const BodyMotion &a_, &b_;
    HitOptions options_;
    CoarseReach feature_reach_, node_reach_;
    CcdScratch& scratch_;
    Isa isa_ = best_isa();
    PairHit best_;
    std::vector<FeaturePair>* hits_ = nullptr; ///< where hits are collected
    std::int64_t last_query_ = std::numeric_limits<std::int64_t>::max();
};

namespace {

/// The direction at the time of impact, from the closest points themselves where they are distinct: the certifying
/// direction of an early stop may be a poor normal.
PairHit with_normal(const BodyMotion& a, const BodyMotion& b, PairHit best) {
    if (!best.hit) return best;
    if (const Vec3 n = closest_direction(a, b, best.features, best.toi); n != Vec3{}) best.normal = n;
    return best;
}

} // namespace

PairHit earliest_hit(const BodyMotion& a, const BodyMotion& b, const HitOptions& options, const QueryAid& aid,
                     CcdScratch& scratch) {
    return with_normal(a, b, EarliestHit(a, b, options, scratch).run(aid));
}

PairHit earliest_hit_among(const BodyMotion& a, const BodyMotion& b, const HitOptions& options,
                           std::span<const FeaturePair> among, CcdScratch& scratch) {
    return with_normal(a, b, EarliestHit(a, b, options, scratch).run_among(among));
}

bool find_near_features(const BodyMotion& a, const BodyMotion& b, double separation, std::int64_t most,
                        CcdScratch& scratch, std::vector<FeaturePair>& near) {
    return EarliestHit(a, b, {separation, CcdStart::strict, CcdMethod::conservative}, scratch).collect(near, most);
}

} // namespace flotilla
