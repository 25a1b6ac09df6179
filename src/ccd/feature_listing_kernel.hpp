// SPDX-License-Identifier: MIT
// The traversal behind feature_listing.hpp, written once for every width of the box packs.
#pragma once

#include "ccd/feature_listing.hpp"

namespace flotilla {
namespace {

/// Boxes at both times, or gaps.
template <class B>
struct MovingPack {
    B at0, at1;
};
template <class B>
inline MovingPack<B> merged(const MovingPack<B>& p, const MovingPack<B>& q) {
    return {merged(p.at0, q.at0), merged(p.at1, q.at1)};
}

template <class B>
inline MovingPack<B> load_moving(const CoarseBox* at0, const CoarseBox* at1, std::int32_t i) {
    return {B::load(at0[i]), B::load(at1[i])};
}

template <class B>
class Nearness {
  public:
    explicit Nearness(const ListingReach& reach)
        : reach_{B::all(reach.reach0), B::all(reach.reach1)},
          scale0_(B::all(reach.scale0)),
          margin_(B::all(reach.margin)) {}

    /// What is left of the gaps of a box and a turned one.
    [[nodiscard]] MovingPack<B> excess(const MovingPack<B>& p, const MovingPack<B>& turned_q) const {
        return {((p.at0 + turned_q.at0) - reach_.at0) * scale0_, (p.at1 + turned_q.at1) - reach_.at1};
    }
    [[nodiscard]] bool meet(const MovingPack<B>& p, const MovingPack<B>& turned_q) const {
        const MovingPack<B> e = excess(p, turned_q);
        return !any_greater_twice(e.at0, margin_, e.at1, margin_);
    }
    /// How far the motion must stray.
    [[nodiscard]] float distance(const MovingPack<B>& p, const MovingPack<B>& turned_q) const {
        const MovingPack<B> e = excess(p, turned_q);
        return largest(merged(e.at0, e.at1));
    }

  private:
    MovingPack<B> reach_;
    B scale0_, margin_;
};

template <class B>
inline MovingPack<B> turned(const MovingPack<B>& p) {
    return {turned(p.at0), turned(p.at1)};
}

template <class B>
inline long open_node_pairs_by(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                               ListingStack& stack, NodeIds* leaves, long room) {
    const Nearness<B> near(reach);
    long n = 0;
    int size = stack.size;
    while (size > 0 && n < room) {
        // Several pairs at a time: what a pair leads to is not waited for, as it would be if it were popped next.
        NodeIds opened[kListingBlock];
        int few = size < kListingBlock ? size : kListingBlock;
        if (few > room - n) few = static_cast<int>(room - n);
        size -= few;
        for (int k = 0; k < few; ++k) opened[k] = stack.pairs[size + k];
        for (int k = 0; k < few; ++k) {
            const NodeIds p = opened[k];
            const BvhNode na = a.nodes[p.a], nb = b.nodes[p.b];
            if (na.count > 0 && nb.count > 0) {
                leaves[n++] = p;
                continue;
            }
            const auto offer = [&](NodeIds pair, const MovingPack<B>& box, const MovingPack<B>& turned_box) {
                stack.pairs[size] = pair; // written in any case, kept or not: no branch to be mispredicted
                size += near.meet(box, turned_box) ? 1 : 0;
            };
            if (nb.count > 0 || (na.count == 0 && a.sizes[p.a] >= b.sizes[p.b])) {
                const auto box_b = turned(load_moving<B>(b.nodes0, b.nodes1, p.b));
                offer({na.first, p.b}, load_moving<B>(a.nodes0, a.nodes1, na.first), box_b);
                offer({p.a + 1, p.b}, load_moving<B>(a.nodes0, a.nodes1, p.a + 1), box_b);
            } else {
                const auto box_a = load_moving<B>(a.nodes0, a.nodes1, p.a);
                offer({p.a, nb.first}, box_a, turned(load_moving<B>(b.nodes0, b.nodes1, nb.first)));
                offer({p.a, p.b + 1}, box_a, turned(load_moving<B>(b.nodes0, b.nodes1, p.b + 1)));
            }
        }
    }
    stack.size = size;
    return n;
}

template <class B>
inline long meeting_leaves_by(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                              long count, std::int32_t* out) {
    const B within = B::all(reach);
    long n = 0;
    for (long i = 0; i < count; ++i) {
        const NodeIds p = leaves[i];
        const auto box_a = load_moving<B>(a.nodes0, a.nodes1, p.a),
                   box_b = turned(load_moving<B>(b.nodes0, b.nodes1, p.b));
        out[n] = static_cast<std::int32_t>(i); // written in any case, kept or not: no branch to be mispredicted
        n += any_greater_twice(box_a.at0 + box_b.at0, within, box_a.at1 + box_b.at1, within) ? 0 : 1;
    }
    return n;
}

/// A triangle with the boxes of its corners, its edges and itself.
template <class B>
struct ListedTriangle {
    std::int32_t number;
    const std::int32_t *corners, *edges;
    unsigned owned;
    MovingPack<B> corner[3], edge[3], box;

    /// `position`: in the order of the leaves. Turned boxes are those of body b.
    template <bool kTurned>
    static ListedTriangle load(const ListingArrays& body, std::int32_t position) {
        ListedTriangle t;
        t.number = body.leaf_triangles[position];
        t.corners = body.leaf_corners + 3 * static_cast<long>(position);
        t.edges = body.triangle_edges + 3 * static_cast<long>(t.number);
        t.owned = body.owned[t.number];
        for (int k = 0; k < 3; ++k) {
            const auto p = load_moving<B>(body.features.at0, body.features.at1, t.corners[k]);
            t.corner[k] = kTurned ? turned(p) : p;
        }
        for (int k = 0; k < 3; ++k) t.edge[k] = merged(t.corner[k], t.corner[(k + 1) % 3]);
        t.box = merged(t.edge[0], t.edge[1]);
        return t;
    }
};

template <class B>
class FeatureLister {
  public:
    FeatureLister(const ListingReach& reach, ListedFeature* out) : near_(reach), margin_(reach.margin), out_(out) {}

    [[gnu::always_inline]] void add(const ListedTriangle<B>& a, const ListedTriangle<B>& b) {
        if (!near_.meet(a.box, b.box)) return;
        for (int k = 0; k < 3; ++k) {
            offer(FeatureKind::vertex_face, a.corners[k], b.number, near_.distance(a.corner[k], b.box),
                  a.owned >> k & 1u);
            offer(FeatureKind::face_vertex, a.number, b.corners[k], near_.distance(a.box, b.corner[k]),
                  b.owned >> k & 1u);
        }
        for (int k = 0; k < 3; ++k) {
            if ((a.owned >> (3 + k) & 1u) == 0) continue;
            for (int l = 0; l < 3; ++l)
                offer(FeatureKind::edge_edge, a.edges[k], b.edges[l], near_.distance(a.edge[k], b.edge[l]),
                      b.owned >> (3 + l) & 1u);
        }
    }
    [[nodiscard]] long count() const { return n_; }

  private:
    [[gnu::always_inline]] void offer(FeatureKind kind, std::int32_t a, std::int32_t b, float distance,
                                      unsigned owned) {
        const bool near = !(distance > margin_);
        ListedFeature& f = out_[n_]; // written in any case
        f.ids.a = a;
        f.ids.b = b;
        f.distance = distance;
        f.kind = kind;
        n_ += static_cast<long>(owned & (near ? 1u : 0u));
    }

    Nearness<B> near_;
    float margin_;
    ListedFeature* out_;
    long n_ = 0;
};

/// Of features by their boxes alone, for a third of the work of listing them by distances.
template <class B>
class FeatureSelector {
  public:
    FeatureSelector(float reach, SelectedFeatures& selected) : within_(B::all(reach)), selected_(selected) {}

    [[gnu::always_inline]] void add(const ListedTriangle<B>& a, const ListedTriangle<B>& b) {
        if (!meet(a.box, b.box)) return;
        for (int k = 0; k < 3; ++k) {
            if ((a.owned >> k & 1u) != 0) offer(FeatureKind::vertex_face, a.corners[k], b.number, a.corner[k], b.box);
            if ((b.owned >> k & 1u) != 0) offer(FeatureKind::face_vertex, a.number, b.corners[k], a.box, b.corner[k]);
        }
        for (int k = 0; k < 3; ++k) {
            if ((a.owned >> (3 + k) & 1u) == 0 || !meet(a.edge[k], b.box)) continue;
            for (int l = 0; l < 3; ++l)
                if ((b.owned >> (3 + l) & 1u) != 0)
                    offer(FeatureKind::edge_edge, a.edges[k], b.edges[l], a.edge[k], b.edge[l]);
        }
    }

  private:
    [[nodiscard]] bool meet(const MovingPack<B>& p, const MovingPack<B>& turned_q) const {
        return !any_greater_twice(p.at0 + turned_q.at0, within_, p.at1 + turned_q.at1, within_);
    }
    [[gnu::always_inline]] void offer(FeatureKind kind, std::int32_t a, std::int32_t b, const MovingPack<B>& p,
                                      const MovingPack<B>& turned_q) {
        const auto k = static_cast<int>(kind);
        FeaturePair& f = selected_.out[k][selected_.count[k]]; // written in any case
        f.kind = kind;
        f.a = a;
        f.b = b;
        selected_.count[k] += meet(p, turned_q) ? 1 : 0;
    }

    B within_;
    SelectedFeatures& selected_;
};

/// Calls to.add(triangle of a, triangle of b) for all pairs of triangles of leaf pairs.
template <class B, class Add>
inline void for_each_triangle_pair(const ListingArrays& a, const ListingArrays& b, const NodeIds* leaves, long count,
                                   Add& to) {
    for (long p = 0; p < count; ++p) {
        const BvhNode leaf_a = a.nodes[leaves[p].a], leaf_b = b.nodes[leaves[p].b];
        for (std::int32_t i = 0; i < leaf_a.count; ++i) {
            const auto triangle_a = ListedTriangle<B>::template load<false>(a, leaf_a.first + i);
            for (std::int32_t j = 0; j < leaf_b.count; ++j)
                to.add(triangle_a, ListedTriangle<B>::template load<true>(b, leaf_b.first + j));
        }
    }
}

template <class B>
inline void select_leaf_features_by(const ListingArrays& a, const ListingArrays& b, float reach, const NodeIds* leaves,
                                    long count, SelectedFeatures& selected) {
    FeatureSelector<B> selector(reach, selected);
    for_each_triangle_pair<B>(a, b, leaves, count, selector);
}

template <class B>
inline long list_features_by(const ListingArrays& a, const ListingArrays& b, const ListingReach& reach,
                             const NodeIds* leaves, long count, ListedFeature* out) {
    FeatureLister<B> lister(reach, out);
    for_each_triangle_pair<B>(a, b, leaves, count, lister);
    return lister.count();
}

} // namespace
} // namespace flotilla
