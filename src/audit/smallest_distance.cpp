// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "audit/audit.hpp"
#include "audit/triangle_distance.hpp"

namespace flotilla::audit {
namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Branch and bound over two trees; `best_sq` is the squared distance to beat.
class PairDistance {
  public:
    PairDistance(const Scene& scene, const Placement& placement, std::size_t a, std::size_t b, double best_sq)
        : mesh_a_(scene.shape_of(a)),
          mesh_b_(scene.shape_of(b)),
          boxes_a_(placement.boxes[a]),
          boxes_b_(placement.boxes[b]),
          vertices_a_(placement.vertices[a]),
          vertices_b_(placement.vertices[b]),
          best_sq_(best_sq) {}

    double run() {
        descend(0, 0);
        return best_sq_;
    }

  private:
    void descend(std::int32_t i, std::int32_t j) {
        if (distance_sq(boxes_a_[at(i)], boxes_b_[at(j)]) >= best_sq_) return;
        const auto &node_a = mesh_a_.tree.nodes[at(i)], &node_b = mesh_b_.tree.nodes[at(j)];
        if (node_a.is_leaf() && node_b.is_leaf()) return measure(node_a, node_b);
        const bool open_a =
            node_b.is_leaf() || (!node_a.is_leaf() && node_a.end - node_a.begin >= node_b.end - node_b.begin);
        std::array<std::array<std::int32_t, 2>, 2> next{{{i + 1, j}, {node_a.right, j}}};
        if (!open_a) next = {{{i, j + 1}, {i, node_b.right}}};
        const auto bound = [&](const auto& p) { return distance_sq(boxes_a_[at(p[0])], boxes_b_[at(p[1])]); };
        if (bound(next[1]) < bound(next[0])) std::swap(next[0], next[1]); // the nearer first
        for (const auto& p : next) descend(p[0], p[1]);
    }

    void measure(const BoxTree::Node& node_a, const BoxTree::Node& node_b) {
        for (std::int32_t k = node_a.begin; k < node_a.end; ++k) {
            const Corners a = corners(mesh_a_, vertices_a_, k);
            for (std::int32_t l = node_b.begin; l < node_b.end; ++l)
                best_sq_ = std::min(best_sq_, closest_points(a, corners(mesh_b_, vertices_b_, l)).distance_sq);
        }
    }

    static Corners corners(const Shape& shape, const std::vector<Vec3>& v, std::int32_t position) {
        const Triangle& t = shape.mesh.triangles[at(shape.tree.order[at(position)])];
        return {v[at(t[0])], v[at(t[1])], v[at(t[2])]};
    }

    const Shape &mesh_a_, &mesh_b_;
    const std::vector<Bounds>&boxes_a_, &boxes_b_;
    const std::vector<Vec3>&vertices_a_, &vertices_b_;
    double best_sq_;
};

} // namespace

SmallestDistance smallest_distance(const Scene& scene, const Placement& placement) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        if (placement.is_placed(i)) order.push_back(i);
    const auto box = [&](std::size_t i) -> const Bounds& { return placement.boxes[i][0]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return box(a).low[0] != box(b).low[0] ? box(a).low[0] < box(b).low[0] : a < b;
    });
    SmallestDistance best{std::numeric_limits<double>::infinity(), -1, -1};
    double best_sq = best.distance;
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = i + 1; j < order.size(); ++j) {
            const std::size_t a = order[i], b = order[j];
            if (box(b).low[0] - box(a).high[0] > best.distance) break;
            if (scene.bodies[a].infinite_mass && scene.bodies[b].infinite_mass) continue;
            if (distance_sq(box(a), box(b)) >= best_sq) continue;
            const double d_sq = PairDistance(scene, placement, a, b, best_sq).run();
            if (!(d_sq < best_sq)) continue;
            best_sq = d_sq;
            best = {std::sqrt(d_sq), static_cast<std::int32_t>(std::min(a, b)),
                    static_cast<std::int32_t>(std::max(a, b))};
        }
    }
    return best;
}

} // namespace flotilla::audit
