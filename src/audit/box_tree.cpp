// SPDX-License-Identifier: MIT
#include "audit/box_tree.hpp"

#include <algorithm>
#include <numeric>

#include "base/index.hpp"
#include "base/vec3.hpp"

namespace flotilla::audit {
namespace {

constexpr std::int32_t kLeafTriangles = 2;

/// Builds the subtree over order[begin, end) and returns nothing: its root is the next node.
void build(BoxTree& tree, std::span<const Vec3> centers, std::int32_t begin, std::int32_t end) {
    const std::size_t self = tree.nodes.size();
    tree.nodes.push_back({-1, begin, end});
    if (end - begin <= kLeafTriangles) return;
    Vec3 low = centers[at(tree.order[at(begin)])], high = low;
    for (std::int32_t i = begin; i < end; ++i) {
        low = min(low, centers[at(tree.order[at(i)])]);
        high = max(high, centers[at(tree.order[at(i)])]);
    }
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::int32_t middle = begin + (end - begin) / 2;
    const auto first = tree.order.begin();
    std::nth_element(first + begin, first + middle, first + end, [&](std::int32_t a, std::int32_t b) {
        const double x = component(centers[at(a)], axis), y = component(centers[at(b)], axis);
        return x != y ? x < y : a < b;
    });
    build(tree, centers, begin, middle);
    tree.nodes[self].right = static_cast<std::int32_t>(tree.nodes.size());
    build(tree, centers, middle, end);
}

} // namespace

Bounds merged(const Bounds& a, const Bounds& b) {
    Bounds c{};
    for (std::size_t k = 0; k < 3; ++k) {
        c.low[k] = std::min(a.low[k], b.low[k]);
        c.high[k] = std::max(a.high[k], b.high[k]);
    }
    return c;
}

Bounds bounds_of(std::span<const Vec3> points) {
    Vec3 low = points[0], high = points[0];
    for (const Vec3& p : points) {
        low = min(low, p);
        high = max(high, p);
    }
    return {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
}

double distance_sq(const Bounds& a, const Bounds& b) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double gap = std::max({0.0, a.low[k] - b.high[k], b.low[k] - a.high[k]});
        sum += gap * gap;
    }
    return sum;
}

BoxTree build_box_tree(const TriangleMesh& mesh) {
    BoxTree tree;
    if (mesh.triangles.empty()) return tree;
    std::vector<Vec3> centers;
    for (const Triangle& t : mesh.triangles)
        centers.push_back(mesh.vertices[at(t[0])] + mesh.vertices[at(t[1])] + mesh.vertices[at(t[2])]);
    tree.order.resize(mesh.triangles.size());
    std::iota(tree.order.begin(), tree.order.end(), 0);
    build(tree, centers, 0, static_cast<std::int32_t>(tree.order.size()));
    return tree;
}

void refit(const BoxTree& tree, std::span<const Triangle> triangles, std::span<const Vec3> vertices,
           std::vector<Bounds>& boxes) {
    boxes.resize(tree.nodes.size());
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        const auto& node = tree.nodes[i];
        if (!node.is_leaf()) {
            boxes[i] = merged(boxes[i + 1], boxes[at(node.right)]);
            continue;
        }
        const auto of_triangle = [&](std::int32_t k) {
            const Triangle& t = triangles[at(tree.order[at(k)])];
            return bounds_of(std::array{vertices[at(t[0])], vertices[at(t[1])], vertices[at(t[2])]});
        };
        boxes[i] = of_triangle(node.begin);
        for (std::int32_t k = node.begin + 1; k < node.end; ++k) boxes[i] = merged(boxes[i], of_triangle(k));
    }
}

} // namespace flotilla::audit
