// SPDX-License-Identifier: MIT
#include "proximity/passing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/closest.hpp"
#include "mesh/primitives.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

constexpr double kRounding = 1e-12;

RigidShape shape_of(const TriangleMesh& mesh) {
    RigidShape shape;
    shape.mesh = mesh;
    shape.topology = build_topology(mesh);
    return shape;
}

RigidShape point() { return shape_of({{{0, 0, 0}}, {point_element(0)}}); }

/// The half plane x > 0, z = 0, near the origin: the edge ahead is that of its first triangle.
TriangleMesh table() { return {{{0, -1, 0}, {0, 1, 0}, {1, 1, 0}, {1, -1, 0}}, {{0, 1, 2}, {0, 2, 3}}}; }

/// A ridge along y at the origin, both sides of which fall off by `slope`.
TriangleMesh roof(double slope) {
    return {{{0, -1, 0}, {0, 1, 0}, {1, 0, -slope}, {-1, 0, -slope}}, {{0, 1, 2}, {1, 0, 3}}};
}

TriangleMesh as_soup(const TriangleMesh& mesh) {
    TriangleMesh soup;
    for (const Triangle& t : mesh.triangles) {
        const auto n = static_cast<std::int32_t>(soup.vertices.size());
        for (const std::int32_t v : t) soup.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
        soup.triangles.push_back({n, n + 1, n + 2});
    }
    return soup;
}

PointGap between(const Vec3& a, const Vec3& b) { return {normalized(b - a), length(b - a)}; }

/// A point at `from` that moves along `way` past the given face of a mesh that stands still at the origin.
PointGap passes(const Vec3& from, const Vec3& way, double radius, const TriangleMesh& mesh, std::int32_t face = 0) {
    const RigidShape a = point(), b = shape_of(mesh);
    const Pose at_a{from, {}, from}, at_b{};
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(face)];
    const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    const Vec3 q = closest_vertex_triangle(from, corner(0), corner(1), corner(2)).point;
    return gap_on_the_way({FeatureKind::vertex_face, 0, face}, {a, at_a}, {b, at_b}, -way, radius, between(from, q));
}

void expect_gap(const PointGap& gap, const Vec3& normal, double distance) {
    EXPECT_NEAR(length(gap.normal - normal), 0, kRounding)
        << gap.normal.x << ' ' << gap.normal.y << ' ' << gap.normal.z;
    EXPECT_NEAR(gap.distance, distance, kRounding);
}

TEST(Passing, AnEdgeAtTheOwnHeightIsPassedAboveIt) {
    expect_gap(passes({-0.01, 0, 0.002}, {0.03, 0, 0}, 0.002, table()), {0, 0, -1}, 0.002);
    expect_gap(passes({-0.01, 0, 0.002}, {0.03, 0.02, 0}, 0.001, table()), {0, 0, -1}, 0.002);
}

TEST(Passing, AWayIntoTheCylinderMeetsItWhereItEnters) {
    const PointGap gap = passes({-0.01, 0, 0.0018}, {0.03, 0, 0}, 0.002, table());
    const Vec3 entry = Vec3{-std::sqrt(0.002 * 0.002 - 0.0018 * 0.0018), 0, 0.0018} / 0.002;
    expect_gap(gap, -entry, dot(entry, Vec3{-0.01, 0, 0.0018}));
    EXPECT_GT(gap.distance, 0.002);
    expect_gap(passes({-0.01, 0, 0}, {0.03, 0, 0}, 0.002, table()), {1, 0, 0}, 0.01);
}

TEST(Passing, AWayThatEndsAheadOfTheEdgeIsJudgedAtItsEnd) {
    const Vec3 end{-0.004, 0, 0.001};
    const PointGap gap = passes({-0.01, 0, 0.001}, {0.006, 0, 0}, 0.0045, table());
    EXPECT_GT(dot(gap.normal, -normalized(end)), 0.99);
    const PointGap now = between({-0.01, 0, 0.001}, {0, 0, 0});
    expect_gap(passes({-0.01, 0, 0.001}, {0.004, 0, 0}, 0.0045, table()), now.normal, now.distance); // allowed
}

TEST(Passing, OneNormalAloneStaysAsItIs) {
    expect_gap(passes({0.5, 0.3, 0.002}, {0.4, 0, -0.01}, 0.001, table()), {0, 0, -1}, 0.002); // above the inside
    expect_gap(passes({0.5, 0, 0.002}, {0.4, 0.1, -0.01}, 0.001, table()), {0, 0, -1}, 0.002); // and the diagonal
    expect_gap(passes({0.5, 0, 0.002}, {0.4, 0.1, -0.01}, 0.001, as_soup(table())), {0, 0, -1}, 0.002);
}

TEST(Passing, WhatPartsStaysAsItIs) {
    const PointGap now = between({-0.01, 0, 0.002}, {0, 0, 0});
    expect_gap(passes({-0.01, 0, 0.002}, {-0.03, 0, 0}, 0.02, table()), now.normal, now.distance);
    expect_gap(passes({-0.01, 0, 0.002}, {-0.03, 0, 0}, 0.002, table()), now.normal, now.distance);
}

TEST(Passing, OverAFlatRidgeTheNormalGoesNoFartherThanThatOfTheNextFace) {
    constexpr double kSlope = 0.05;
    const Vec3 next = normalized(Vec3{kSlope, 0, 1});
    for (const TriangleMesh& mesh : {roof(kSlope), as_soup(roof(kSlope))})
        for (const std::int32_t face : {0, 1}) {
            const PointGap gap = passes({0, 0, 0.01}, {0.02, 0, -0.015}, 0.002, mesh, face);
            expect_gap(gap, -next, 0.01 * next.z);
        }
}

TEST(Passing, TheOtherPartOfTheOwnBodyBoundsTheNormal) {
    // A rod hangs behind its front end, which passes the edge: what would meet it is the rod.
    const Vec3 back{-0.1, 0, -0.05}, front{-0.01, 0, 0.004};
    const RigidShape rod = shape_of({{{0, 0, 0}, back}, {segment_element(0, 1)}}), edge = shape_of(table());
    const Pose at_front{front, {}, front}, at_origin{};
    const PointGap gap = gap_on_the_way({FeatureKind::vertex_face, 0, 0}, {rod, at_front}, {edge, at_origin},
                                        {-0.03, 0, 0}, 0.001, between(front, {0, 0, 0}));
    const Vec3 across = normalized(Vec3{0.05, 0, -0.1}); // of the rod and the edge
    expect_gap(gap, across, dot(across, -front));
}

TEST(Passing, CornersPassEachOtherInSpace) {
    const RigidShape a = point(), b = point();
    const Vec3 from{-0.01, 0.003, 0.004};
    const Pose at_a{from, {}, from}, at_b{};
    const auto gap = [&](const Vec3& way, double radius) {
        return gap_on_the_way({FeatureKind::vertex_face, 0, 0}, {a, at_a}, {b, at_b}, -way, radius,
                              between(from, {0, 0, 0}));
    };
    expect_gap(gap({0.02, 0, 0}, 0.005), Vec3{0, -0.6, -0.8}, 0.005);
}

TEST(Passing, BeyondACornerTheWayGoesOnAlongItsEdge) {
    const TriangleMesh quarter{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    const Vec3 from{-0.003, -0.001, 0.002}, end{0, -0.0005, 0.002};
    for (const TriangleMesh& mesh : {quarter, as_soup(quarter)})
        expect_gap(passes(from, {0.03, 0.0005, 0}, 0.002, mesh), -normalized(end), dot(normalized(end), from));
    // Over the edge and on above the face.
    expect_gap(passes(from, {0.03, 0.01, 0}, 0.0015, quarter), {0, 0, -1}, 0.002);
}

TEST(Passing, BeyondTheEndOfAnEdgeTheNextOneIsMet) {
    // A runner, turned up in front, slides over the edge of a table.
    const RigidShape runner = shape_of(
                         {{{-0.5, 0, 0}, {0, 0, 0}, {0.05, 0, 0.02}}, {segment_element(0, 1), segment_element(1, 2)}}),
                     edge = shape_of(table());
    const Vec3 at{-0.02, 0, 0.002};
    const Pose place{at, {}, at}, origin{};
    const std::vector<Edge>& edges = runner.topology.edges;
    const auto front = static_cast<std::int32_t>(std::find(edges.begin(), edges.end(), Edge{1, 2}) - edges.begin());
    const FeaturePair features{FeatureKind::edge_edge, front, 0};
    ASSERT_EQ(edge.topology.edges[0], (Edge{0, 1}));
    const EdgeEdgeClosest now = closest_edge_edge(at, at + Vec3{0.05, 0, 0.02}, {0, -1, 0}, {0, 1, 0});
    ASSERT_GT(now.s, 0);
    const Vec3 from = now.q - now.p;
    expect_gap(gap_on_the_way(features, {runner, place}, {edge, origin}, {-0.05, 0, 0}, 0.0019,
                              {normalized(from), length(from)}),
               {0, 0, -1}, -from.z);
}

TEST(Passing, AFlatFloorOfManyFacesHasOneNormal) {
    const TriangleMesh floor = make_plate(1, 1, 10, 10);
    for (const TriangleMesh& mesh : {floor, as_soup(floor)})
        for (std::size_t face = 0; face < mesh.triangles.size(); ++face) {
            const Triangle& t = mesh.triangles[face];
            Vec3 above{0, 0, 0.002};
            for (const std::int32_t v : t) above += (1.0 / 3) * mesh.vertices[static_cast<std::size_t>(v)];
            const PointGap gap = passes(above, {0.31, 0.17, -0.0015}, 0.001, mesh, static_cast<std::int32_t>(face));
            const bool leaves = above.x + 0.31 > 0.5 || above.y + 0.17 > 0.5;
            if (!leaves) expect_gap(gap, {0, 0, -1}, 0.002);
        }
}

TEST(Passing, EdgesPassAcrossThemselvesUnlessTheyCross) {
    const RigidShape a = shape_of({{{0, -1, 0}, {0, 1, 0}}, {segment_element(0, 1)}}), b = a,
                     turned = shape_of({{{-1, 0, 0}, {1, 0, 0}}, {segment_element(0, 1)}});
    const Vec3 from{-0.01, 0, 0.002};
    const Pose at_a{from, {}, from}, at_b{};
    const FeaturePair edges{FeatureKind::edge_edge, 0, 0};
    expect_gap(gap_on_the_way(edges, {a, at_a}, {b, at_b}, {-0.03, 0.5, 0}, 0.002, between(from, {0, 0, 0})),
               {0, 0, -1}, 0.002);
    expect_gap(
        gap_on_the_way(edges, {a, at_a}, {turned, at_b}, {-0.03, 0.5, 0.002}, 0.001, between(from, {-0.01, 0, 0})),
        {0, 0, -1}, 0.002);
}

} // namespace
} // namespace flotilla
