// SPDX-License-Identifier: MIT
// The audit's own bounding hierarchy, kept apart from the solver's so that a mistake there cannot hide here. Plain:
// median splits, boxes refitted from the vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::audit {

/// Exact minima and maxima of coordinates, indexed by axis.
struct Bounds {
    std::array<double, 3> low, high;
};

/// Closed boxes: a common point is enough. NaN counts as overlap.
[[nodiscard]] inline bool overlap(const Bounds& a, const Bounds& b) {
    for (std::size_t k = 0; k < 3; ++k)
        if (a.low[k] > b.high[k] || b.low[k] > a.high[k]) return false;
    return true;
}
[[nodiscard]] Bounds merged(const Bounds& a, const Bounds& b);
[[nodiscard]] Bounds bounds_of(std::span<const Vec3> points);
/// A lower bound of the squared distance of points of one box to points of the other, but for rounding.
[[nodiscard]] double distance_sq(const Bounds& a, const Bounds& b);

struct BoxTree {
    struct Node {
        std::int32_t right = 0;          ///< inner node: its right child; the left one follows the node. Leaf: -1
        std::int32_t begin = 0, end = 0; ///< the triangles below the node, positions in `order`
        [[nodiscard]] bool is_leaf() const { return right < 0; }
    };
    std::vector<Node> nodes; ///< root first, children after their parent; empty for a mesh without triangles
    std::vector<std::int32_t> order;
};

[[nodiscard]] BoxTree build_box_tree(const TriangleMesh& mesh);

/// The box of every node.
void refit(const BoxTree& tree, std::span<const Triangle> triangles, std::span<const Vec3> vertices,
           std::vector<Bounds>& boxes);

} // namespace flotilla::audit
