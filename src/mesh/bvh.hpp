// SPDX-License-Identifier: MIT
// The bounding hierarchy of a shape: a binary tree over its triangles, built once and shared by all instances. Boxes
// are the instance's: one array per time, indexed like the nodes, refitted to the instance's world vertices.
//
// Boxes at t = 0 and at t = 1 lie in separate arrays because they change at different rates: those at t = 0 once per
// step, those at t = 1 whenever the end state does.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/assert.hpp"
#include "base/index.hpp"
#include "base/vec3.hpp"
#include "geometry/box.hpp"
#include "geometry/ccd.hpp"
#include "geometry/coarse_box.hpp"
#include "geometry/moving_box.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// Nodes stand in depth-first order: the left child follows its parent, so every child has a larger index than its
/// parent and a backward loop sees children first. Eight bytes: a traversal reads it together with 48 or 96 bytes of
/// boxes.
struct BvhNode {
    std::int32_t first; ///< leaf: position of its first triangle in Bvh::triangles; inner node: the right child
    std::int32_t count; ///< leaf: number of triangles, > 0; inner node: 0
};
static_assert(sizeof(BvhNode) == 8);

/// No path from the root is longer, whatever the triangles: deeper than half of it the builder halves by count.
inline constexpr int kMaxBvhDepth = 64;

struct Bvh {
    std::vector<BvhNode> nodes;          ///< root first; never empty
    std::vector<std::int32_t> triangles; ///< triangle numbers of the mesh, in leaf order
    std::vector<Triangle> corners;       ///< their vertex indices, in the same order
    /// The vertices of the leaves, each once, in their order; those of a leaf begin at first_vertex of its first
    /// triangle's position and end at that of the position after its last one.
    std::vector<std::int32_t> vertices, first_vertex;
    std::vector<float> sizes; ///< of the nodes' boxes in the mesh's own axes, sum of the edges, m
    int depth = 0;            ///< edges on the longest path from the root, <= kMaxBvhDepth

    [[nodiscard]] bool is_leaf(std::int32_t node) const { return nodes[static_cast<std::size_t>(node)].count > 0; }
    [[nodiscard]] std::span<const std::int32_t> leaf_triangles(const BvhNode& leaf) const {
        return {triangles.data() + leaf.first, static_cast<std::size_t>(leaf.count)};
    }
    [[nodiscard]] std::span<const std::int32_t> leaf_vertices(const BvhNode& leaf) const {
        const std::int32_t first = first_vertex[at(leaf.first)], end = first_vertex[at(leaf.first + leaf.count)];
        return {vertices.data() + first, at(end - first)};
    }
    [[nodiscard]] std::span<const std::int32_t> leaf_triangles(std::int32_t leaf) const {
        return leaf_triangles(nodes[static_cast<std::size_t>(leaf)]);
    }
};

struct BvhOptions {
    /// Triangles per leaf at most, >= 1. One gives the fewest triangle pairs, more give smaller trees. Two took the
    /// least time in the impact of 100 boats.
    int max_leaf_triangles = 2;
};

/// Builds the hierarchy by a binned surface area heuristic; a pure function of the mesh. The mesh must have a triangle.
[[nodiscard]] Bvh build_bvh(const TriangleMesh& mesh, const BvhOptions& options = {});

/// Boxes of all nodes for one set of world vertices: exact minima and maxima. No allocation once `boxes` has its size.
/// Vertices must be finite.
void refit(const Bvh& bvh, std::span<const Vec3> vertices, std::vector<Box>& boxes);

/// Coarse boxes of all nodes from those of the vertices.
void refit(const Bvh& bvh, std::span<const CoarseBox> vertices, std::vector<CoarseBox>& boxes, Isa isa = best_isa());

/// Boxes of all nodes at t = 0 and t = 1.
struct MovingBoxes {
    std::vector<Box> t0, t1;
};
inline void refit(const Bvh& bvh, std::span<const Vec3> vertices_t0, std::span<const Vec3> vertices_t1,
                  MovingBoxes& boxes) {
    refit(bvh, vertices_t0, boxes.t0);
    refit(bvh, vertices_t1, boxes.t1);
}

/// One side of a moving traversal: a hierarchy and its boxes, equal spans for a body at rest.
struct BvhView {
    const Bvh& bvh;
    std::span<const Box> t0, t1;
};
inline BvhView view(const Bvh& bvh, const MovingBoxes& boxes) { return {bvh, boxes.t0, boxes.t1}; }

namespace bvh_detail {

struct NodePair {
    std::int32_t a, b;
    double entry_time;
};

/// Every expansion replaces a pair by at most two and goes down by one in one tree, so no more than depth + depth + 1
/// pairs wait.
class NodePairStack {
  public:
    [[nodiscard]] bool empty() const { return size_ == 0; }
    void push(const NodePair& pair) {
        FLOTILLA_ASSERT(size_ < pairs_.size());
        pairs_[size_++] = pair;
    }
    NodePair pop() { return pairs_[--size_]; }

  private:
    std::array<NodePair, 2 * kMaxBvhDepth + 2> pairs_;
    std::size_t size_ = 0;
};

using flotilla::extent_sum;
inline double extent_sum(const Box& box) {
    const Vec3 e = extent(box);
    return (e.x + e.y) + e.z;
}

/// Whether to open node a rather than b: the larger one, an inner one in any case. At least one must be inner.
template <class AnyBox>
bool open_first(const BvhNode& a, const BvhNode& b, const AnyBox& box_a, const AnyBox& box_b) {
    if (a.count > 0) return false;
    return b.count > 0 || extent_sum(box_a) >= extent_sum(box_b);
}

/// The two pairs that replace a pair.
inline std::array<NodePair, 2> children(const NodePair& p, const BvhNode& a, const BvhNode& b, bool open_a) {
    if (open_a) return {{{p.a + 1, p.b, 0}, {a.first, p.b, 0}}};
    return {{{p.a, p.b + 1, 0}, {p.a, b.first, 0}}};
}

inline double max_abs_coordinate(const BvhView& v) {
    return std::max(flotilla::max_abs_coordinate(v.t0[0]), flotilla::max_abs_coordinate(v.t1[0]));
}

/// Depth first through all node pairs that `test(node_a, node_b, entry_time)` does not rule out, the child that enters
/// first before the other. A pair may have become pointless while it waited: `wanted(entry_time)` is asked when its
/// turn comes. `boxes_a` and `boxes_b` only decide which node to open. Calls leaf(node_a, node_b, entry_time).
template <class AnyBox, class Test, class Wanted, class Leaf>
void traverse(const Bvh& a, const Bvh& b, std::span<const AnyBox> boxes_a, std::span<const AnyBox> boxes_b, Test&& test,
              Wanted&& wanted, Leaf&& leaf) {
    NodePairStack stack;
    NodePair p{0, 0, 0};
    bool live = test(0, 0, p.entry_time);
    for (;;) {
        while (!live || !wanted(p.entry_time)) {
            if (stack.empty()) return;
            p = stack.pop();
            live = true;
        }
        const BvhNode na = a.nodes[at(p.a)], nb = b.nodes[at(p.b)];
        if (na.count > 0 && nb.count > 0) {
            leaf(p.a, p.b, p.entry_time);
            live = false;
            continue;
        }
        auto [near, far] = children(p, na, nb, open_first(na, nb, boxes_a[at(p.a)], boxes_b[at(p.b)]));
        const bool keep_near = test(near.a, near.b, near.entry_time), keep_far = test(far.a, far.b, far.entry_time);
        if (keep_near && keep_far) {
            if (far.entry_time < near.entry_time) std::swap(near, far);
            stack.push(far);
        }
        p = keep_near ? near : far;
        live = keep_near || keep_far;
    }
}

} // namespace bvh_detail

/// Calls callback(triangles_a, triangles_b, entry_time) for every pair of leaves whose moving boxes come within
/// `inflation` (m) of each other at some t in [0, 1]; both triangle lists are spans of std::int32_t. Conservative: two
/// triangles, one from each body, that come within `inflation` along their linear paths are in some pair of lists.
/// entry_time is a lower bound of the first time they do. The order of calls is a pure function of the boxes. No
/// allocation.
template <class Callback>
void for_each_overlapping_leaf_pair(const BvhView& a, const BvhView& b, double inflation, Callback&& callback) {
    const OutwardInflation outward(inflation,
                                   std::max(bvh_detail::max_abs_coordinate(a), bvh_detail::max_abs_coordinate(b)));
    bvh_detail::traverse(
        a.bvh, b.bvh, a.t1, b.t1,
        [&](std::int32_t i, std::int32_t j, double& entry_time) {
            const auto k = static_cast<std::size_t>(i), l = static_cast<std::size_t>(j);
            return moving_boxes_overlap(a.t0[k], a.t1[k], b.t0[l], b.t1[l], outward, entry_time);
        },
        [](double) { return true; },
        [&](std::int32_t la, std::int32_t lb, double entry_time) {
            callback(a.bvh.leaf_triangles(la), b.bvh.leaf_triangles(lb), entry_time);
        });
}
template <class Callback>
void for_each_overlapping_leaf_pair(const Bvh& bvh_a, const MovingBoxes& boxes_a, const Bvh& bvh_b,
                                    const MovingBoxes& boxes_b, double inflation, Callback&& callback) {
    for_each_overlapping_leaf_pair(view(bvh_a, boxes_a), view(bvh_b, boxes_b), inflation,
                                   std::forward<Callback>(callback));
}

/// Calls callback(triangles_a, triangles_b) for every pair of leaves whose boxes, at rest, come within `inflation` (m)
/// of each other. Conservative as above. No allocation.
template <class Callback>
void for_each_overlapping_leaf_pair(const Bvh& bvh_a, std::span<const Box> boxes_a, const Bvh& bvh_b,
                                    std::span<const Box> boxes_b, double inflation, Callback&& callback) {
    bvh_detail::traverse(
        bvh_a, bvh_b, boxes_a, boxes_b,
        [&](std::int32_t i, std::int32_t j, double&) {
            return boxes_overlap(boxes_a[static_cast<std::size_t>(i)], boxes_b[static_cast<std::size_t>(j)], inflation);
        },
        [](double) { return true; },
        [&](std::int32_t la, std::int32_t lb, double) {
            callback(bvh_a.leaf_triangles(la), bvh_b.leaf_triangles(lb));
        });
}

} // namespace flotilla
