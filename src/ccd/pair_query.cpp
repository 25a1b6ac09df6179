// SPDX-License-Identifier: MIT
#include "ccd/pair_query.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBatch = 32;        // queries between two looks at the earliest hit so far
constexpr double kBoxMargin = 1 + 0x1p-6; // boxes are tried with a little more than the separation

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

/// A triangle of one body with the boxes of its features at both times.
struct TriangleFeatures {
    std::uint8_t owned;
    Triangle corners;
    std::array<std::int32_t, 3> edges;
    Box box0, box1;
    std::array<Box, 3> edge0, edge1;

    TriangleFeatures(const BodyMotion& body, std::int32_t t)
        : owned(body.shape->topology.owned[at(t)]),
          corners(body.shape->mesh.triangles[at(t)]),
          edges(body.shape->topology.triangle_edges[at(t)]) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Edge e{corners[k], corners[(k + 1) % 3]};
            edge0[k] = edge_box(body.x0, e);
            edge1[k] = edge_box(body.x1, e);
        }
        box0 = merged(edge0[0], edge0[1]);
        box1 = merged(edge1[0], edge1[1]);
    }
};

} // namespace

class EarliestHit {
  public:
    EarliestHit(const BodyMotion& a, const BodyMotion& b, double separation, CcdScratch& scratch)
        : a_(a),
          b_(b),
          separation_(separation),
          inflation_(separation * kBoxMargin,
                     std::max(bvh_detail::max_abs_coordinate(a.view()), bvh_detail::max_abs_coordinate(b.view()))),
          scratch_(scratch) {}

    PairHit run() {
        ++scratch_.counters.pair_queries;
        for_each_leaf_pair_until(a_.view(), b_.view(), inflation_.value(), 1.0,
                                 [&](std::span<const std::int32_t> ta, std::span<const std::int32_t> tb, double) {
                                     for (std::int32_t i : ta)
                                         for (std::int32_t j : tb) add_triangles(i, j);
                                     return best_.toi;
                                 });
        flush(CcdKind::vertex_face);
        flush(CcdKind::edge_edge);
        return best_;
    }

  private:
    void add_triangles(std::int32_t i, std::int32_t j) {
        const TriangleFeatures a(a_, i), b(b_, j);
        double entry = 0;
        ++scratch_.counters.box_tests;
        if (!moving_boxes_overlap(a.box0, a.box1, b.box0, b.box1, inflation_, entry, best_.toi)) return;
        for (int k = 0; k < 3; ++k) {
            const auto v = a.corners[static_cast<std::size_t>(k)], w = b.corners[static_cast<std::size_t>(k)];
            if (owns_corner(a.owned, k))
                add({FeatureKind::vertex_face, v, j}, vertex_box(a_.x0, v), vertex_box(a_.x1, v), b.box0, b.box1);
            if (owns_corner(b.owned, k))
                add({FeatureKind::face_vertex, i, w}, a.box0, a.box1, vertex_box(b_.x0, w), vertex_box(b_.x1, w));
        }
        for (int k = 0; k < 3; ++k) {
            if (!owns_edge(a.owned, k)) continue;
            const auto ek = static_cast<std::size_t>(k);
            for (int l = 0; l < 3; ++l) {
                const auto el = static_cast<std::size_t>(l);
                if (owns_edge(b.owned, l))
                    add({FeatureKind::edge_edge, a.edges[ek], b.edges[el]}, a.edge0[ek], a.edge1[ek], b.edge0[el],
                        b.edge1[el]);
            }
        }
    }

    void add(const FeaturePair& f, const Box& a0, const Box& a1, const Box& b0, const Box& b1) {
        double entry = 0;
        ++scratch_.counters.box_tests;
        if (!moving_boxes_overlap(a0, a1, b0, b1, inflation_, entry, best_.toi)) return;
        const CcdKind kind = ccd_kind(f.kind);
        auto& batch = scratch_.batch_[static_cast<std::size_t>(kind)];
        batch.queries.push_back(ccd_query(a_, b_, f));
        batch.features.push_back(f);
        batch.entry.push_back(entry);
        if (batch.queries.size() == kBatch) flush(kind);
    }

    void flush(CcdKind kind) {
        auto& batch = scratch_.batch_[static_cast<std::size_t>(kind)];
        batch.results.resize(batch.queries.size());
        scratch_.counters.feature_queries += static_cast<std::int64_t>(batch.queries.size());
        ccd_batch(kind, batch.queries, {separation_, CcdStart::relaxed}, batch.results, isa_);
        for (std::size_t i = 0; i < batch.results.size(); ++i)
            if (batch.results[i].hit) offer(batch.features[i], batch.results[i], batch.entry[i]);
        batch.queries.clear();
        batch.features.clear();
        batch.entry.clear();
    }

    void offer(const FeaturePair& f, const CcdResult& r, double entry) {
        const double toi = std::max(r.toi, entry);
        if (best_.hit && (toi > best_.toi || (toi == best_.toi && feature_key(f) > feature_key(best_.features))))
            return;
        best_ = {true, toi, f, from_a_to_b(f.kind, r.direction)};
    }

    const BodyMotion &a_, &b_;
    double separation_;
    OutwardInflation inflation_;
    CcdScratch& scratch_;
    Isa isa_ = best_isa();
    PairHit best_;
};

PairHit earliest_hit(const BodyMotion& a, const BodyMotion& b, double separation, CcdScratch& scratch) {
    PairHit best = EarliestHit(a, b, separation, scratch).run();
    if (!best.hit) return best;
    // The direction at the time of impact, from the closest points themselves where they are distinct: the certifying
    // direction of an early stop may be a poor normal.
    const FeaturePoints p = closest_points(a, b, best.features, best.toi);
    if (const Vec3 n = normalized(p.b - p.a); n != Vec3{}) best.normal = n;
    return best;
}

} // namespace flotilla
