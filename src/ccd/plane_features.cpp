// SPDX-License-Identifier: MIT
//
// Which features are in a slice looks random to the processor: loops write what they look at to the next place in any
// case and move on where it counts, without a branch.
#include "ccd/plane_features.hpp"

#include <algorithm>
#include <limits>

#include "base/index.hpp"
#include "geometry/rounding.hpp"

namespace flotilla {
namespace {

/// With more, a list that lasts costs less than going through all of them.
constexpr std::size_t kFewVertices = 64;
/// Of the smaller radius: bodies that overlap by more have thick slices.
constexpr double kMostOverlap = 0.25;

constexpr float kNowhere = std::numeric_limits<float>::infinity();
/// The neutral element of merged(), which comes within no distance of any box.
constexpr CoarseBox kNoBox{{kNowhere, kNowhere, kNowhere, kNowhere}, {kNowhere, kNowhere, kNowhere, kNowhere}};

enum Part : std::uint8_t { vertices, edges, faces };

template <class T>
void make_room(std::vector<T>& v, std::size_t size) {
    if (v.size() < size) v.resize(size);
}

/// Sets heights of vertices along d and returns the greatest.
double set_heights(std::span<const Vec3> x, const Vec3& d, std::vector<double>& out) {
    make_room(out, x.size());
    double* const heights = out.data();
    double top = -std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < x.size(); ++v) {
        heights[v] = dot(d, x[v]);
        top = std::max(top, heights[v]);
    }
    return top;
}

/// Slices of bodies that move (kMoves) or rest at t = 0.
template <bool kMoves>
class Slicer {
  public:
    Slicer(const BodyMotion& body, const Vec3& up, BodySlice& slice)
        : shape_(*body.shape), at0_(body.at0), at1_(body.at1), slice_(slice) {
        top_[0] = set_heights(at0_.x, up, slice.heights[0]);
        if constexpr (kMoves) top_[1] = set_heights(at1_.x, up, slice.heights[1]);
    }

    [[nodiscard]] double top(int time) const { return top_[time]; }

    /// Cuts the edges: what counts is above these levels.
    void cut_at(const double (&levels)[2]) {
        level_[0] = levels[0], level_[1] = levels[1];
        h0_ = slice_.heights[0].data(), h1_ = slice_.heights[1].data();
        const std::span<const Edge> all = shape_.topology.edges;
        make_room(slice_.edges, all.size());
        make_room(slice_.above, all.size());
        std::int32_t* const above = slice_.above.data();
        MovingCoarseBox* const cut = slice_.edges.data();
        std::size_t count = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            above[count] = static_cast<std::int32_t>(i);
            count += is_above(all[i][0]) | is_above(all[i][1]) ? 1u : 0u;
            cut[i] = no_box();
        }
        slice_.count = count;
        slice_.box = no_box();
        for (const std::int32_t i : std::span(above, count)) {
            cut[i] = part_above(all[at(i)]);
            slice_.box = joined(slice_.box, cut[i]);
        }
    }

    /// Lists the features that meet the other slice.
    void list_parts(const MovingCoarseBox& other, const CoarseReach& reach) {
        const Topology& topology = shape_.topology;
        const MovingCoarseBox* const cut = slice_.edges.data();
        list_met(vertices, at0_.x.size(), other, reach, [&](std::size_t v, std::int32_t& vertex, MovingCoarseBox& box) {
            vertex = static_cast<std::int32_t>(v);
            box.at0 = at0_.points[v];
            if constexpr (kMoves) box.at1 = at1_.points[v];
            return is_above(vertex) & (topology.vertex_owner[v] >= 0);
        });
        list_met(edges, slice_.count, other, reach, [&](std::size_t i, std::int32_t& edge, MovingCoarseBox& box) {
            edge = slice_.above[i];
            box = cut[edge];
            return true;
        });
        // What of a triangle is above is in the hull of what of its edges is.
        const std::array<std::int32_t, 3>* const sides = topology.triangle_edges.data();
        list_met(faces, topology.triangle_edges.size(), other, reach,
                 [&](std::size_t t, std::int32_t& face, MovingCoarseBox& box) {
                     face = static_cast<std::int32_t>(t);
                     box = joined(joined(cut[sides[t][0]], cut[sides[t][1]]), cut[sides[t][2]]);
                     return true;
                 });
    }

    [[nodiscard]] static bool meet(const MovingCoarseBox& a, const MovingCoarseBox& b, const CoarseReach& reach) {
        float entry = 0;
        if constexpr (kMoves) return coarse_overlap(a, b, reach, reach, entry);
        return coarse_overlap(a.at0, b.at0, reach);
    }

  private:
    /// Where along an edge something is, between 0 and 1.
    struct Stretch {
        double from = 1, to = 0;
    };

    [[nodiscard]] static MovingCoarseBox no_box() { return {kNoBox, kNoBox}; }
    [[nodiscard]] static MovingCoarseBox joined(const MovingCoarseBox& a, const MovingCoarseBox& b) {
        MovingCoarseBox box;
        box.at0 = merged(a.at0, b.at0);
        if constexpr (kMoves) box.at1 = merged(a.at1, b.at1);
        return box;
    }

    [[nodiscard]] bool is_above(std::int32_t v) const {
        if constexpr (kMoves) return (h0_[v] > level_[0]) | (h1_[v] > level_[1]);
        return h0_[v] > level_[0];
    }

    /// Of what of an edge is above, one end being so.
    [[nodiscard]] MovingCoarseBox part_above(const Edge& e) const {
        MovingCoarseBox box;
        if constexpr (kMoves) {
            const Stretch s = stretch(h0_, level_[0], e), t = stretch(h1_, level_[1], e);
            const Stretch both{std::min(s.from, t.from), std::max(s.to, t.to)};
            box.at0 = box_of(at0_, e, both), box.at1 = box_of(at1_, e, both);
        } else {
            // The higher end, and the point where the edge leaves the slice. Where the other end is above as well, even
            // as high, the quotient is negative.
            const bool swap = h0_[e[0]] < h0_[e[1]];
            const std::size_t high = at(e[swap ? 1 : 0]), low = at(e[swap ? 0 : 1]);
            const double share = std::max(0.0, (level_[0] - h0_[low]) / (h0_[high] - h0_[low]));
            box.at0 = merged(at0_.points[high], coarse_box(at0_.x[low] + share * (at0_.x[high] - at0_.x[low])));
        }
        return box;
    }
    [[nodiscard]] static Stretch stretch(const double* heights, double level, const Edge& e) {
        const bool first = heights[e[0]] > level, second = heights[e[1]] > level;
        if (!first && !second) return {};
        const double border = (level - heights[e[0]]) / (heights[e[1]] - heights[e[0]]);
        return {first ? 0 : border, second ? 1 : border};
    }
    [[nodiscard]] static CoarseBox box_of(const BodyPlacement& body, const Edge& e, const Stretch& s) {
        const Vec3 &x = body.x[at(e[0])], way = body.x[at(e[1])] - x;
        return merged(coarse_box(x + s.from * way), coarse_box(x + s.to * way));
    }

    /// Lists those of `count` features that count and meet the other slice. look(i, feature, box) sets feature i and
    /// the box of what of it is in the slice, and says whether it counts.
    template <class Look>
    void list_met(Part which, std::size_t count, const MovingCoarseBox& other, const CoarseReach& reach,
                  const Look& look) {
        BodySlice::Part& part = slice_.parts[which];
        make_room(part.features, count);
        make_room(part.boxes, count);
        std::int32_t* const features = part.features.data();
        MovingCoarseBox* const boxes = part.boxes.data();
        std::size_t n = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const bool counts = look(i, features[n], boxes[n]);
            n += counts && meet(boxes[n], other, reach) ? 1u : 0u;
        }
        part.size = n;
    }

    const RigidShape& shape_;
    const BodyPlacement &at0_, &at1_;
    BodySlice& slice_;
    double top_[2] = {}, level_[2] = {};
    const double *h0_ = nullptr, *h1_ = nullptr;
};

/// Appends the pairs whose boxes meet.
template <bool kMoves>
void pair_up(FeatureKind kind, const BodySlice::Part& a, const BodySlice::Part& b, const CoarseReach& reach,
             SliceScratch& scratch) {
    make_room(scratch.pairs, scratch.size + a.size * b.size);
    for (std::size_t i = 0; i < a.size; ++i)
        for (std::size_t j = 0; j < b.size; ++j) {
            scratch.pairs[scratch.size] = {kind, a.features[i], b.features[j]};
            scratch.size += Slicer<kMoves>::meet(a.boxes[i], b.boxes[j], reach) ? 1u : 0u;
        }
}

template <bool kMoves>
bool slice(const BodyMotion& a, const BodyMotion& b, const Vec3& direction, double distance, SliceScratch& scratch) {
    scratch.size = 0;
    auto& [of_a, of_b] = scratch.slices;
    const double largest = std::max(a.max_abs(), b.max_abs());
    const double room = distance * (1 + kLengthRounding) + place_rounding(largest);
    // What counts of b is below a level: above along -d.
    Slicer<kMoves> slicer_a(a, direction, of_a), slicer_b(b, -direction, of_b);
    constexpr int kTimes = kMoves ? 2 : 1;
    double levels_a[2] = {}, levels_b[2] = {};
    bool apart = true;
    for (int time = 0; time < kTimes; ++time) {
        const double overlap = slicer_a.top(time) + slicer_b.top(time);
        if (overlap > room + kMostOverlap * std::min(a.shape->radius, b.shape->radius)) return false;
        apart = apart && overlap < -room;
        levels_a[time] = -slicer_b.top(time) - room;
        levels_b[time] = -slicer_a.top(time) - room;
    }
    if (apart) return true;
    slicer_a.cut_at(levels_a);
    slicer_b.cut_at(levels_b);
    const CoarseReach reach(distance, largest);
    slicer_a.list_parts(of_b.box, reach);
    slicer_b.list_parts(of_a.box, reach);
    pair_up<kMoves>(FeatureKind::vertex_face, of_a.parts[vertices], of_b.parts[faces], reach, scratch);
    pair_up<kMoves>(FeatureKind::face_vertex, of_a.parts[faces], of_b.parts[vertices], reach, scratch);
    pair_up<kMoves>(FeatureKind::edge_edge, of_a.parts[edges], of_b.parts[edges], reach, scratch);
    return true;
}

} // namespace

bool worth_slicing(const RigidShape& shape) { return shape.convex && shape.mesh.vertices.size() <= kFewVertices; }

bool slice_features(FeatureTest test, const BodyMotion& a, const BodyMotion& b, const Vec3& direction, double distance,
                    SliceScratch& scratch) {
    return test == FeatureTest::swept ? slice<true>(a, b, direction, distance, scratch)
                                      : slice<false>(a, b, direction, distance, scratch);
}

} // namespace flotilla
