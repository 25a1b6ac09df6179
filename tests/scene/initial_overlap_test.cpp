// SPDX-License-Identifier: MIT
#include "scene/initial_overlap.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.hpp"
#include "base/rotation.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "mesh/primitives.hpp"

namespace flotilla {
namespace {

struct Builder {
    SceneDescription scene;

    Builder& shape(const TriangleMesh& mesh) {
        ShapeDescription s;
        s.name = std::to_string(scene.shapes.size());
        s.vertices = mesh.vertices;
        s.triangles = mesh.triangles;
        s.mass_kind = MassKind::mass;
        s.mass_value = 1;
        scene.shapes.push_back(std::move(s));
        return *this;
    }
    Builder& body(std::int32_t shape, const Vec3& position, BodyType type = BodyType::dynamic,
                  const Quat& rotation = {}) {
        BodyDescription b;
        b.name = std::to_string(scene.bodies.size());
        b.shape = shape;
        b.type = type;
        b.position = position;
        b.rotation = rotation;
        if (type == BodyType::kinematic) b.keyframes = {{0, position, rotation}};
        scene.bodies.push_back(std::move(b));
        return *this;
    }
    [[nodiscard]] InitialOverlaps overlaps() const { return find_initial_overlaps(build_scene(scene)); }
};

TEST(InitialOverlap, FindsCrossingPlatesAndTheirPlace) {
    Builder b;
    b.shape(make_plate(2, 2))
        .body(0, {5, 0, 0})
        .body(0, {5, 0, 0.5}, BodyType::dynamic, rotation_from_vector({1.5, 0, 0}));
    const InitialOverlaps found = b.overlaps();
    ASSERT_EQ(found.movable.size(), 1U);
    EXPECT_EQ(found.movable[0].a, 0);
    EXPECT_EQ(found.movable[0].b, 1);
    EXPECT_GE(found.movable[0].triangles.size(), 1U);
    EXPECT_NEAR(found.movable[0].place.x, 5, 1);
    EXPECT_TRUE(found.fixed.empty());
}

TEST(InitialOverlap, TouchingCountsAndAnUlpMoreThanRoundingDoesNot) {
    for (const double gap : {0.0, 1e-15, 1e-9}) {
        Builder b;
        b.shape(make_box(1, 1, 1)).body(0, {0, 0, 0}).body(0, {0.25, 0.25, 1 + gap});
        EXPECT_EQ(b.overlaps().movable.size(), gap < 1e-12 ? 1U : 0U) << gap;
    }
}

// A box on another of the same width, 0.3 mm above it: the faces of their sides lie in one plane, to rounding.
TEST(InitialOverlap, FlushFacesDoNotIntersectHoweverTheyAreTurned) {
    for (int i = 0; i < 300; ++i) {
        const auto draw = [&](int k) { return 6 * unit_interval(random_bits(5, i, k)) - 3; };
        const Quat turn = rotation_from_vector({draw(0), draw(1), draw(2)});
        Builder b;
        b.shape(make_box(1, 0.3, 0.04)).shape(make_box(0.2, 0.3, 0.2));
        b.body(0, {}, BodyType::dynamic, turn).body(1, rotate(turn, {0.1, 0, 0.1203}), BodyType::dynamic, turn);
        EXPECT_TRUE(b.overlaps().movable.empty()) << i;
    }
}

TEST(InitialOverlap, NestedClosedSurfacesDoNotIntersect) {
    Builder b;
    b.shape(make_box(3, 3, 3)).shape(make_box(1, 1, 1)).body(0, {}).body(1, {});
    EXPECT_TRUE(b.overlaps().movable.empty());
}

TEST(InitialOverlap, PairsOfInfiniteMassAreOnlyWarnings) {
    Builder b;
    b.shape(make_box(1, 1, 1))
        .body(0, {}, BodyType::fixed)
        .body(0, {0.5, 0, 0}, BodyType::kinematic)
        .body(0, {0, 0.5, 0});
    const InitialOverlaps found = b.overlaps();
    ASSERT_EQ(found.fixed.size(), 1U);
    EXPECT_EQ(found.fixed[0].a, 0);
    EXPECT_EQ(found.fixed[0].b, 1);
    ASSERT_EQ(found.movable.size(), 2U);
    EXPECT_EQ(found.movable[0].b, 2);
    EXPECT_EQ(found.movable[1].b, 2);
}

TEST(InitialOverlap, EqualsBruteForceOnRandomScenes) {
    std::size_t pairs = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Builder b;
        b.shape(make_plate(1, 0.5, 2, 2)).shape(make_tube(0.3, 0.8, 8));
        const auto draw = [&](int id, int k) { return 2 * unit_interval(random_bits(seed, id, k)) - 1; };
        for (int i = 0; i < 30; ++i)
            b.body(i % 2, {2 * draw(i, 0), 2 * draw(i, 1), 2 * draw(i, 2)}, BodyType::dynamic,
                   rotation_from_vector({2 * draw(i, 3), 2 * draw(i, 4), 2 * draw(i, 5)}));
        const Scene scene = build_scene(b.scene);
        const InitialOverlaps found = find_initial_overlaps(scene);
        std::vector<BodyOverlap> expected;
        for (std::size_t i = 0; i < scene.bodies.size(); ++i)
            for (std::size_t j = i + 1; j < scene.bodies.size(); ++j) {
                BodyOverlap o;
                const auto vi = initial_vertices(scene, i), vj = initial_vertices(scene, j);
                const auto& ti = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)].mesh.triangles;
                const auto& tj = scene.shapes[static_cast<std::size_t>(scene.bodies[j].shape)].mesh.triangles;
                const auto corners = [](const std::vector<Vec3>& v, const Triangle& t) {
                    return std::array{v[static_cast<std::size_t>(t[0])], v[static_cast<std::size_t>(t[1])],
                                      v[static_cast<std::size_t>(t[2])]};
                };
                for (std::size_t k = 0; k < ti.size(); ++k)
                    for (std::size_t l = 0; l < tj.size(); ++l)
                        if (exact::triangles_intersect(corners(vi, ti[k]), corners(vj, tj[l])))
                            o.triangles.push_back({static_cast<std::int32_t>(k), static_cast<std::int32_t>(l)});
                o.a = static_cast<std::int32_t>(i);
                o.b = static_cast<std::int32_t>(j);
                if (!o.triangles.empty()) expected.push_back(o);
            }
        ASSERT_EQ(found.movable.size(), expected.size()) << seed;
        for (std::size_t k = 0; k < expected.size(); ++k) {
            EXPECT_EQ(found.movable[k].a, expected[k].a);
            EXPECT_EQ(found.movable[k].b, expected[k].b);
            EXPECT_EQ(found.movable[k].triangles, expected[k].triangles);
        }
        pairs += expected.size();
    }
    EXPECT_GT(pairs, 100U) << "the scenes must overlap for this to mean anything";
}

} // namespace
} // namespace flotilla
