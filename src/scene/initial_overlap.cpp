// SPDX-License-Identifier: MIT
#include "scene/initial_overlap.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/ccd.hpp"
#include "geometry/closest.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "mesh/placement.hpp"

namespace flotilla {

namespace {

using Corners = std::array<Vec3, 3>;

// A body where it starts. Boxes of the hierarchy are made when the first neighbour asks for them.
struct Placed {
    const Shape* shape = nullptr;
    bool movable = false;
    Box box;
    std::vector<Vec3> vertices;
    std::vector<Box> boxes;

    [[nodiscard]] Corners corners(std::int32_t triangle) const {
        const Triangle& t = shape->mesh.triangles[static_cast<std::size_t>(triangle)];
        const auto v = [&](std::size_t k) { return vertices[static_cast<std::size_t>(t[k])]; };
        return {v(0), v(1), v(2)};
    }
    [[nodiscard]] std::span<const Box> hierarchy() {
        if (boxes.empty()) refit(shape->bvh, vertices, boxes);
        return boxes;
    }
};

std::vector<Placed> place_all(const Scene& scene) {
    std::vector<Placed> placed(scene.bodies.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        placed[i].shape = &scene.shapes[static_cast<std::size_t>(body.shape)];
        placed[i].movable = body.type == BodyType::dynamic;
        placed[i].vertices = initial_vertices(scene, i);
        for (const Triangle& t : placed[i].shape->mesh.triangles)
            for (const std::int32_t v : t)
                placed[i].box = extended(placed[i].box, placed[i].vertices[static_cast<std::size_t>(v)]);
    }
    return placed;
}

Box box_of(const Corners& t) { return box_of(t[0], t[1], t[2]); }

Vec3 meeting_place(const Box& a, const Box& b) { return 0.5 * max(a.lower, b.lower) + 0.5 * min(a.upper, b.upper); }

BodyOverlap overlap_of(Placed& a, Placed& b) {
    BodyOverlap found;
    // Any pair of triangles lies within the two bodies, so this bounds the distances that count.
    const double inflation = least_certified_distance(a.box, b.box);
    for_each_overlapping_leaf_pair(a.shape->bvh, a.hierarchy(), b.shape->bvh, b.hierarchy(), inflation,
                                   [&](std::span<const std::int32_t> of_a, std::span<const std::int32_t> of_b) {
                                       for (const std::int32_t i : of_a)
                                           for (const std::int32_t j : of_b)
                                               if (triangles_overlap(a.corners(i), b.corners(j)))
                                                   found.triangles.push_back({i, j});
                                   });
    std::sort(found.triangles.begin(), found.triangles.end());
    if (!found.triangles.empty())
        found.place = meeting_place(box_of(a.corners(found.triangles[0][0])), box_of(b.corners(found.triangles[0][1])));
    return found;
}

// The axis along which the bodies are spread widest: sweeping along it leaves the fewest pairs to look at.
int widest_axis(const std::vector<Placed>& placed) {
    Vec3 sum, squares;
    for (const Placed& p : placed) {
        const Vec3 c = center(p.box);
        sum += c;
        squares += {c.x * c.x, c.y * c.y, c.z * c.z};
    }
    const double n = static_cast<double>(placed.size());
    const Vec3 variance{squares.x / n - (sum.x / n) * (sum.x / n), squares.y / n - (sum.y / n) * (sum.y / n),
                        squares.z / n - (sum.z / n) * (sum.z / n)};
    if (variance.x >= variance.y && variance.x >= variance.z) return 0;
    return variance.y >= variance.z ? 1 : 2;
}

// Calls visit(a, b), a < b, for every pair of bodies whose boxes come within rounding of each other.
template <class Visit>
void for_each_box_pair(const std::vector<Placed>& placed, Visit&& visit) {
    const int axis = widest_axis(placed);
    const auto low = [&](std::size_t i) { return component(placed[i].box.lower, axis); };
    std::vector<std::size_t> order(placed.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return low(i) != low(j) ? low(i) < low(j) : i < j; });
    double inflation = 0;
    for (const Placed& p : placed) inflation = std::max(inflation, ccd_floor(2 * max_abs_coordinate(p.box)));

    std::vector<std::size_t> open; // bodies whose interval along the axis has not ended yet
    for (const std::size_t i : order) {
        std::erase_if(open, [&](std::size_t j) { return component(placed[j].box.upper, axis) < low(i) - inflation; });
        for (const std::size_t j : open)
            if (boxes_overlap(placed[i].box, placed[j].box, inflation)) visit(std::min(i, j), std::max(i, j));
        open.push_back(i);
    }
}

} // namespace

double least_certified_distance(const Box& a, const Box& b) {
    const Box both = merged(a, b);
    return ccd_floor(max_component(extent(both)));
}

bool triangles_overlap(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
    if (exact::triangles_intersect(a, b)) return true;
    const double floor = least_certified_distance(box_of(a), box_of(b));
    if (!boxes_overlap(box_of(a), box_of(b), floor)) return false;
    return !(closest_triangle_triangle(a, b).distance_sq > floor * floor);
}

std::vector<Vec3> initial_vertices(const Scene& scene, std::size_t body) {
    const BodyDescription& b = scene.bodies[body];
    const std::vector<Vec3>& local = scene.shapes[static_cast<std::size_t>(b.shape)].mesh.vertices;
    std::vector<Vec3> world(local.size());
    world_vertices(local, b.position, b.rotation, world);
    return world;
}

InitialOverlaps find_initial_overlaps(const Scene& scene) {
    std::vector<Placed> placed = place_all(scene);
    InitialOverlaps overlaps;
    for_each_box_pair(placed, [&](std::size_t a, std::size_t b) {
        if (scene.filtered.ignores(a, b)) return;
        BodyOverlap found = overlap_of(placed[a], placed[b]);
        if (found.triangles.empty()) return;
        found.a = static_cast<std::int32_t>(a);
        found.b = static_cast<std::int32_t>(b);
        (placed[a].movable || placed[b].movable ? overlaps.movable : overlaps.fixed).push_back(std::move(found));
    });
    const auto by_bodies = [](const BodyOverlap& x, const BodyOverlap& y) {
        return x.a != y.a ? x.a < y.a : x.b < y.b;
    };
    std::sort(overlaps.movable.begin(), overlaps.movable.end(), by_bodies);
    std::sort(overlaps.fixed.begin(), overlaps.fixed.end(), by_bodies);
    return overlaps;
}

} // namespace flotilla
