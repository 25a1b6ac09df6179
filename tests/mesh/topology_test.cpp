// SPDX-License-Identifier: MIT
#include "mesh/topology.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "base/rotation.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/primitives.hpp"

namespace flotilla {
namespace {

TriangleMesh boat() { return read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj"); }

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

void expect_consistent(const TriangleMesh& mesh) {
    const Topology t = build_topology(mesh);
    std::set<Edge> brute;
    for (const Triangle& v : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            brute.insert(std::minmax(v[k], v[(k + 1) % 3]).first == v[k] ? Edge{v[k], v[(k + 1) % 3]}
                                                                         : Edge{v[(k + 1) % 3], v[k]});
    EXPECT_EQ(t.edges, std::vector<Edge>(brute.begin(), brute.end()));
    std::map<std::int32_t, int> vertex_owners, edge_owners;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (int k = 0; k < 3; ++k) {
            const std::int32_t v = mesh.triangles[i][at(k)], w = mesh.triangles[i][at((k + 1) % 3)],
                               e = t.triangle_edges[i][at(k)];
            EXPECT_EQ(t.edges[at(e)], (Edge{std::min(v, w), std::max(v, w)}));
            if (owns_corner(t.owned[i], k)) {
                ++vertex_owners[v];
                EXPECT_EQ(at(t.vertex_owner[at(v)]), i);
            }
            if (owns_edge(t.owned[i], k)) {
                ++edge_owners[e];
                EXPECT_EQ(at(t.edge_owner[at(e)]), i);
            }
        }
    EXPECT_EQ(edge_owners.size(), t.edges.size());
    for (const auto& [e, n] : edge_owners) EXPECT_EQ(n, 1) << e;
    for (const auto& [v, n] : vertex_owners) EXPECT_EQ(n, 1) << v;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        EXPECT_EQ(vertex_owners.count(static_cast<std::int32_t>(v)) == 1, t.vertex_owner[v] >= 0);
}

TEST(Topology, EveryFeatureHasExactlyOneOwner) {
    expect_consistent(boat());
    expect_consistent(make_sphere(1, 2));
    expect_consistent(
        {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}}, {{0, 1, 2}, {2, 1, 0}, {0, 1, 1}, {2, 2, 2}, {0, 1, 0}}});
}

TEST(Topology, TrianglesAroundAVertexAreThoseWithACornerAtItsPosition) {
    TriangleMesh soup = make_box(1, 2, 3);
    soup.triangles.push_back({0, 0, 1});
    soup.vertices.push_back(soup.vertices[0]);
    soup.triangles.push_back({static_cast<std::int32_t>(soup.vertices.size()) - 1, 1, 2});
    for (const TriangleMesh& mesh : {soup, boat(), TriangleMesh{}}) {
        const Topology t = build_topology(mesh);
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
            std::vector<std::int32_t> due;
            for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
                if (std::any_of(mesh.triangles[i].begin(), mesh.triangles[i].end(),
                                [&](std::int32_t k) { return mesh.vertices[at(k)] == mesh.vertices[v]; }))
                    due.push_back(static_cast<std::int32_t>(i));
            const auto around = t.around_vertex(static_cast<std::int32_t>(v));
            EXPECT_EQ(std::vector<std::int32_t>(around.begin(), around.end()), due);
        }
    }
}

std::int64_t salient(const std::vector<std::uint8_t>& features) {
    return std::count(features.begin(), features.end(), 1);
}

TEST(Topology, WhatLiesWithinAFlatFaceIsNotSalientNorIsACopy) {
    for (const int n : {1, 2, 5}) {
        const TriangleMesh box = make_box(1, 2, 3, n);
        TriangleMesh soup; // every triangle with vertices of its own
        for (const Triangle& t : box.triangles) {
            const auto first = static_cast<std::int32_t>(soup.vertices.size());
            for (const std::int32_t v : t) soup.vertices.push_back(box.vertices[at(v)]);
            soup.triangles.push_back({first, first + 1, first + 2});
        }
        for (const TriangleMesh& mesh : {box, soup}) {
            const Topology t = build_topology(mesh);
            EXPECT_EQ(salient(t.salient_vertex), 8 + 12 * (n - 1));
            EXPECT_EQ(salient(t.salient_edge), 12 * n);
        }
    }
    const Topology plate = build_topology(make_plate(2, 1, 4, 3));
    EXPECT_EQ(salient(plate.salient_vertex), 14);
    EXPECT_EQ(salient(plate.salient_edge), 14);
    const TriangleMesh ball = make_sphere(1, 3);
    const Topology round = build_topology(ball);
    EXPECT_EQ(salient(round.salient_vertex), static_cast<std::int64_t>(ball.vertices.size()));
    EXPECT_EQ(salient(round.salient_edge), static_cast<std::int64_t>(round.edges.size()));
}

TEST(Topology, AFoldABendAndASeamOfThreeAreSalient) {
    const auto edge_of = [](const Vec3& other, std::vector<Triangle> more = {}) { // along x
        TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, other, {0.5, 0, 1}}, {{0, 1, 2}, {1, 0, 3}}};
        mesh.triangles.insert(mesh.triangles.end(), more.begin(), more.end());
        const Topology t = build_topology(mesh);
        const auto edge = std::find(t.edges.begin(), t.edges.end(), Edge{0, 1});
        return t.salient_edge[static_cast<std::size_t>(edge - t.edges.begin())];
    };
    EXPECT_EQ(edge_of({0.3, -1, 0}), 0);
    EXPECT_EQ(edge_of({0.3, -1, 1e-8}), 0);
    EXPECT_EQ(edge_of({0.3, -1, 1e-6}), 1);
    EXPECT_EQ(edge_of({0.3, 1, 0}), 1); // folded
    EXPECT_EQ(edge_of({0.3, -1, 0}, {{0, 1, 4}}), 1);
    EXPECT_EQ(edge_of({0.3, 0, 0}), 1); // no area
}

TEST(Topology, ManySmallBendsAreNoFlatFace) {
    constexpr int kStrips = 1000; // each bent by 1e-8 rad
    TriangleMesh arch;
    for (int i = 0; i <= kStrips; ++i)
        for (const double y : {0.0, 1.0}) {
            const double x = static_cast<double>(i) / kStrips;
            arch.vertices.push_back({x, y, -0.5 * 1e-5 * x * x});
        }
    for (std::int32_t i = 0; i < 2 * kStrips; i += 2) {
        arch.triangles.push_back({i, i + 2, i + 3});
        arch.triangles.push_back({i, i + 3, i + 1});
    }
    const Topology t = build_topology(arch);
    const auto rim = 2 * (kStrips + 1);
    EXPECT_GT(salient(t.salient_edge), rim + 5); // the outline, and edges across
    EXPECT_LT(salient(t.salient_edge), rim + 100);
}

// A ridge of 90 degrees with a needle along it, as stitched T-junctions have: in any orientation it stays one.
TEST(Topology, ANeedleHidesNoRidge) {
    for (int k = 0; k < 60; ++k) {
        const Quat turn = rotation_from_vector({0.3 * std::sin(k), 0.2 * std::cos(3 * k), 0.11 * k});
        const auto turned = [&](const Vec3& x) { return rotate(turn, x); };
        const Vec3 p = turned({-1, 0.1, 0.2}), q = turned({1, 0.1, 0.2}), middle = p + 0.37 * (q - p);
        const TriangleMesh mesh{{p, q, middle, turned({0, 1, 0.2}), turned({0, 0.1, -1})},
                                {{0, 1, 2}, {0, 1, 3}, {0, 2, 4}, {2, 1, 4}}};
        const Topology t = build_topology(mesh);
        int along = 0;
        for (std::size_t e = 0; e < t.edges.size(); ++e) {
            const Edge& ends = t.edges[e];
            along += ends[1] <= 2 && t.salient_edge[e] != 0 ? 1 : 0;
        }
        EXPECT_GE(along, 1) << k;
        EXPECT_EQ(t.salient_vertex[0] + t.salient_vertex[1], 2);
    }
}

TEST(Topology, PointsAloneAreSalient) {
    const TriangleMesh points{{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                              {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}};
    EXPECT_EQ(build_topology(points).salient_vertex, (std::vector<std::uint8_t>{1, 1, 0, 1}));
}

TEST(Topology, CountsOfClosedSurfacesObeyEuler) {
    EXPECT_EQ(build_topology(make_box(1, 1, 1, 3)).edges.size(), 9u * 2 * 6 * 3 / 2);
    for (const auto& [mesh, euler] : {std::pair{make_box(1, 2, 3, 4), 2},
                                      {make_sphere(1, 3), 2},
                                      {make_cylinder(1, 2, 9, 4), 2},
                                      {make_ring(2, 1, 7, 5), 0}}) {
        const MeshStatistics s = mesh_statistics(mesh);
        EXPECT_EQ(s.vertices - s.edges + s.triangles, euler);
        EXPECT_EQ(s.boundary_edges + s.non_manifold_edges + s.misoriented_edges, 0);
        EXPECT_EQ(s.unused_vertices + s.zero_area_triangles + s.duplicate_triangles, 0);
        EXPECT_TRUE(s.closedness.oriented);
    }
}

TEST(Topology, ClosednessSeesHolesFlipsAndDegenerateTriangles) {
    EXPECT_FALSE(closedness(make_plate(1, 1)).closed);
    EXPECT_FALSE(closedness(make_tube(1, 1, 8)).closed);
    EXPECT_FALSE(closedness(boat()).closed);
    TriangleMesh box = make_box(1, 1, 1);
    EXPECT_TRUE(closedness(box).oriented);
    std::swap(box.triangles[3][0], box.triangles[3][1]);
    EXPECT_TRUE(closedness(box).closed);
    EXPECT_FALSE(closedness(box).oriented);
    std::swap(box.triangles[3][0], box.triangles[3][1]);
    box.triangles.push_back({0, 1, 1}); // a repeated corner and a stray needle change nothing
    box.vertices.insert(box.vertices.end(), {{4, 4, 4}, {5, 5, 5}, {6, 6, 6}});
    box.triangles.push_back({8, 9, 10});
    EXPECT_TRUE(closedness(box).oriented);
    EXPECT_EQ(mesh_statistics(box).zero_area_triangles, 2);
    box.triangles.erase(box.triangles.begin());
    EXPECT_FALSE(closedness(box).closed);
}

TEST(Topology, AZeroAreaTriangleMayFillATJunction) {
    // A tetrahedron one of whose edges has a point in the middle on one side only.
    const TriangleMesh m{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}},
                         {{0, 2, 4}, {4, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 4, 1}}};
    EXPECT_TRUE(closedness(m).oriented);
    TriangleMesh open = m;
    open.triangles.pop_back();
    EXPECT_FALSE(closedness(open).closed);
}

TEST(Topology, TwoClosedShapesThatShareAnEdgeAreClosed) {
    TriangleMesh m = make_box(1, 1, 1);
    const TriangleMesh other = make_box(1, 1, 1);
    for (const Vec3& v : other.vertices) m.vertices.push_back({v.x + 1, v.y + 1, v.z});
    for (const Triangle& t : other.triangles) m.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    EXPECT_TRUE(closedness(m).oriented);
    EXPECT_EQ(mesh_statistics(m).non_manifold_edges, 1);
}

TEST(Topology, MergingKeepsTheFirstOfEqualVerticesAndTakesZerosAsEqual) {
    const TriangleMesh m{{{1, 0, 0}, {0, 0, 0}, {1, -0.0, 0}, {0, 1, 0}, {-0.0, 0, 0}}, {{0, 1, 3}, {2, 4, 3}}};
    const TriangleMesh merged = merge_equal_vertices(m);
    EXPECT_EQ(merged.vertices, (std::vector<Vec3>{{1, 0, 0}, {0, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(merged.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}}));
}

TEST(Topology, StatisticsOfAPlate) {
    const MeshStatistics s = mesh_statistics(make_plate(3, 2, 3, 2));
    EXPECT_EQ(s.vertices, 12);
    EXPECT_EQ(s.triangles, 12);
    EXPECT_EQ(s.boundary_edges, 10);
    EXPECT_EQ(s.area, 6);
    EXPECT_EQ(s.min_edge, 1);
    EXPECT_EQ(s.max_edge, std::sqrt(2.0));
    EXPECT_EQ(extent(s.box), (Vec3{3, 2, 0}));
    EXPECT_FALSE(s.closedness.closed);
}

TEST(BoundingSphere, HoldsAllUsedVerticesAndIsNearlySmallest) {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> n;
    EXPECT_NEAR(bounding_sphere(make_sphere(2, 3)).radius, 2, 0.02);
    EXPECT_NEAR(bounding_sphere(make_box(3, 4, 12)).radius, 6.5, 0.065);
    EXPECT_NEAR(bounding_sphere(make_plate(3, 4)).radius, 2.5, 0.025);
    // A regular tetrahedron and an equilateral triangle, where the box's centre is a poor start.
    EXPECT_NEAR(bounding_sphere({{{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}, {1, 2, 3}}}).radius,
                std::sqrt(0.75), 0.01);
    EXPECT_NEAR(bounding_sphere({{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}}, {{0, 1, 2}}}).radius,
                std::sqrt(1.0 / 3), 0.006);
    for (int i = 0; i < 50; ++i) {
        TriangleMesh m;
        for (int k = 0; k < 30; ++k) m.vertices.push_back({1e3 + n(rng), n(rng), n(rng)});
        for (std::int32_t t = 0; t < 9; ++t) m.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        m.vertices[29] = {1e6, 0, 0}; // used by no triangle
        const BoundingSphere s = bounding_sphere(m);
        for (std::size_t v = 0; v < 27; ++v) EXPECT_LE(length(m.vertices[v] - s.center), s.radius);
        EXPECT_LT(s.radius, 8);
        EXPECT_GE(bounding_radius(m, m.vertices[0]), s.radius * 0.999);
    }
    EXPECT_GE(bounding_radius(make_sphere(1, 0), {}), 1);
    EXPECT_LE(bounding_radius(make_sphere(1, 0), {}), 1 + 1e-14);
}

} // namespace
} // namespace flotilla
