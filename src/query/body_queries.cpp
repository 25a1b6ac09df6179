// SPDX-License-Identifier: MIT
#include "query/body_queries.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/index.hpp"
#include "geometry/closest.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "geometry/ray.hpp"
#include "scene/initial_overlap.hpp"

namespace flotilla {
namespace {

using Corners = std::array<Vec3, 3>;

Corners corners(const PlacedShape& body, std::int32_t triangle) {
    const Triangle& t = body.shape->mesh.triangles[at(triangle)];
    return {body.at.x[at(t[0])], body.at.x[at(t[1])], body.at.x[at(t[2])]};
}

/// Calls leaf(node_a, node_b, bound) for pairs of leaves, nearer ones before others where that is known. `bound(box_a,
/// box_b)`: of their distance from below, m; `wanted` says whether a bound is still of interest.
template <class Wanted, class Leaf>
void traverse(const PlacedShape& a, const PlacedShape& b, Wanted&& wanted, Leaf&& leaf) {
    const auto gap = [&](std::int32_t i, std::int32_t j) {
        const Box p = to_box(a.at.nodes[at(i)]), q = to_box(b.at.nodes[at(j)]);
        return length(max(max(p.lower - q.upper, q.lower - p.upper), Vec3{}));
    };
    bvh_detail::traverse(
        a.shape->bvh, b.shape->bvh, a.at.nodes, b.at.nodes,
        [&](std::int32_t i, std::int32_t j, double& bound) { return wanted(bound = gap(i, j)); }, wanted,
        [&](std::int32_t i, std::int32_t j, double) { leaf(i, j); });
}

/// Calls leaf(triangles) for the leaves whose boxes, and those above them, `wanted(box)` wants.
template <class Wanted, class Leaf>
void descend(const PlacedShape& body, Wanted&& wanted, Leaf&& leaf) {
    const Bvh& bvh = body.shape->bvh;
    std::vector<std::int32_t> open{0};
    while (!open.empty()) {
        const std::int32_t node = open.back();
        open.pop_back();
        if (!wanted(to_box(body.at.nodes[at(node)]))) continue;
        if (bvh.is_leaf(node)) {
            leaf(bvh.leaf_triangles(node));
        } else {
            open.push_back(bvh.nodes[at(node)].first);
            open.push_back(node + 1);
        }
    }
}

/// Where a ray enters a box, m; infinite where it misses. From below: coarse boxes are larger than what is in them by
/// more than rounding.
double entry(const Box& box, const Vec3& origin, const Vec3& direction) {
    double first = 0, last = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        const double o = component(origin, k), d = component(direction, k);
        const double low = component(box.lower, k) - o, high = component(box.upper, k) - o;
        if (d == 0) {
            if (low > 0 || high < 0) return std::numeric_limits<double>::infinity();
            continue;
        }
        first = std::max(first, std::min(low / d, high / d));
        last = std::min(last, std::max(low / d, high / d));
    }
    constexpr double kRoom = 1 + 0x1p-40;
    return first <= kRoom * last ? first / kRoom : std::numeric_limits<double>::infinity();
}

bool inside(const Box& box, const Vec3& p) {
    return box.lower.x <= p.x && p.x <= box.upper.x && box.lower.y <= p.y && p.y <= box.upper.y && box.lower.z <= p.z &&
           p.z <= box.upper.z;
}

/// The twelve triangles of a box.
std::array<Corners, 12> faces_of(const Box& box) {
    const auto corner = [&](int k) {
        return Vec3{(k & 1) != 0 ? box.upper.x : box.lower.x, (k & 2) != 0 ? box.upper.y : box.lower.y,
                    (k & 4) != 0 ? box.upper.z : box.lower.z};
    };
    constexpr std::array<std::array<int, 4>, 6> kFaces{
        {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
    std::array<Corners, 12> out;
    for (std::size_t f = 0; f < 6; ++f) {
        const auto& c = kFaces[f];
        out[2 * f] = {corner(c[0]), corner(c[1]), corner(c[2])};
        out[2 * f + 1] = {corner(c[0]), corner(c[2]), corner(c[3])};
    }
    return out;
}

} // namespace

bool bodies_overlap(const PlacedShape& a, const PlacedShape& b) {
    const double reach = least_certified_distance(*a.at.box, *b.at.box);
    if (!boxes_overlap(*a.at.box, *b.at.box, reach)) return false;
    bool found = false;
    traverse(
        a, b, [&](double bound) { return !found && bound <= reach; },
        [&](std::int32_t i, std::int32_t j) {
            for (const std::int32_t s : a.shape->bvh.leaf_triangles(i))
                for (const std::int32_t t : b.shape->bvh.leaf_triangles(j))
                    found = found || triangles_overlap(corners(a, s), corners(b, t));
        });
    return found;
}

bool may_meet_ray(const Box& box, const Vec3& origin, const Vec3& direction, double reach) {
    return entry(to_box(merged(coarse_box(box.lower), coarse_box(box.upper))), origin, direction) <= reach;
}

std::optional<ShapeRayHit> first_on_ray(const PlacedShape& body, const Vec3& origin, const Vec3& direction,
                                        double reach) {
    std::optional<ShapeRayHit> best;
    // Beyond the body nothing is hit: a segment that ends there.
    const double far = std::min(reach, length(origin - center(*body.at.box)) + length(extent(*body.at.box)));
    const Vec3 end = origin + far * direction;
    const auto nearest = [&] { return best ? best->distance : far; };
    descend(
        body, [&](const Box& box) { return entry(box, origin, direction) <= nearest(); },
        [&](std::span<const std::int32_t> triangles) {
            for (const std::int32_t i : triangles) {
                const auto [p, q, r] = corners(body, i);
                const std::optional<double> t = segment_triangle(origin, end, p, q, r);
                if (!t) continue;
                const double distance = *t * far;
                if (best && (distance > best->distance || (distance == best->distance && i > best->triangle))) continue;
                const Vec3 n = cross(q - p, r - p), normal = n / length(n);
                best = {distance, i, dot(normal, direction) > 0 ? -normal : normal};
            }
        });
    return best;
}

ShapeDistance body_distance(const PlacedShape& a, const PlacedShape& b) {
    ShapeDistance best{std::numeric_limits<double>::infinity(), {}, {}, -1, -1};
    traverse(
        a, b, [&](double bound) { return bound <= best.distance; },
        [&](std::int32_t i, std::int32_t j) {
            for (const std::int32_t s : a.shape->bvh.leaf_triangles(i))
                for (const std::int32_t t : b.shape->bvh.leaf_triangles(j)) {
                    const TriangleTriangleClosest c = closest_triangle_triangle(corners(a, s), corners(b, t));
                    const double distance = std::sqrt(c.distance_sq);
                    const bool first = std::pair(s, t) < std::pair(best.triangle_a, best.triangle_b);
                    if (distance < best.distance || (distance == best.distance && first))
                        best = {distance, c.p, c.q, s, t};
                }
        });
    return best;
}

bool meets_box(const PlacedShape& body, const Box& box) {
    if (!boxes_overlap(*body.at.box, box, 0)) return false;
    const std::array<Corners, 12> faces = faces_of(box);
    bool found = false;
    descend(
        body, [&](const Box& node) { return !found && boxes_overlap(node, box, 0); },
        [&](std::span<const std::int32_t> triangles) {
            for (const std::int32_t i : triangles) {
                const Corners t = corners(body, i);
                found = found || inside(box, t[0]) || std::any_of(faces.begin(), faces.end(), [&](const Corners& face) {
                            return exact::triangles_intersect(t, face);
                        });
            }
        });
    return found;
}

} // namespace flotilla
