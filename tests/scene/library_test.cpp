// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include <flotilla/error.hpp>
#include <flotilla/scene_library.hpp>

#include "base/rotation.hpp"
#include "mesh/mesh_file.hpp"
#include "scene/initial_overlap.hpp"
#include "scene/library.hpp"

namespace flotilla {
namespace {

void expect_valid_and_free(const SceneDescription& description, const std::string& what) {
    const Scene scene = build_scene(description);
    EXPECT_TRUE(scene.warnings.empty()) << what << ": " << scene.warnings.front();
    EXPECT_TRUE(find_initial_overlaps(scene).movable.empty()) << what;
}

TEST(SceneLibrary, EveryDefaultSceneIsValidAndFreeOfIntersections) {
    for (const LibraryScene& info : list_scenes()) {
        const SceneDescription scene = make_scene(info.name);
        EXPECT_EQ(scene.bodies.size(), static_cast<std::size_t>(info.default_bodies)) << info.name;
        expect_valid_and_free(scene, std::string(info.name));
    }
}

TEST(SceneLibrary, BoatsNeverIntersectAtTheStart) {
    for (const int bodies : {3, 4, 5, 12, 102, 252, 1002})
        for (const std::uint64_t seed : {0U, 1U, 77U}) {
            const SceneDescription scene = make_scene("boats-in-bowl", bodies, seed);
            EXPECT_EQ(scene.bodies.size(), static_cast<std::size_t>(bodies));
            expect_valid_and_free(scene, std::to_string(bodies) + " bodies, seed " + std::to_string(seed));
        }
}

TEST(SceneLibrary, TrianglesAndStacksNeverIntersectAtTheStart) {
    for (const int bodies : {6, 10, 50, 186, 1000})
        for (const std::uint64_t seed : {0U, 5U})
            expect_valid_and_free(make_scene("triangles-on-pegs", bodies, seed), "pegs");
    for (const int bodies : {2, 21, 200}) expect_valid_and_free(make_scene("stack", bodies), "stack");
    for (const int bodies : {2, 3, 9, 60})
        expect_valid_and_free(make_scene("falling-boats", bodies, 3), "falling boats");
}

TEST(SceneLibrary, WiresNeverIntersectAtTheStart) {
    for (const int bodies : {2, 3, 12, 101, 500})
        for (const std::uint64_t seed : {0U, 5U}) expect_valid_and_free(make_scene("wires", bodies, seed), "wires");
}

TEST(SceneLibrary, RocksAreConvexAndNeverIntersectAtTheStart) {
    for (const int bodies : {7, 8, 12, 50, 1329, 3000})
        for (const std::uint64_t seed : {0U, 5U}) expect_valid_and_free(make_scene("rocks", bodies, seed), "rocks");
    const ShapeDescription rock = make_scene("rocks").shapes.front();
    EXPECT_EQ(rock.triangles.size(), 16U); // Euler: 2 * 10 - 4
    for (const Triangle& t : rock.triangles) {
        const Vec3 &p = rock.vertices[static_cast<std::size_t>(t[0])],
                   &q = rock.vertices[static_cast<std::size_t>(t[1])],
                   &r = rock.vertices[static_cast<std::size_t>(t[2])];
        for (const Vec3& v : rock.vertices) EXPECT_LE(dot(cross(q - p, r - p), v - p), 1e-12);
    }
}

/// The bowl of a scene whose last bodies are a bowl and the ground.
struct Bowl {
    std::size_t body = 0;
    double rim_radius = 0, rim_height = 0; // m
};
Bowl bowl_of(const Scene& scene) {
    Bowl bowl{scene.bodies.size() - 2};
    EXPECT_TRUE(scene.bodies[bowl.body].name.ends_with("bowl"));
    for (const Vec3& v : initial_vertices(scene, bowl.body)) {
        bowl.rim_radius = std::max(bowl.rim_radius, std::hypot(v.x, v.y));
        bowl.rim_height = std::max(bowl.rim_height, v.z);
    }
    return bowl;
}

/// Whole bodies start inside the cylinder over the rim and above it.
void expect_all_over(const Bowl& bowl, const Scene& scene) {
    for (std::size_t i = 0; i < bowl.body; ++i)
        for (const Vec3& v : initial_vertices(scene, i)) {
            ASSERT_LT(std::hypot(v.x, v.y), bowl.rim_radius) << scene.bodies.size();
            ASSERT_GT(v.z, bowl.rim_height) << scene.bodies.size();
        }
}

TEST(SceneLibrary, BoatsFallIntoTheBowlAndHaveRoomInIt) {
    for (const int bodies : {3, 12, 102, 252, 1002}) {
        const Scene scene = build_scene(make_scene("boats-in-bowl", bodies, 9));
        const Bowl bowl = bowl_of(scene);
        expect_all_over(bowl, scene);
        const double pi = std::acos(-1.0), r = bowl.rim_radius, h = bowl.rim_height;
        const double volume = pi * h * (3 * r * r + h * h) / 6; // spherical cap
        EXPECT_GT(volume, 4.5 * (bodies - 2)) << "at 4.5 m^3 per boat the pile must fit";
    }
}

TEST(SceneLibrary, HouseholdThingsOfEachKindStandOverTheirBowl) {
    constexpr int kKinds = 8;
    for (const int bodies : {10, 22, 52, 102, 1002})
        for (const std::uint64_t seed : {0U, 1U, 9U}) {
            const SceneDescription description = make_scene("household", bodies, seed);
            ASSERT_EQ(description.bodies.size(), static_cast<std::size_t>(bodies));
            expect_valid_and_free(description, std::to_string(bodies) + " bodies, seed " + std::to_string(seed));
            const Scene scene = build_scene(description);
            expect_all_over(bowl_of(scene), scene);
            std::set<std::int32_t> kinds;
            for (const BodyDescription& body : description.bodies)
                if (body.type == BodyType::dynamic) kinds.insert(body.shape);
            EXPECT_EQ(kinds.size(), kKinds) << bodies << ' ' << seed;
        }
}

TEST(SceneLibrary, BowlsSideBySideHoldAHundredBoatsEach) {
    for (const int bodies : {3, 50, 102, 203, 300, 506}) {
        const SceneDescription scene = make_scene("boats-in-bowls", bodies, 2);
        ASSERT_EQ(scene.bodies.size(), static_cast<std::size_t>(bodies));
        expect_valid_and_free(scene, std::to_string(bodies));
        std::vector<Vec3> axes;
        std::vector<int> boats;
        for (const BodyDescription& body : scene.bodies)
            if (body.shape == 1) axes.push_back(body.position), boats.push_back(0);
        for (const BodyDescription& body : scene.bodies) {
            if (body.type != BodyType::dynamic) continue;
            std::size_t nearest = 0;
            for (std::size_t k = 1; k < axes.size(); ++k)
                if (std::hypot(body.position.x - axes[k].x, body.position.y - axes[k].y) <
                    std::hypot(body.position.x - axes[nearest].x, body.position.y - axes[nearest].y))
                    nearest = k;
            ++boats[nearest];
        }
        if ((bodies - 1) % 101 == 0) {
            EXPECT_EQ(boats, std::vector<int>(static_cast<std::size_t>((bodies - 1) / 101), 100));
        }
    }
    // One bowl of them is the bowl of boats-in-bowl, with the same boats.
    const SceneDescription one = make_scene("boats-in-bowls", 102, 7), same = make_scene("boats-in-bowl", 102, 7);
    for (std::size_t i = 0; i < 101; ++i) {
        EXPECT_EQ(one.bodies[i].position, same.bodies[i].position);
        EXPECT_EQ(one.bodies[i].rotation, same.bodies[i].rotation);
    }
}

TEST(SceneLibrary, SameSeedSameBitsOtherSeedOtherScene) {
    const auto same = [](const SceneDescription& a, const SceneDescription& b) {
        for (std::size_t i = 0; i < a.bodies.size(); ++i)
            if (a.bodies[i].position != b.bodies[i].position || a.bodies[i].rotation != b.bodies[i].rotation)
                return false;
        return a.shapes[1].vertices == b.shapes[1].vertices;
    };
    EXPECT_TRUE(same(make_scene("boats-in-bowl", 52, 4), make_scene("boats-in-bowl", 52, 4)));
    EXPECT_FALSE(same(make_scene("boats-in-bowl", 52, 4), make_scene("boats-in-bowl", 52, 5)));
}

TEST(SceneLibrary, OrientationsAreUnitAndUniform) {
    // The mean of w^2 over uniform rotations is 1/4, its variance 1/32.
    constexpr std::size_t kSamples = 20000;
    double sum = 0;
    for (std::size_t i = 0; i < kSamples; ++i) {
        const Quat q = library::random_rotation(1, i);
        ASSERT_NEAR(norm(q), 1, 1e-15);
        sum += q.w * q.w;
    }
    EXPECT_NEAR(sum / kSamples, 0.25, 5 * std::sqrt(1.0 / 32 / kSamples));
}

TEST(SceneLibrary, PackedSpheresNeverTouch) {
    for (const double column : {0.0, 0.5, 1.2, 3.0, 7.5})
        for (const std::uint64_t seed : {1U, 2U}) {
            const std::vector<Vec3> places = library::packed_column(150, 1, column, 10, seed);
            ASSERT_EQ(places.size(), 150U);
            for (std::size_t i = 0; i < places.size(); ++i) {
                EXPECT_LE(std::hypot(places[i].x, places[i].y), std::max(column, 0.055));
                EXPECT_GT(places[i].z, 10 - 0.06);
                for (std::size_t j = 0; j < i; ++j) ASSERT_GT(length(places[i] - places[j]), 2.009) << column;
            }
        }
}

TEST(SceneLibrary, TheEmbeddedBoatIsTheMeshFile) {
    const TriangleMesh file = read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj");
    const TriangleMesh embedded = library::boat_mesh();
    EXPECT_EQ(embedded.vertices, file.vertices);
    EXPECT_EQ(embedded.triangles, file.triangles);
}

TEST(SceneLibrary, TheBowlIsThatOfTheMeshFile) {
    const TriangleMesh file = read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/bowl.obj");
    const TriangleMesh made = library::bowl_mesh(10, 80 * std::acos(-1.0) / 180, 20, 64);
    ASSERT_EQ(made.vertices.size(), file.vertices.size());
    EXPECT_EQ(made.triangles, file.triangles);
    for (std::size_t i = 0; i < made.vertices.size(); ++i)
        EXPECT_LT(length(made.vertices[i] - file.vertices[i]), 1e-7) << i;
}

TEST(SceneLibrary, RefusesUnknownNamesAndNumbers) {
    const auto refusal = [](std::string_view name, int bodies) -> std::string {
        try {
            (void)make_scene(name, bodies);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    EXPECT_EQ(refusal("boats-in-bowel", 0),
              "unknown scene \"boats-in-bowel\"; did you mean \"boats-in-bowl\"? (flotilla scene --list prints them)");
    EXPECT_EQ(refusal("boats-in-bowl", 2), "scene boats-in-bowl has 3 to 1000000 bodies, not 2");
    EXPECT_EQ(refusal("stack", -1), "scene stack has 2 to 10000 bodies, not -1");
}

} // namespace
} // namespace flotilla
