// SPDX-License-Identifier: MIT
#include "scene/household_meshes.hpp"

#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <flotilla/scene_library.hpp>
#include <gtest/gtest.h>

#include "base/rotation.hpp"
#include "geometry/box.hpp"
#include "mesh/mass_properties.hpp"
#include "mesh/topology.hpp"
#include "scene/library.hpp"
#include "scene/scene.hpp"

namespace flotilla::library {
namespace {

constexpr double kPi = 3.14159265358979323846;

double volume(const TriangleMesh& mesh) { return solid_mass_properties(mesh, 1, "mesh").mass; }
double area(const TriangleMesh& mesh) { return mesh_statistics(mesh).area; }
/// Of the regular polygon with n corners on a circle of radius r, m^2.
double polygon(double r, int n) { return n * r * r * sin_cos(2 * kPi / n).sin / 2; }
std::vector<OutlinePoint> polygon_outline(double r, int n) {
    std::vector<OutlinePoint> outline;
    for (int i = 0; i < n; ++i) outline.push_back({r * sin_cos(2 * kPi * i / n).cos, r * sin_cos(2 * kPi * i / n).sin});
    return outline;
}
/// Twice the signed volume against the origin: positive where a closed surface faces outwards.
double facing(const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum += dot(mesh.vertices[static_cast<std::size_t>(a)],
                   cross(mesh.vertices[static_cast<std::size_t>(b)], mesh.vertices[static_cast<std::size_t>(c)]));
    return sum;
}

TEST(Revolve, AConeIsClosedAndFacesOutwards) {
    const TriangleMesh cone = revolve({{0, 0}, {2, 0}, {0, 3}}, 7);
    EXPECT_EQ(cone.vertices.size(), 9U);
    EXPECT_EQ(cone.triangles.size(), 14U);
    EXPECT_TRUE(closedness(cone).oriented);
    EXPECT_GT(facing(cone), 0);
    EXPECT_NEAR(volume(cone), polygon(2, 7) * 3 / 3, 1e-14);
}

TEST(Revolve, AnOutlineOffTheAxisIsOpen) {
    const TriangleMesh tube = revolve({{1, 0}, {1, 2}}, 6);
    EXPECT_EQ(mesh_statistics(tube).boundary_edges, 12);
    EXPECT_NEAR(area(tube), 6 * 1 * 2, 1e-14); // a hexagon's side is its radius
}

TEST(Extrude, APrismWithAHoleIsClosedAndFacesOutwards) {
    const TriangleMesh prism = extrude(polygon_outline(2, 8), polygon_outline(1, 8), 0.5);
    EXPECT_EQ(prism.triangles.size(), 64U);
    EXPECT_TRUE(closedness(prism).oriented);
    EXPECT_GT(facing(prism), 0);
    EXPECT_NEAR(volume(prism), (polygon(2, 8) - polygon(1, 8)) * 0.5, 1e-14);
}

TEST(Sweep, AStraightTubeIsAPrism) {
    const TriangleMesh tube = sweep({{0, 0}, {3, 4}, {6, 8}}, 0.1, 6);
    EXPECT_TRUE(closedness(tube).oriented);
    EXPECT_GT(facing(tube), 0);
    EXPECT_NEAR(volume(tube), polygon(0.1, 6) * 10, 1e-14);
}

TEST(Sweep, ABentTubeIsClosed) {
    const TriangleMesh tube = sweep({{0, 0}, {1, 0}, {1.5, 0.5}, {1.5, 2}}, 0.1, 5);
    EXPECT_TRUE(closedness(tube).oriented);
    EXPECT_GT(facing(tube), 0);
}

struct Expected {
    std::int64_t boundary_edges;        // 0: closed
    double least_mass, most_mass, size; // kg, kg, m: of the longest side of the box
};
// A dinner plate weighs 0.6 kg, a mug 0.3, a stool of this size 2.
const std::map<std::string, Expected> kThings{
    {"mug", {20, 0.25, 0.6, 0.126}}, {"bowl", {24, 0.3, 0.7, 0.18}},   {"plate", {24, 0.4, 0.8, 0.26}},
    {"stool", {0, 1, 3, 0.3}},       {"pallet", {0, 0.7, 2, 0.4}},     {"gear", {0, 0.4, 1, 0.18}},
    {"ring", {0, 0.1, 0.4, 0.204}},  {"triangle", {3, 0.1, 0.3, 0.2}},
};

TEST(Household, ThingsAreOpenOrClosedAsMeantWithoutWaste) {
    const SceneDescription scene = make_scene("household");
    std::size_t seen = 0;
    for (const ShapeDescription& shape : scene.shapes) {
        if (shape.mass_kind == MassKind::none) continue;
        ASSERT_TRUE(kThings.contains(shape.name)) << shape.name;
        const Expected& expected = kThings.at(shape.name);
        const MeshStatistics mesh = mesh_statistics({shape.vertices, shape.triangles});
        EXPECT_EQ(mesh.boundary_edges, expected.boundary_edges) << shape.name;
        EXPECT_EQ(mesh.closedness.oriented, expected.boundary_edges == 0) << shape.name;
        EXPECT_EQ(mesh.zero_area_triangles, 0) << shape.name;
        EXPECT_EQ(mesh.duplicate_triangles, 0) << shape.name;
        EXPECT_EQ(mesh.unused_vertices, 0) << shape.name;
        EXPECT_EQ(mesh.misoriented_edges, 0) << shape.name;
        EXPECT_GT(mesh.min_edge, 0.002) << shape.name;
        const Vec3 size = mesh.box.upper - mesh.box.lower;
        EXPECT_NEAR(std::max({size.x, size.y, size.z}), expected.size, 0.01 * expected.size) << shape.name;
        EXPECT_EQ(shape.mass_kind, mesh.closedness.closed ? MassKind::density : MassKind::surface_density);
        if (mesh.closedness.closed) {
            EXPECT_GT(facing({shape.vertices, shape.triangles}), 0) << shape.name;
        }
        ++seen;
    }
    EXPECT_EQ(seen, kThings.size());
}

TEST(Household, MassesAreThoseOfSuchThings) {
    const SceneDescription scene = make_scene("household");
    for (const ShapeDescription& shape : scene.shapes) {
        if (shape.mass_kind == MassKind::none) continue;
        const MassProperties mass = *shape_mass_properties(shape);
        EXPECT_GT(mass.mass, kThings.at(shape.name).least_mass) << shape.name;
        EXPECT_LT(mass.mass, kThings.at(shape.name).most_mass) << shape.name;
    }
}

/// The boxes of the parts of a mesh that share no vertex.
std::vector<Box> boxes_of_parts(const TriangleMesh& mesh) {
    std::vector<std::int32_t> part(mesh.vertices.size());
    std::iota(part.begin(), part.end(), 0);
    const auto at = [&](std::int32_t v) -> std::int32_t& { return part[static_cast<std::size_t>(v)]; };
    for (bool changed = true; changed;) {
        changed = false;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::int32_t least = std::min({at(a), at(b), at(c)});
            for (const std::int32_t v : {a, b, c}) changed |= std::exchange(at(v), least) != least;
        }
    }
    std::map<std::int32_t, Box> boxes;
    for (std::size_t i = 0; i < part.size(); ++i) boxes[part[i]] = extended(boxes[part[i]], mesh.vertices[i]);
    std::vector<Box> out;
    for (const auto& [first, box] : boxes) out.push_back(box);
    return out;
}

// Parts that overlapped would count twice in the mass. Those of a stool and of a pallet have boxes that touch at most.
TEST(Household, PartsTouchWithoutOverlapping) {
    constexpr double kRounding = 1e-15; // m
    const std::pair<TriangleMesh, std::size_t> things[] = {{stool_mesh(), 4}, {pallet_mesh(), 11}};
    for (const auto& [mesh, parts] : things) {
        const std::vector<Box> boxes = boxes_of_parts(mesh);
        ASSERT_EQ(boxes.size(), parts);
        for (std::size_t i = 0; i < parts; ++i)
            for (std::size_t k = 0; k < i; ++k) {
                const Vec3 common = min(boxes[i].upper, boxes[k].upper) - max(boxes[i].lower, boxes[k].lower);
                EXPECT_LT(std::min({common.x, common.y, common.z}), kRounding) << k << ' ' << i;
            }
    }
}

// Their volumes, and a centre on the axis.
TEST(Household, MassesOfThingsOfPartsAddUp) {
    EXPECT_NEAR(volume(stool_mesh()), polygon(0.14, 24) * 0.025 + 3 * polygon(0.014, 8) * 0.275, 1e-15);
    EXPECT_NEAR(volume(pallet_mesh()), 8 * 0.4 * 0.048 * 0.012 + 3 * 0.04 * 0.3 * 0.046, 1e-15);
    const MassProperties stool = solid_mass_properties(stool_mesh(), 1, "stool");
    EXPECT_NEAR(stool.center_of_mass.x, 0, 1e-15);
    EXPECT_NEAR(stool.center_of_mass.y, 0, 1e-15);
}

TEST(Household, TheHandlePullsTheMugToItsSide) {
    const MassProperties mug = shell_mass_properties(mug_mesh(), 1, "mug");
    EXPECT_GT(mug.center_of_mass.x, 0.001);
    EXPECT_LT(mug.center_of_mass.x, 0.02);
    EXPECT_NEAR(mug.center_of_mass.y, 0, 1e-15);
}

} // namespace
} // namespace flotilla::library
