// SPDX-License-Identifier: MIT
// Frames: placing the bodies, and the exact test of every pair of triangles whose boxes overlap.
#include <algorithm>
#include <cmath>

#include "audit/audit.hpp"
#include "audit/candidate_pairs.hpp"
#include "base/index.hpp"
#include "base/rotation.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "mesh/placement.hpp"
#include "parallel/parallel_for.hpp"

namespace flotilla::audit {
namespace {

/// Scene files refuse rotations farther from unit length; a solver's stay within a few ulp.
constexpr double kUnitTolerance = 1e-6;

std::string reason_of_bad_pose(const Pose& pose) {
    const Quat& q = pose.rotation;
    if (!is_finite(pose.position)) return "the position is not finite";
    if (!is_finite({q.x, q.y, q.z}) || !std::isfinite(q.w)) return "the rotation is not finite";
    const double error = std::abs(norm(q) - 1);
    if (error > kUnitTolerance) return "the rotation is off unit length by " + std::to_string(error);
    return "";
}

std::array<Vec3, 3> corners(const Scene& scene, const Placement& placement, std::int32_t body, std::int32_t triangle) {
    const auto& v = placement.vertices[at(body)];
    const Triangle& t = scene.shape_of(at(body)).mesh.triangles[at(triangle)];
    return {v[at(t[0])], v[at(t[1])], v[at(t[2])]};
}

/// The middle of the common part of the triangles' boxes.
Vec3 common_place(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    const Bounds x = bounds_of(a), y = bounds_of(b);
    std::array<double, 3> middle{};
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] = 0.5 * std::max(x.low[k], y.low[k]) + 0.5 * std::min(x.high[k], y.high[k]);
    return {middle[0], middle[1], middle[2]};
}

/// What the test of one body pair found; triangle_pairs == 0: apart.
struct PairResult {
    Intersection intersection;
    std::int64_t tested = 0;
};

class PairCheck {
  public:
    PairCheck(const Scene& scene, const Placement& placement, BodyPair pair)
        : scene_(scene),
          placement_(placement),
          pair_(pair),
          tree_a_(scene.shape_of(at(pair.a)).tree),
          tree_b_(scene.shape_of(at(pair.b)).tree),
          boxes_a_(placement.boxes[at(pair.a)]),
          boxes_b_(placement.boxes[at(pair.b)]) {
        result_.intersection.body_a = pair.a;
        result_.intersection.body_b = pair.b;
    }

    PairResult run() {
        descend(0, 0);
        return result_;
    }

  private:
    void descend(std::int32_t i, std::int32_t j) {
        if (!overlap(boxes_a_[at(i)], boxes_b_[at(j)])) return;
        const auto &node_a = tree_a_.nodes[at(i)], &node_b = tree_b_.nodes[at(j)];
        if (node_a.is_leaf() && node_b.is_leaf()) return test(node_a, node_b);
        if (node_b.is_leaf() || (!node_a.is_leaf() && node_a.end - node_a.begin >= node_b.end - node_b.begin)) {
            descend(i + 1, j);
            descend(node_a.right, j);
        } else {
            descend(i, j + 1);
            descend(i, node_b.right);
        }
    }

    void test(const BoxTree::Node& node_a, const BoxTree::Node& node_b) {
        for (std::int32_t k = node_a.begin; k < node_a.end; ++k)
            for (std::int32_t l = node_b.begin; l < node_b.end; ++l) test(tree_a_.order[at(k)], tree_b_.order[at(l)]);
    }

    void test(std::int32_t triangle_a, std::int32_t triangle_b) {
        ++result_.tested;
        const auto a = corners(scene_, placement_, pair_.a, triangle_a);
        const auto b = corners(scene_, placement_, pair_.b, triangle_b);
        if (!exact::triangles_intersect(a, b)) return;
        Intersection& found = result_.intersection;
        const bool first = found.triangle_pairs++ == 0;
        if (!first && std::pair(triangle_a, triangle_b) > std::pair(found.triangle_a, found.triangle_b)) return;
        found.triangle_a = triangle_a;
        found.triangle_b = triangle_b;
        found.place = common_place(a, b);
    }

    const Scene& scene_;
    const Placement& placement_;
    BodyPair pair_;
    const BoxTree &tree_a_, &tree_b_;
    const std::vector<Bounds>&boxes_a_, &boxes_b_;
    PairResult result_;
};

} // namespace

Shape make_shape(TriangleMesh mesh, const Vec3& center_of_mass) {
    Shape shape;
    double radius_sq = 0;
    for (const Vec3& v : mesh.vertices) radius_sq = std::max(radius_sq, length_sq(v - center_of_mass));
    shape.radius = std::sqrt(radius_sq) * (1 + 1e-9); // rounded up
    shape.tree = build_box_tree(mesh);
    shape.mesh = std::move(mesh);
    shape.center_of_mass = center_of_mass;
    return shape;
}

Placement place(const Scene& scene, std::span<const Pose> poses, int threads) {
    Placement placement;
    placement.poses.assign(poses.begin(), poses.end());
    placement.vertices.resize(poses.size());
    placement.boxes.resize(poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
        if (auto reason = reason_of_bad_pose(poses[i]); poses[i].present && !reason.empty())
            placement.bad.push_back({static_cast<std::int32_t>(i), std::move(reason)});
    parallel_for(poses.size(), threads, [&](std::size_t i) {
        if (!poses[i].present || !reason_of_bad_pose(poses[i]).empty()) return;
        const Shape& shape = scene.shape_of(i);
        placement.vertices[i].resize(shape.mesh.vertices.size());
        world_vertices(shape.mesh.vertices, poses[i].position, poses[i].rotation, placement.vertices[i]);
        refit(shape.tree, shape.mesh.triangles, placement.vertices[i], placement.boxes[i]);
    });
    return placement;
}

StateReport check_state(const Scene& scene, const Placement& placement, int threads) {
    std::vector<std::optional<Bounds>> boxes(scene.bodies.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (placement.is_placed(i)) boxes[i] = placement.boxes[i][0];
    const auto pairs = candidate_pairs(scene, boxes);
    std::vector<PairResult> results(pairs.size());
    parallel_for(pairs.size(), threads,
                 [&](std::size_t i) { results[i] = PairCheck(scene, placement, pairs[i]).run(); });
    StateReport report;
    report.pairs = static_cast<std::int64_t>(pairs.size());
    for (const auto& result : results) {
        report.triangle_pairs += result.tested;
        if (result.intersection.triangle_pairs > 0) report.intersections.push_back(result.intersection);
    }
    return report;
}

} // namespace flotilla::audit
