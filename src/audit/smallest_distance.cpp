// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <compare>
#include <limits>
#include <utility>

#include "audit/audit.hpp"
#include "audit/triangle_distance.hpp"
#include "base/index.hpp"
#include "parallel/parallel_for.hpp"

namespace flotilla::audit {
namespace {

/// Bounds and distances compared are rounded differently: what may be nearer by less than that is looked at. Far above
/// the rounding of either side, and what makes the result one of the frame, not of the order in which pairs are looked
/// at.
constexpr double kRoundingRoom = 1 + 0x1p-20;

/// The smallest squared distance found so far, by any thread.
class Best {
  public:
    explicit Best(double distance_sq) : distance_sq_(distance_sq) {}
    [[nodiscard]] bool beaten_by(double bound_sq) const { return bound_sq <= kRoundingRoom * load(); }
    [[nodiscard]] double load() const { return distance_sq_.load(std::memory_order_relaxed); }
    void lower(double distance_sq) {
        double old = load();
        while (distance_sq < old && !distance_sq_.compare_exchange_weak(old, distance_sq, std::memory_order_relaxed)) {
        }
    }

  private:
    std::atomic<double> distance_sq_;
};

/// Branch and bound over two trees.
class PairDistance {
  public:
    PairDistance(const Scene& scene, const Placement& placement, std::size_t a, std::size_t b, Best& best)
        : mesh_a_(scene.shape_of(a)),
          mesh_b_(scene.shape_of(b)),
          boxes_a_(placement.boxes[a]),
          boxes_b_(placement.boxes[b]),
          vertices_a_(placement.vertices[a]),
          vertices_b_(placement.vertices[b]),
          best_(best) {}

    /// Of the triangles that were looked at; infinite where none was.
    double run() {
        descend(0, 0);
        return found_sq_;
    }

  private:
    void descend(std::int32_t i, std::int32_t j) {
        if (!best_.beaten_by(distance_sq(boxes_a_[at(i)], boxes_b_[at(j)]))) return;
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
            for (std::int32_t l = node_b.begin; l < node_b.end; ++l) {
                const Corners b = corners(mesh_b_, vertices_b_, l);
                if (!best_.beaten_by(plane_distance_sq(a, b)) || !best_.beaten_by(plane_distance_sq(b, a))) continue;
                found_sq_ = std::min(found_sq_, closest_points(a, b).distance_sq);
                best_.lower(found_sq_);
            }
        }
    }

    /// How far `b` stays from the plane of `a`: nowhere are the triangles nearer. 0 where it has corners on both sides.
    static double plane_distance_sq(const Corners& a, const Corners& b) {
        const Vec3 n = cross(a[1] - a[0], a[2] - a[0]);
        const double x = dot(n, b[0] - a[0]), y = dot(n, b[1] - a[0]), z = dot(n, b[2] - a[0]);
        const double nearest = std::max(std::min({x, y, z}), -std::max({x, y, z}));
        const double nn = dot(n, n);
        return nearest > 0 && nn > 0 ? nearest * nearest / nn : 0;
    }

    static Corners corners(const Shape& shape, const std::vector<Vec3>& v, std::int32_t position) {
        const Triangle& t = shape.mesh.triangles[at(shape.tree.order[at(position)])];
        return {v[at(t[0])], v[at(t[1])], v[at(t[2])]};
    }

    const Shape &mesh_a_, &mesh_b_;
    const std::vector<Bounds>&boxes_a_, &boxes_b_;
    const std::vector<Vec3>&vertices_a_, &vertices_b_;
    Best& best_;
    double found_sq_ = std::numeric_limits<double>::infinity();
};

/// The placed bodies by the lower ends of their boxes along x.
std::vector<std::size_t> sorted_bodies(const Placement& placement) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < placement.boxes.size(); ++i)
        if (placement.is_placed(i)) order.push_back(i);
    const auto low = [&](std::size_t i) { return placement.boxes[i][0].low[0]; };
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return std::pair(low(a), a) < std::pair(low(b), b); });
    return order;
}

struct Nearest {
    double distance_sq = std::numeric_limits<double>::infinity();
    std::int32_t a = -1, b = -1;
    friend auto operator<=>(const Nearest&, const Nearest&) = default;
};

} // namespace

SmallestDistance smallest_distance(const Scene& scene, const Placement& placement, int threads, double bound) {
    const std::vector<std::size_t> order = sorted_bodies(placement);
    const auto box = [&](std::size_t i) -> const Bounds& { return placement.boxes[i][0]; };
    Best best(bound * bound);
    std::vector<Nearest> nearest(order.size());
    parallel_for(order.size(), threads, [&](std::size_t i) {
        const std::size_t a = order[i];
        for (std::size_t j = i + 1; j < order.size(); ++j) {
            const std::size_t b = order[j];
            const double gap = std::max(0.0, box(b).low[0] - box(a).high[0]);
            if (!best.beaten_by(gap * gap)) break;
            if (scene.bodies[a].infinite_mass && scene.bodies[b].infinite_mass) continue;
            if (!best.beaten_by(distance_sq(box(a), box(b)))) continue;
            if (scene.ignores(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b))) continue;
            // By number: which body comes first is a matter of rounding.
            const auto [first, second] = std::minmax(a, b);
            const double d_sq = PairDistance(scene, placement, first, second, best).run();
            nearest[i] =
                std::min(nearest[i], {d_sq, static_cast<std::int32_t>(first), static_cast<std::int32_t>(second)});
        }
    });
    Nearest found;
    for (const Nearest& n : nearest) found = std::min(found, n);
    const double distance = std::sqrt(found.distance_sq);
    if (!(distance < bound)) return {std::numeric_limits<double>::infinity(), -1, -1};
    return {distance, found.a, found.b};
}

} // namespace flotilla::audit
