// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "base/vec3.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/primitives.hpp"

namespace flotilla::baseline {
namespace {

constexpr double kRounding = 1e-12; ///< m, for meshes of a few metres

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

TriangleMesh boat() { return read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj"); }

Vec3 area_vector(const TriangleMesh& mesh, std::int32_t triangle) {
    const Triangle& t = mesh.triangles[at(triangle)];
    return cross(mesh.vertices[at(t[1])] - mesh.vertices[at(t[0])], mesh.vertices[at(t[2])] - mesh.vertices[at(t[0])]) /
           2;
}

void expect_every_triangle_once(const TriangleMesh& mesh, const std::vector<Panel>& panels) {
    std::vector<std::int32_t> found, all(mesh.triangles.size());
    for (const Panel& panel : panels) found.insert(found.end(), panel.triangles.begin(), panel.triangles.end());
    std::sort(found.begin(), found.end());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(found, all);
}

/// Every corner is within half the thickness of the middle plane, and every triangle faces along the normal.
void expect_thin(const TriangleMesh& mesh, const std::vector<Panel>& panels, double thickness) {
    for (const Panel& panel : panels) {
        EXPECT_NEAR(length(panel.normal), 1, kRounding);
        for (const std::int32_t t : panel.triangles) {
            EXPECT_GT(dot(area_vector(mesh, t), panel.normal), 0);
            for (const std::int32_t v : mesh.triangles[at(t)])
                EXPECT_LE(std::abs(dot(panel.normal, mesh.vertices[at(v)]) - (panel.low + panel.high) / 2),
                          thickness / 2 + kRounding);
        }
    }
}

/// The largest distance of corners of one panel, m, by brute force.
double diameter(const TriangleMesh& mesh, const Panel& panel) {
    double out = 0;
    for (const std::int32_t a : panel_vertices(mesh, panel))
        for (const std::int32_t b : panel_vertices(mesh, panel))
            out = std::max(out, length(mesh.vertices[at(a)] - mesh.vertices[at(b)]));
    return out;
}

/// Two cells of three in a plane, shaped like an L.
TriangleMesh corner_plate() {
    return {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}, {0, 2, 0}, {1, 2, 0}},
            {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 4, 7}, {3, 7, 6}}};
}

TEST(Panels, ZeroThicknessLeavesEveryTriangleAlone) {
    const TriangleMesh mesh = make_plate(2, 1, 3, 3);
    const auto panels = merge_into_panels(mesh, {.thickness = 0});
    EXPECT_EQ(panels.size(), mesh.triangles.size());
    expect_every_triangle_once(mesh, panels);
}

TEST(Panels, FlatGridIsOnePanel) {
    for (const int cells : {1, 2, 5, 7}) {
        const TriangleMesh mesh = make_plate(2, 1, cells, 5);
        const auto panels = merge_into_panels(mesh, {.thickness = 1e-3});
        EXPECT_EQ(panels.size(), 1U) << cells;
        expect_every_triangle_once(mesh, panels);
        expect_thin(mesh, panels, 0);
    }
}

TEST(Panels, CubeIsSixPanels) {
    for (const int cells : {1, 3}) {
        const TriangleMesh mesh = make_box(1, 1, 1, cells);
        const auto panels = merge_into_panels(mesh, {.thickness = 0.02});
        EXPECT_EQ(panels.size(), 6U) << cells;
        expect_every_triangle_once(mesh, panels);
        expect_thin(mesh, panels, 0);
    }
}

TEST(Panels, HullThatWouldFillACornerIsCut) {
    const TriangleMesh mesh = corner_plate(); // its hull covers 3.5 where it covers 3
    EXPECT_EQ(merge_into_panels(mesh, {.thickness = 0.02, .overhang = 0.1}).size(), 2U);
    EXPECT_EQ(merge_into_panels(mesh, {.thickness = 0.02, .overhang = 0.2}).size(), 1U);
}

TEST(Panels, OpeningsStayOpen) {
    const TriangleMesh tube =
        make_tube(1, 1, 64); // a strip of 1 m along each flat piece, as wide as the sagitta permits
    const double thickness = 0.01;
    const auto panels = merge_into_panels(tube, {.thickness = thickness});
    expect_every_triangle_once(tube, panels);
    expect_thin(tube, panels, thickness);
    const double half_angle = std::acos(1 - thickness); // sagitta = radius (1 - cos(half the angle))
    EXPECT_GE(static_cast<double>(panels.size()), std::floor(std::numbers::pi / half_angle));
    for (const Panel& panel : panels)
        EXPECT_LE(diameter(tube, panel), std::hypot(1, 2 * std::sin(half_angle)) + kRounding);
}

TEST(Panels, SharpFoldIsCutHoweverThin) {
    // A small triangle folded back on a large one by 170 degrees: one slab and one hull hold both, but they face apart.
    const double c = 0.1 * std::cos(0.17), s = 0.1 * std::sin(0.17);
    const TriangleMesh mesh{{{0, 0, 0}, {0, 1, 0}, {1, 0.5, 0}, {c, 0.5, s}}, {{0, 2, 1}, {0, 1, 3}}};
    EXPECT_EQ(merge_into_panels(mesh, {.thickness = 0.5, .overhang = 1}).size(), 2U);
}

TEST(Panels, TrianglesWithoutAreaAreKept) {
    const TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}};
    expect_every_triangle_once(mesh, merge_into_panels(mesh, {.thickness = 0.1}));
}

TEST(Panels, BoatBecomesFewThinPanels) {
    const TriangleMesh mesh = boat();
    ASSERT_EQ(mesh.triangles.size(), 267U);
    std::size_t before = mesh.triangles.size();
    for (const auto& [thickness, count] : {std::pair(0.005, 119U), {0.01, 80U}, {0.02, 55U}, {0.04, 38U}}) {
        const auto panels = merge_into_panels(mesh, {.thickness = thickness});
        EXPECT_EQ(panels.size(), count) << thickness; // measured
        EXPECT_LT(panels.size(), before);
        expect_every_triangle_once(mesh, panels);
        expect_thin(mesh, panels, thickness);
        before = panels.size();
    }
}

} // namespace
} // namespace flotilla::baseline
