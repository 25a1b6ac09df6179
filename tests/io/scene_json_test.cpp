// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

namespace flotilla {
namespace {

constexpr const char* kScene = R"({
  "flotilla_scene": 1, "gravity": [0, 0, -1.5],
  "settings": { "time_step": 0.02, "friction": 0.4, "trajectory": "rigid", "sleeping": false, "seed": 18446744073709551615 },
  "shapes": [
    {"name": "plate", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "mass": 2.0, "scale": 0.5},
    {"name": "heavy", "vertices": [[0,0,0],[1,0,0],[0,1,-0.0]], "triangles": [[0,1,2]], "surface_density": 7,
     "inertia": [1, 2, 2.5], "center_of_mass": [0.1, 0.2, 0.3]} ],
  "bodies": [
    {"name": "b0", "shape": "plate", "type": "dynamic", "position": [0,0,5], "rotation": [0.6, 0, 0.8, 0],
     "velocity": [1,2,3], "angular_velocity": [0.1, 1e-300, -0.0], "friction": 0.3, "restitution": 0.0},
    {"name": "b1", "shape": "heavy"},
    {"name": "floor", "shape": "plate", "type": "static", "position": [0, 0, -1]},
    {"name": "lid", "shape": "plate", "type": "kinematic", "keyframes": [
      {"time": 0, "position": [0,0,9], "rotation": [1,0,0,0]}, {"time": 2.5, "position": [0,0,8]} ] } ] })";

std::string written(const SceneDescription& scene) {
    std::ostringstream out;
    write_scene(out, scene);
    return out.str();
}

TEST(SceneJson, ReadsWhatTheFileSays) {
    const SceneDescription s = parse_scene(kScene, "test", ".");
    EXPECT_EQ(s.gravity, (Vec3{0, 0, -1.5}));
    EXPECT_EQ(s.settings.time_step, 0.02);
    EXPECT_EQ(s.settings.trajectory, Trajectory::rigid);
    EXPECT_FALSE(s.settings.sleeping);
    EXPECT_EQ(s.settings.seed, ~std::uint64_t{0});
    ASSERT_EQ(s.shapes.size(), 2U);
    EXPECT_EQ(s.shapes[0].vertices[1], (Vec3{0.5, 0, 0})) << "vertices are multiplied by scale";
    EXPECT_EQ(s.shapes[0].mass_kind, MassKind::mass);
    EXPECT_EQ(s.shapes[1].mass_kind, MassKind::surface_density);
    EXPECT_EQ(s.shapes[1].inertia->m, (std::array<double, 9>{1, 0, 0, 0, 2, 0, 0, 0, 2.5}));
    EXPECT_EQ(*s.shapes[1].center_of_mass, (Vec3{0.1, 0.2, 0.3}));
    ASSERT_EQ(s.bodies.size(), 4U);
    EXPECT_EQ(s.bodies[0].rotation, (Quat{0.6, 0, 0.8, 0}));
    EXPECT_EQ(s.bodies[0].velocity, (Vec3{1, 2, 3}));
    EXPECT_EQ(s.bodies[0].angular_velocity.y, 1e-300);
    EXPECT_EQ(s.bodies[2].type, BodyType::fixed);
    EXPECT_EQ(s.bodies[3].type, BodyType::kinematic);
    EXPECT_EQ(s.bodies[3].position, (Vec3{0, 0, 9})) << "a kinematic body starts at its first keyframe";
    EXPECT_EQ(s.bodies[3].keyframes.size(), 2U);
}

TEST(SceneJson, TheVersionMayBeWrittenAsOthersWriteNumbers) {
    EXPECT_NO_THROW((void)parse_scene(R"({"flotilla_scene": 1.0, "shapes": [], "bodies": []})", "scene", {}));
}

TEST(SceneJson, OmittedBodyFieldsTakeTheSettingsValues) {
    const SceneDescription s = parse_scene(kScene, "test", ".");
    EXPECT_EQ(s.bodies[0].friction, 0.3);
    EXPECT_EQ(s.bodies[0].restitution, 0.0);
    EXPECT_EQ(s.bodies[1].friction, 0.4);
    EXPECT_EQ(s.bodies[1].restitution, 0.1);
}

TEST(SceneJson, FileWinsOverPresetAndOverridesOverBoth) {
    SceneFileOptions options{"accurate", {}};
    SceneDescription s = parse_scene(kScene, "test", ".", options);
    EXPECT_EQ(s.settings.tolerance_share, 0.02) << "of the preset";
    EXPECT_EQ(s.settings.tangents, Tangents::cone);
    EXPECT_EQ(s.settings.friction, 0.4);
    options.overrides = {{"friction", "0.7"}, {"tangents", "random"}, {"static_tolerance", "0.25"}};
    s = parse_scene(kScene, "test", ".", options);
    EXPECT_EQ(s.settings.tangents, Tangents::random);
    EXPECT_EQ(s.settings.static_tolerance, 0.25);
    EXPECT_EQ(s.bodies[1].friction, 0.7) << "bodies without a value take the overridden one";
    EXPECT_EQ(s.bodies[0].friction, 0.3);
}

TEST(SceneJson, RoundTripsToTheSameBits) {
    const SceneDescription first = parse_scene(kScene, "test", ".");
    const std::string text = written(first);
    const SceneDescription second = parse_scene(text, "test", ".");
    EXPECT_EQ(written(second), text);
    EXPECT_EQ(second.settings, first.settings);
    EXPECT_EQ(second.bodies[0].rotation, first.bodies[0].rotation);
    EXPECT_EQ(second.bodies[0].angular_velocity, first.bodies[0].angular_velocity);
    EXPECT_TRUE(std::signbit(second.bodies[0].angular_velocity.z)) << "the sign of zero is kept";
    EXPECT_EQ(second.shapes[0].vertices, first.shapes[0].vertices);
    EXPECT_EQ(second.shapes[1].inertia, first.shapes[1].inertia);
}

TEST(SceneJson, SegmentsAndPointsFollowTheTrianglesAndRoundTrip) {
    const auto scene = [](const std::string& shape) {
        return R"({"flotilla_scene": 1, "shapes": [{"name": "s", "vertices": [[0,0,0],[1,0,0],[0,1,0],[2,2,2]], )" +
               shape + R"(}], "bodies": [{"name": "b", "shape": "s", "type": "static"}]})";
    };
    const std::string lists = R"("triangles": [[0, 1, 2]],
     "segments": [[3, 2], [0, 3]],
     "points": [3])";
    const SceneDescription first = parse_scene(scene(lists), "test", ".");
    EXPECT_EQ(first.shapes[0].triangles,
              (std::vector<Triangle>{{0, 1, 2}, segment_element(3, 2), segment_element(0, 3), point_element(3)}));
    EXPECT_NE(written(first).find(lists), std::string::npos) << written(first);

    // What stands among the triangles stays there.
    for (const char* kept :
         {R"("triangles": [[0, 0, 3], [0, 1, 2]])", R"("triangles": [[0, 1, 1], [2, 2, 2], [0, 3, 3]])",
          R"("segments": [[0, 1]])", R"("points": [2])"}) {
        const SceneDescription s = parse_scene(scene(kept), "test", ".");
        const SceneDescription again = parse_scene(written(s), "test", ".");
        EXPECT_EQ(again.shapes[0].triangles, s.shapes[0].triangles);
        EXPECT_NE(written(s).find(kept), std::string::npos) << written(s);
    }
    const SceneDescription wire =
        parse_scene(scene(R"("segments": [[0, 1], [1, 2]], "line_density": 2.5)"), "test", ".");
    EXPECT_EQ(wire.shapes[0].mass_kind, MassKind::line_density);
    EXPECT_EQ(wire.shapes[0].mass_value, 2.5);
    EXPECT_NE(written(wire).find("\"line_density\": 2.5"), std::string::npos);
}

std::string with_body(const std::string& fields) {
    return R"({"flotilla_scene": 1, "shapes": [{"name": "s", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]],
      "triangles": [[0,1,2]]}], "bodies": [{"name": "b", "shape": "s", )" +
           fields + "}]}";
}

TEST(SceneJson, LockedAxesForceAndTorqueRoundTrip) {
    const std::string text = with_body(R"("locked": ["rz", "x", "rx"], "force": [1, 0.1, -3], "torque": [0, 1e-9, 2])");
    const SceneDescription first = parse_scene(text, "test", ".");
    const BodyDescription& body = first.bodies[0];
    EXPECT_EQ(body.locked_translation, (std::array{true, false, false}));
    EXPECT_EQ(body.locked_rotation, (std::array{true, false, true}));
    EXPECT_EQ(body.force, (Vec3{1, 0.1, -3}));
    EXPECT_EQ(body.torque, (Vec3{0, 1e-9, 2}));
    const SceneDescription second = parse_scene(written(first), "test", ".");
    EXPECT_EQ(second.bodies[0].locked_translation, body.locked_translation);
    EXPECT_EQ(second.bodies[0].locked_rotation, body.locked_rotation);
    EXPECT_EQ(second.bodies[0].force, body.force);
    EXPECT_EQ(second.bodies[0].torque, body.torque);
    EXPECT_EQ(written(parse_scene(with_body(R"("type": "dynamic")"), "test", ".")).find("locked"), std::string::npos);
}

std::string refusal(const std::string& fields) {
    try {
        (void)parse_scene(with_body(fields), "test", ".");
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(SceneJson, LocksAndLoadsThatContradictOrMeanNothingAreRefused) {
    const auto says = [](const std::string& fields, const std::string& reason) {
        EXPECT_NE(refusal(fields).find(reason), std::string::npos) << fields << ": " << refusal(fields);
    };
    says(R"("locked": ["x", "w"])", "/bodies/0/locked/1");
    says(R"("locked": ["ry", "ry"])", "names \"ry\" again");
    says(R"("locked": "x")", "/bodies/0/locked");
    says(R"("locked": ["y"], "velocity": [1, 0.5, 0])", "must be zero along y, as \"y\" is locked, got 0.5");
    says(R"("locked": ["rz"], "angular_velocity": [1, 0, -2])", "must be zero along z, as \"rz\" is locked, got -2");
    says(R"("type": "static", "locked": ["x"])", "only a dynamic body has locked axes");
    says(R"("type": "static", "force": [0, 0, 1])", "only a dynamic body has a force");
    says(R"("type": "static", "torque": [0, 0, 1])", "only a dynamic body has a torque");
    says(R"("force": [1e16, 0, 0])", "exceeds the limit");
    EXPECT_EQ(refusal(R"("locked": ["y"], "velocity": [1, 0, 0])"), "accepted");
}

TEST(SceneJson, RotationsNearlyUnitAreNormalisedOnce) {
    const std::string text =
        R"({"flotilla_scene": 1, "shapes": [{"name": "s", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]],
      "triangles": [[0,1,2]]}], "bodies": [{"name": "b", "shape": "s", "rotation": [0.6000003, 0, 0.8000003, 0]}]})";
    const SceneDescription first = parse_scene(text, "test", ".");
    const Quat q = first.bodies[0].rotation;
    EXPECT_NEAR(std::hypot(q.w, q.y), 1, 1e-15);
    EXPECT_EQ(parse_scene(written(first), "test", ".").bodies[0].rotation, q);
}

class SceneFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(::testing::TempDir()) /
                  ("flotilla_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
        std::filesystem::create_directories(folder_ / "meshes");
        write("meshes/tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

    std::filesystem::path folder_;
};

TEST_F(SceneFolder, MeshPathsAreRelativeToTheSceneFile) {
    write("s.json", R"({"flotilla_scene": 1, "shapes": [{"name": "s", "mass": 1, "mesh": "meshes/tri.obj", "scale": 2}],
      "bodies": [{"name": "b", "shape": "s"}]})");
    const SceneDescription s = read_scene(folder_ / "s.json");
    ASSERT_EQ(s.shapes[0].vertices.size(), 3U);
    EXPECT_EQ(s.shapes[0].vertices[1], (Vec3{2, 0, 0}));
    EXPECT_EQ(s.shapes[0].mesh_path, "meshes/tri.obj");
    EXPECT_EQ(parse_scene(written(s), "test", folder_).shapes[0].vertices, s.shapes[0].vertices);
}

TEST_F(SceneFolder, UnreadableSceneFilesAreIoErrors) {
    EXPECT_THROW((void)read_scene(folder_ / "none.json"), IoError);
    EXPECT_THROW((void)read_scene(folder_), IoError);
}

TEST_F(SceneFolder, MissingAndBrokenMeshesAreProblemsOfTheScene) {
    write("meshes/bad.obj", "v 0 0 0\nv 1 0 zero\nf 1 2 3\n");
    write("s.json", R"({"flotilla_scene": 1, "shapes": [{"name": "a", "mass": 1, "mesh": "meshes/none.obj"},
      {"name": "b", "mesh": "meshes/bad.obj"}, {"name": "c", "mesh": "meshes/tri.xyz"}],
      "bodies": [{"name": "b", "shape": "a"}]})");
    try {
        (void)read_scene(folder_ / "s.json");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        const std::string what = error.what();
        EXPECT_NE(what.find("s.json: /shapes/0/mesh: "), std::string::npos) << what;
        EXPECT_NE(what.find("none.obj"), std::string::npos) << what;
        EXPECT_NE(what.find("s.json: /shapes/1/mesh: "), std::string::npos) << what;
        EXPECT_NE(what.find("bad.obj:2"), std::string::npos) << what;
        EXPECT_NE(what.find("s.json: /shapes/2/mesh: "), std::string::npos) << what;
    }
}

} // namespace
} // namespace flotilla
