// SPDX-License-Identifier: MIT
#include "primitives.hpp"

#include <gtest/gtest.h>

#include "base/vec3.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::baseline {
namespace {

using Kind = Primitive::Kind;

ShapeDescription shape_of(TriangleMesh mesh) {
    SceneDescription scene;
    scenario::add_shape(scene, std::move(mesh), 1);
    return scene.shapes.front();
}

TEST(Primitives, RecognizesWhatMeshesStandFor) {
    EXPECT_EQ(recognize(shape_of(make_box(1, 2, 3))).kind, Kind::box);
    EXPECT_EQ(recognize(shape_of(make_sphere(0.5, 1))).kind, Kind::sphere);
    EXPECT_EQ(recognize(shape_of(make_cylinder(0.5, 0.6, 512))).kind, Kind::cylinder);
    EXPECT_EQ(recognize(shape_of(make_tube(0.5, 0.6, 64))).kind, Kind::cylinder);
    EXPECT_EQ(recognize(shape_of(make_plate(2, 3))).kind, Kind::plate);
    EXPECT_EQ(recognize(shape_of(scenario::make_octahedron(1))).kind, Kind::convex);
}

TEST(Primitives, TakesNothingElseForASolid) {
    EXPECT_EQ(recognize(shape_of(make_ring(0.5, 0.1, 32, 12))).kind, Kind::mesh);
    EXPECT_EQ(recognize(shape_of(make_disc(0.5, 64))).kind, Kind::mesh);
    EXPECT_EQ(recognize(shape_of(make_cylinder(0.5, 0.6, 8))).kind, Kind::convex);
    EXPECT_EQ(recognize(shape_of(make_sphere(0.5, 0))).kind, Kind::convex);
    TriangleMesh box = make_box(1, 1, 1);
    box.vertices.front().x -= 1e-6;
    EXPECT_NE(recognize(shape_of(box)).kind, Kind::box);
}

TEST(Primitives, HaveTheMeshesSizeAndPlace) {
    TriangleMesh mesh = make_box(1, 2, 3);
    for (Vec3& v : mesh.vertices) v += {5, 6, 7};
    const Primitive box = recognize(shape_of(mesh));
    EXPECT_EQ(box.center, (Vec3{5, 6, 7}));
    EXPECT_EQ(box.size, (Vec3{1, 2, 3}));
}

TEST(Primitives, RoundSolidsHaveTheInertiaOfWhatTheyStandFor) {
    ShapeDescription shape = shape_of(make_cylinder(0.5, 0.6, 64));
    shape.mass_kind = MassKind::density, shape.mass_value = 100;
    const auto mesh = solid_mass_properties({shape.vertices, shape.triangles}, 100, "cylinder");
    const MassProperties mass = primitive_mass(recognize(shape), shape, mesh);
    EXPECT_EQ(mass.mass, mesh.mass);
    EXPECT_DOUBLE_EQ(mass.principal_inertia.z, mass.mass * 0.25 / 2);
    EXPECT_DOUBLE_EQ(mass.principal_inertia.x, mass.mass * (3 * 0.25 + 0.36) / 12);
}

TEST(Primitives, FacesOfAConvexSolidAreWholeAndTurnOutwards) {
    const TriangleMesh box = make_box(1, 2, 3);
    const std::vector<Face> faces = convex_faces(box.vertices, box.triangles);
    ASSERT_EQ(faces.size(), 6u);
    for (const Face& face : faces) {
        ASSERT_EQ(face.corners.size(), 4u);
        const auto at = [&](std::size_t k) { return box.vertices[static_cast<std::size_t>(face.corners[k])]; };
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 turn = cross(at((k + 1) % 4) - at(k), at((k + 2) % 4) - at((k + 1) % 4));
            EXPECT_GT(dot(turn, face.normal), 0);
        }
        EXPECT_GT(dot(at(0), face.normal), 0);
    }
}

} // namespace
} // namespace flotilla::baseline
