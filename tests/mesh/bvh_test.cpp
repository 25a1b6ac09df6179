// SPDX-License-Identifier: MIT
#include "mesh/bvh.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "base/rotation.hpp"
#include "geometry/closest.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/primitives.hpp"

namespace flotilla {
namespace {

using Pair = std::pair<std::int32_t, std::int32_t>;

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

std::array<Vec3, 3> corners(const TriangleMesh& mesh, const std::vector<Vec3>& vertices, std::int32_t t) {
    const Triangle& v = mesh.triangles[at(t)];
    return {vertices[at(v[0])], vertices[at(v[1])], vertices[at(v[2])]};
}

TriangleMesh random_soup(std::mt19937_64& rng, int triangles, double size) {
    std::normal_distribution<double> n;
    TriangleMesh mesh;
    for (int t = 0; t < triangles; ++t) {
        const Vec3 c{n(rng), n(rng), n(rng)};
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(c + size * Vec3{n(rng), n(rng), n(rng)});
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

/// Where the vertices of a rigid body stand, rotated by w and moved by p.
std::vector<Vec3> placed(const std::vector<Vec3>& vertices, const Vec3& w, const Vec3& p) {
    const Mat3 r = matrix(rotation_from_vector(w));
    std::vector<Vec3> out;
    for (const Vec3& v : vertices) out.push_back(r * v + p);
    return out;
}

std::vector<Vec3> interpolated(const std::vector<Vec3>& v0, const std::vector<Vec3>& v1, double t) {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < v0.size(); ++i) out.push_back((1 - t) * v0[i] + t * v1[i]);
    return out;
}

TriangleMesh boat() { return read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj"); }

/// Every node but the root has one parent with a lower index, and the leaves hold every triangle once.
void expect_valid(const Bvh& bvh, const TriangleMesh& mesh, int max_leaf) {
    std::vector<int> parents(bvh.nodes.size());
    std::size_t in_leaves = 0;
    for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
        const BvhNode& n = bvh.nodes[i];
        if (n.count > 0) {
            EXPECT_LE(n.count, max_leaf);
            in_leaves += static_cast<std::size_t>(n.count);
            continue;
        }
        ASSERT_GT(at(n.first), i + 1);
        ++parents[i + 1];
        ++parents[at(n.first)];
    }
    EXPECT_EQ(parents[0], 0);
    EXPECT_TRUE(std::all_of(parents.begin() + 1, parents.end(), [](int p) { return p == 1; }));
    EXPECT_EQ(in_leaves, mesh.triangles.size());
    std::vector<std::int32_t> sorted = bvh.triangles;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t t = 0; t < sorted.size(); ++t) EXPECT_EQ(at(sorted[t]), t);
    EXPECT_LE(bvh.depth, kMaxBvhDepth);
}

TEST(Bvh, HoldsEveryTriangleOnce) {
    std::mt19937_64 rng(1);
    for (int max_leaf : {1, 2, 4}) {
        for (const TriangleMesh& mesh : {boat(), make_plate(1, 1), random_soup(rng, 1, 1), random_soup(rng, 500, 0.1)})
            expect_valid(build_bvh(mesh, {max_leaf}), mesh, max_leaf);
    }
}

TEST(Bvh, StaysShallowForTrianglesInOnePlaceAndForGeometricSizes) {
    TriangleMesh same{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
    same.triangles.assign(1000, {0, 1, 2});
    const Bvh bvh = build_bvh(same, {1});
    expect_valid(bvh, same, 1);
    EXPECT_LE(bvh.depth, 11);
    // Each triangle half as far out as the one before: bins cut off one or two at a time.
    TriangleMesh spiral;
    for (int i = 0; i < 1000; ++i) {
        const double s = std::ldexp(1.0, -i);
        for (const Vec3& v : {Vec3{s, 0, 0}, Vec3{s, s, 0}, Vec3{s, 0, s}}) spiral.vertices.push_back(v);
        spiral.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const Bvh deep = build_bvh(spiral, {1});
    expect_valid(deep, spiral, 1);
    EXPECT_GT(deep.depth, 11);
}

TEST(Bvh, RefitGivesExactBoundsOfEveryNode) {
    std::mt19937_64 rng(2);
    std::normal_distribution<double> n;
    const TriangleMesh mesh = boat();
    const Bvh bvh = build_bvh(mesh, {3});
    std::vector<Box> boxes;
    for (int i = 0; i < 5; ++i) {
        const auto v = placed(mesh.vertices, {n(rng), n(rng), n(rng)}, {10 * n(rng), n(rng), n(rng)});
        refit(bvh, v, boxes);
        // Brute force: a node of a depth-first tree covers the triangles of the leaves below it.
        const auto brute = [&](auto&& self, std::size_t node) -> Box {
            const BvhNode& b = bvh.nodes[node];
            Box box;
            if (b.count == 0) return merged(self(self, node + 1), self(self, at(b.first)));
            for (std::int32_t t : bvh.leaf_triangles(b))
                for (const Vec3& p : corners(mesh, v, t)) box = extended(box, p);
            return box;
        };
        for (std::size_t node = 0; node < bvh.nodes.size(); ++node) ASSERT_EQ(boxes[node], brute(brute, node)) << node;
    }
}

struct Instance {
    TriangleMesh mesh;
    Bvh bvh;
    std::vector<Vec3> v0, v1;
    MovingBoxes boxes;

    /// Somewhere near `where`, moving by about `move`.
    Instance(const TriangleMesh& m, std::mt19937_64& rng, const Vec3& where, const Vec3& move, double spin,
             int max_leaf)
        : mesh(m), bvh(build_bvh(m, {max_leaf})) {
        std::normal_distribution<double> n;
        const Vec3 w{n(rng), n(rng), n(rng)}, p = where + 0.5 * Vec3{n(rng), n(rng), n(rng)};
        v0 = placed(mesh.vertices, w, p);
        v1 = placed(mesh.vertices, w + spin * Vec3{n(rng), n(rng), n(rng)},
                    p + move + 0.2 * Vec3{n(rng), n(rng), n(rng)});
        refit(bvh, v0, v1, boxes);
    }
};

/// Entry time of each triangle pair that the traversal reports; fails where one is reported twice.
std::map<Pair, double> reported_pairs(const Instance& a, const Instance& b, double inflation) {
    std::map<Pair, double> pairs;
    for_each_overlapping_leaf_pair(a.bvh, a.boxes, b.bvh, b.boxes, inflation, [&](auto ta, auto tb, double entry) {
        for (std::int32_t i : ta)
            for (std::int32_t j : tb) EXPECT_TRUE(pairs.emplace(Pair{i, j}, entry).second);
    });
    return pairs;
}

TEST(Bvh, MovingTraversalMissesNoPairThatComesNearAndEntersInTime) {
    std::mt19937_64 rng(3);
    std::size_t near_pairs = 0, all_pairs = 0, reported_count = 0;
    for (int trial = 0; trial < 24; ++trial) {
        const double far = trial % 3 == 0 ? 1e6 : 0.0, spin = trial % 2 == 0 ? 0.3 : 3.0,
                     inflation = trial % 4 == 0 ? 0.0 : 0.05;
        const int max_leaf = 1 + trial % 3;
        const Instance a(random_soup(rng, 60, 0.4), rng, {far, 0, 0}, {1, 0, 1}, spin, max_leaf);
        const Instance b(random_soup(rng, 50, 0.4), rng, {far, 0, 0}, {0, 1, 1}, spin, max_leaf);
        const auto reported = reported_pairs(a, b, inflation);
        reported_count += reported.size();
        all_pairs += 60 * 50;
        std::set<Pair> near;
        for (int k = 0; k <= 8; ++k) {
            const double t = k / 8.0;
            const auto va = interpolated(a.v0, a.v1, t), vb = interpolated(b.v0, b.v1, t);
            for (std::int32_t i = 0; i < 60; ++i)
                for (std::int32_t j = 0; j < 50; ++j) {
                    const double d_sq =
                        closest_triangle_triangle(corners(a.mesh, va, i), corners(b.mesh, vb, j)).distance_sq;
                    if (d_sq > inflation * inflation) continue;
                    const auto found = reported.find({i, j});
                    ASSERT_NE(found, reported.end()) << i << ' ' << j << " at " << t;
                    ASSERT_LE(found->second, t + (far > 0 ? 1e-7 : 1e-12));
                    near.insert({i, j});
                }
        }
        near_pairs += near.size();
    }
    EXPECT_GT(near_pairs, 1000u);
    EXPECT_LT(reported_count, all_pairs / 2);
}

TEST(Bvh, StaticTraversalReportsWhatTheMovingOneDoesAtRest) {
    std::mt19937_64 rng(5);
    for (int trial = 0; trial < 10; ++trial) {
        const Instance a(boat(), rng, {}, {}, 0, 1), b(boat(), rng, {}, {}, 0, 1);
        std::set<Pair> at_rest, brute;
        for_each_overlapping_leaf_pair(a.bvh, a.boxes.t0, b.bvh, b.boxes.t0, 0.02, [&](auto ta, auto tb) {
            EXPECT_TRUE(at_rest.insert({ta[0], tb[0]}).second);
        });
        const auto box = [](const Instance& x, std::int32_t t) {
            const auto c = corners(x.mesh, x.v0, t);
            return box_of(c[0], c[1], c[2]);
        };
        for (std::int32_t i = 0; at(i) < a.mesh.triangles.size(); ++i)
            for (std::int32_t j = 0; at(j) < b.mesh.triangles.size(); ++j)
                if (boxes_overlap(box(a, i), box(b, j), 0.02)) brute.insert({i, j});
        EXPECT_EQ(at_rest, brute);
        std::set<Pair> moving;
        for_each_overlapping_leaf_pair({a.bvh, a.boxes.t0, a.boxes.t0}, {b.bvh, b.boxes.t0, b.boxes.t0}, 0.02,
                                       [&](auto ta, auto tb, double entry) {
                                           EXPECT_EQ(entry, 0);
                                           moving.insert({ta[0], tb[0]});
                                       });
        EXPECT_TRUE(std::includes(moving.begin(), moving.end(), brute.begin(), brute.end()));
    }
}

} // namespace
} // namespace flotilla
