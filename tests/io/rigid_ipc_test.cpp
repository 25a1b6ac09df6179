// SPDX-License-Identifier: MIT
// Scenes of Rigid-IPC as scenes of ours.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>

#include <flotilla/error.hpp>
#include <flotilla/scene_file.hpp>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "io/rigid_ipc_script.hpp"
#include "mesh/primitives.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// A brick of 2 x 4 x 6 m about its own origin, closed.
const std::string kBrick = R"("vertices": [[-1,-2,-3],[1,-2,-3],[1,2,-3],[-1,2,-3],[-1,-2,3],[1,-2,3],[1,2,3],[-1,2,3]],
  "faces": [[0,2,1],[0,3,2],[4,5,6],[4,6,7],[0,1,5],[0,5,4],[2,3,7],[2,7,6],[0,4,7],[0,7,3],[1,2,6],[1,6,5]])";
const std::string kSheet = R"("vertices": [[0,0,0],[1,0,0],[0,0,1]], "faces": [[0,1,2]])";

std::string scene(const std::string& bodies, const std::string& problem = "", const std::string& top = "") {
    return "{\"timestep\": 0.02, " + top + "\"rigid_body_problem\": {" + problem + "\"rigid_bodies\": [" + bodies +
           "]}}";
}
std::string brick(const std::string& members = "") {
    return "{" + kBrick + (members.empty() ? "" : ", " + members) + "}";
}

struct Read {
    SceneDescription scene;
    SceneOrigin origin;
};
Read read(const std::string& text, const SceneFileOptions& options = {}) {
    Read r;
    r.scene = parse_scene(text, "f.json", ".", options, &r.origin);
    return r;
}
std::string refusal(const std::string& text) {
    try {
        (void)parse_scene(text, "f.json", ".");
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

Vec3 world(const BodyDescription& body, const Vec3& v) { return rotate(body.rotation, v) + body.position; }
void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-14) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(RigidIpc, TurnsTheSceneSoThatItsUpIsOurs) {
    const auto [s, origin] =
        read(scene(brick(R"("position": [1, 2, 3], "linear_velocity": [4, 5, 6], "angular_velocity": [0, 180, 90])"),
                   R"("gravity": [0, -9.8, 0], )"));
    EXPECT_EQ(origin.format, "Rigid-IPC");
    EXPECT_EQ(s.gravity, (Vec3{0, 0, -9.8}));
    ASSERT_EQ(s.bodies.size(), 1U);
    EXPECT_EQ(s.bodies[0].position, (Vec3{1, -3, 2}));
    EXPECT_EQ(s.bodies[0].velocity, (Vec3{4, -6, 5}));
    expect_near(s.bodies[0].angular_velocity, {0, -kPi / 2, kPi});
    EXPECT_EQ(s.shapes[0].vertices[6], (Vec3{1, -3, 2}));
    EXPECT_EQ(s.settings.time_step, 0.02);
    EXPECT_EQ(s.settings.restitution, 0);
    EXPECT_EQ(s.settings.friction, 0);
    EXPECT_EQ(s.bodies[0].friction, 0);
}

// A vertex v of the mesh is at Rz Ry Rx (scale v) + position there.
TEST(RigidIpc, PlacesVerticesWhereItDoes) {
    const auto [s, origin] =
        read(scene(brick(R"("scale": [1, 0.5, 2], "rotation": [90, 0, 90], "position": [10, 20, 30])")));
    // (1, 2, 3) -> (1, 1, 6) -> about x by 90: (1, -6, 1) -> about z by 90: (6, 1, 1) -> (16, 21, 31)
    expect_near(world(s.bodies[0], s.shapes[0].vertices[6]), {16, -31, 21}, 1e-13);
}

TEST(RigidIpc, DimensionsReplaceTheScale) {
    const auto [s, origin] = read(scene(brick(R"("scale": 7, "dimensions": [1, 1, 3])")));
    EXPECT_EQ(s.shapes[0].vertices[6], (Vec3{0.5, -1.5, 0.5}));
    const auto [flat, o] = read(scene("{" + kSheet + R"(, "dimensions": [2, 5, 3], "type": "static"})"));
    EXPECT_EQ(flat.shapes[0].vertices[2], (Vec3{0, -3, 0})) << "no extent along y: left as it is";
}

TEST(RigidIpc, EdgesOfFacesAreNothingNew) {
    const auto [s, origin] = read(scene("{" + kSheet + R"(, "edges": [[1,0],[1,2],[0,2]], "type": "static"})"));
    EXPECT_EQ(s.bodies.size(), 1U);
}

TEST(RigidIpc, DensityIsOfTheVolumeOrTheSurface) {
    const auto [s, origin] = read(scene(brick(R"("density": 500)") + ", {" + kSheet + R"(, "position": [9, 0, 0]})"));
    EXPECT_EQ(s.shapes[0].mass_kind, MassKind::density);
    EXPECT_EQ(s.shapes[0].mass_value, 500);
    EXPECT_EQ(s.shapes[1].mass_kind, MassKind::surface_density);
    EXPECT_EQ(s.shapes[1].mass_value, 1000);
    ASSERT_EQ(origin.warnings.size(), 1U);
    EXPECT_EQ(origin.warnings[0].find("f.json: /rigid_body_problem/rigid_bodies/1: its mesh bounds no volume"), 0U)
        << origin.warnings[0];
}

TEST(RigidIpc, BodiesOfOneMeshShareAShapeAndDisabledOnesAreNone) {
    const auto [s, origin] = read(scene(brick() + ", " + brick(R"("position": [9, 0, 0])") + ", " +
                                        brick(R"("enabled": false, "position": [1, 0, 0], "force": [1, 0, 0])")));
    EXPECT_EQ(s.shapes.size(), 1U);
    ASSERT_EQ(s.bodies.size(), 2U);
    EXPECT_EQ(s.bodies[1].name, "body-1");
}

TEST(RigidIpc, TypesAndLocks) {
    const auto [s, origin] = read(
        scene(brick(R"("is_dof_fixed": true)") + ", " +
              brick(R"("is_dof_fixed": [true,true,true,true,true,true], "type": "kinematic", "position": [9,0,0])") +
              ", " + brick(R"("type": "static", "linear_velocity": [1,0,0], "position": [18,0,0], "force": [1,0,0])") +
              ", " + brick(R"("type": "kinematic", "position": [27,0,0])")));
    for (const int i : {0, 1, 2}) EXPECT_EQ(s.bodies[static_cast<std::size_t>(i)].type, BodyType::fixed) << i;
    EXPECT_EQ(s.bodies[3].type, BodyType::kinematic);
    EXPECT_EQ(s.bodies[3].keyframes.size(), 1U);
    EXPECT_EQ(s.shapes[0].mass_kind, MassKind::none);
}

TEST(RigidIpc, LockedAxesForcesAndTorques) {
    const auto [s, origin] = read(scene(brick(
        R"("is_dof_fixed": [false,true,false,true,true,false], "linear_velocity": [1,2,3], "angular_velocity": [90,90,90],
                            "force": [1,2,3], "torque": [0,180,0])")));
    const BodyDescription& body = s.bodies[0];
    EXPECT_EQ(body.type, BodyType::dynamic);
    EXPECT_EQ(body.locked_translation, (std::array{false, false, true})) << "y there is z here";
    EXPECT_EQ(body.locked_rotation, (std::array{true, false, true})) << "x and y there";
    EXPECT_EQ(body.velocity, (Vec3{1, -3, 0})) << "a lock takes the velocity";
    expect_near(body.angular_velocity, {0, -kPi / 2, 0});
    EXPECT_EQ(body.force, (Vec3{1, -3, 2}));
    expect_near(body.torque, {0, 0, kPi});
}

TEST(RigidIpc, TimeEndsWithTimeOrSteps) {
    EXPECT_EQ(read(scene(brick(), "", R"("max_time": 0.5, )")).origin.duration, 0.5);
    EXPECT_DOUBLE_EQ(read(scene(brick(), "", R"("max_iterations": 70, )")).origin.duration, 1.4);
    EXPECT_DOUBLE_EQ(read(scene(brick())).origin.duration, 20) << "1000 steps";
    EXPECT_EQ(read(R"({"flotilla_scene": 1, "shapes": [], "bodies": []})").origin.duration, 0);
}

TEST(RigidIpc, FrictionIsOneForAll) {
    EXPECT_EQ(read(scene(brick(), R"("coefficient_friction": 0.3, )")).scene.bodies[0].friction, 0.3);
    EXPECT_EQ(read(scene(brick(), R"("coefficient_friction": 0.3, )", R"("friction_constraints": {"iterations": 0}, )"))
                  .scene.bodies[0]
                  .friction,
              0);
    EXPECT_EQ(read(scene(brick(), R"("coefficient_friction": 0.3, )"), {"balanced", {{"friction", "0.7"}}})
                  .scene.bodies[0]
                  .friction,
              0.7);
}

TEST(RigidIpc, AConstantVelocityIsAScript) {
    const auto [s, origin] =
        read(scene(brick(R"("type": "kinematic", "linear_velocity": [1, 2, 0], "kinematic_max_time": 0.5)"), "",
                   R"("max_time": 3, )"));
    const auto& k = s.bodies[0].keyframes;
    ASSERT_EQ(k.size(), 2U);
    EXPECT_EQ(k[1].time, 0.5);
    EXPECT_EQ(k[1].position, (Vec3{0.5, 0, 1}));
}

// The brick, moved off its origin, turns about its centre and not about the origin of its mesh.
TEST(RigidIpc, AScriptedBodyTurnsAboutItsCentreOfMass) {
    const std::string off = R"({"vertices": [[4,-2,-3],[6,-2,-3],[6,2,-3],[4,2,-3],[4,-2,3],[6,-2,3],[6,2,3],[4,2,3]],
      "faces": [[0,2,1],[0,3,2],[4,5,6],[4,6,7],[0,1,5],[0,5,4],[2,3,7],[2,7,6],[0,4,7],[0,7,3],[1,2,6],[1,6,5]],
      "type": "kinematic", "angular_velocity": [0, 90, 0], "linear_velocity": [0, 3, 0]})";
    const auto [s, origin] = read(scene(off, "", R"("max_time": 1, )"));
    const auto& k = s.bodies[0].keyframes;
    ASSERT_EQ(k.size(), 51U) << "one a step";
    EXPECT_DOUBLE_EQ(k[50].time, 1);
    expect_near(rotate(k[50].rotation, {5, 0, 0}) + k[50].position, {5, 0, 3}, 1e-13);
    expect_near(rotate(k[50].rotation, {6, 0, 0}) + k[50].position, {5, 1, 3},
                1e-13); // x turned to -z there, which is y here
}

// Poses are of the centre of mass and the principal frame: a pose that repeats the start must give the start back.
TEST(RigidIpc, PosesOfThePrincipalFrame) {
    const TriangleMesh mesh{
        {{4, -2, -3}, {6, -2, -3}, {6, 2, -3}, {4, 2, -3}, {4, -2, 3}, {6, -2, 3}, {6, 2, 3}, {4, 2, 3}},
        {{0, 2, 1},
         {0, 3, 2},
         {4, 5, 6},
         {4, 6, 7},
         {0, 1, 5},
         {0, 5, 4},
         {2, 3, 7},
         {2, 7, 6},
         {0, 4, 7},
         {0, 7, 3},
         {1, 2, 6},
         {1, 6, 5}}};
    const Quat start = normalized(Quat{0.8, 0.3, -0.4, 0.1});
    const io::PrincipalFrame frame = io::principal_frame(mesh, start);
    EXPECT_TRUE(frame.unique);
    expect_near(frame.center_of_mass, {5, 0, 0}, 1e-13);
    const io::Pose same = io::pose_of({{7, 8, 9}, rotation_vector(frame.axes)}, frame, start);
    expect_near(rotate(same.rotation, {5, 0, 0}) + same.position, {7, 8, 9}, 1e-12);
    expect_near(rotate(same.rotation, {0, 1, 0}), rotate(start, {0, 1, 0}), 1e-12);
    // Moments 4^2 + 6^2 > 2^2 + 6^2 > 2^2 + 4^2: ascending, the axes are z, y, x of the mesh, each up to its sign.
    EXPECT_NEAR(std::abs(dot(rotate(frame.axes, {1, 0, 0}), rotate(start, {0, 0, 1}))), 1, 1e-12);
    EXPECT_NEAR(std::abs(dot(rotate(frame.axes, {0, 0, 1}), rotate(start, {1, 0, 0}))), 1, 1e-12);
    const io::Pose turned =
        io::pose_of({{}, rotation_vector(rotation_from_vector({0, 0, 0.25}) * frame.axes)}, frame, start);
    expect_near(rotate(turned.rotation, {1, 2, 3}), rotate(rotation_from_vector({0, 0, 0.25}) * start, {1, 2, 3}),
                1e-12);
}

TEST(RigidIpc, OnePoseAStep) {
    const auto [s, origin] = read(
        scene(brick(R"("type": "kinematic", "kinematic_poses": [{"position": [1, 0, 0]}, {"position": [2, 0, 0]}])"),
              "", R"("max_time": 1, )"));
    const auto& k = s.bodies[0].keyframes;
    ASSERT_EQ(k.size(), 3U);
    EXPECT_EQ(k[2].time, 0.04);
    expect_near(k[2].position, {2, 0, 0});
    ASSERT_EQ(origin.warnings.size(), 1U);
    EXPECT_NE(origin.warnings[0].find("/kinematic_poses: end before the body does at 1 s; it keeps the last"),
              std::string::npos)
        << origin.warnings[0];
}

TEST(RigidIpc, ComponentsBecomeBodies) {
    const std::string two = R"({"vertices": [[0,0,0],[1,0,0],[0,0,1],[5,0,0],[6,0,0],[5,0,1],[1,0,1],[9,9,9]],
      "faces": [[3,4,5],[0,1,2],[1,6,2],[2,7,0]], "split_components": true})";
    const auto [s, origin] = read(scene(two));
    ASSERT_EQ(s.bodies.size(), 2U);
    EXPECT_EQ(s.bodies[0].name, "body-0-part0");
    EXPECT_EQ(s.shapes[0].triangles.size(), 1U);
    EXPECT_EQ(s.shapes[0].vertices.size(), 3U);
    EXPECT_EQ(s.shapes[1].triangles.size(), 3U);
}

TEST(RigidIpc, ImportIsReadBackToTheSameBits) {
    const auto [s, origin] =
        read(scene(brick(R"("rotation": [12, 34, 56], "position": [0.1, 0.2, 0.3])") + ", " +
                   brick(R"("type": "kinematic", "angular_velocity": [1, 2, 3], "position": [9, 0, 0])")));
    std::ostringstream first, second;
    write_scene(first, s);
    write_scene(second, parse_scene(first.str(), "own", "."));
    EXPECT_EQ(first.str(), second.str());
}

TEST(RigidIpc, WhatChangesTheOutcomeIsRefusedWithItsPlace) {
    const std::string at = "f.json: /rigid_body_problem/rigid_bodies/0";
    EXPECT_EQ(refusal(scene("{}")), at + ": has neither a mesh nor vertices");
    EXPECT_EQ(refusal(scene(R"({"vertices": [[0,0,0]]})")),
              at + ": shape 'body-0': all its points lie at one place: it has no size");
    EXPECT_EQ(refusal(scene(R"({"vertices": [[0,0,0],[1,0,0]], "edges": [[0,2]]})")),
              at + ": an edge must join two of the vertices");
    EXPECT_EQ(
        refusal(scene(R"({"mesh": "nowhere.obj"})")),
        at + "/mesh: \"nowhere.obj\": was found neither beside the scene nor in a folder \"meshes\" there or above");
    EXPECT_EQ(refusal("{\"scene_type\": \"particles_problem\", \"rigid_body_problem\": {}}")
                  .find("f.json: /scene_type: \"particles_problem\" is not supported"),
              0U);
}

TEST(RigidIpc, EdgesAndPointsAreBodiesOfTheirOwn) {
    const auto [s, origin] = read(scene(
        R"({"vertices": [[0,0,0],[2,0,0],[0,0,1],[5,5,5]], "faces": [[0,1,2]], "edges": [[0,1],[1,3]], "density": 3},
                      {"vertices": [[0,9,0],[2,9,0],[2,9,1]], "edges": [[0,1],[2,1]], "density": 3},
                      {"vertices": [[0,19,0],[2,19,0],[2,19,1]], "density": 3})"));
    ASSERT_EQ(s.shapes.size(), 3U);
    EXPECT_EQ(s.shapes[0].triangles, (std::vector<Triangle>{{0, 1, 2}, segment_element(1, 3)}))
        << "the edge of a face is there already, and a vertex of an edge is no point";
    EXPECT_EQ(s.shapes[0].mass_kind, MassKind::surface_density);
    EXPECT_EQ(s.shapes[1].triangles, (std::vector<Triangle>{segment_element(0, 1), segment_element(1, 2)}));
    EXPECT_EQ(s.shapes[1].mass_kind, MassKind::line_density);
    EXPECT_EQ(s.shapes[1].mass_value, 3);
    EXPECT_EQ(s.shapes[2].triangles, (std::vector<Triangle>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}));
    EXPECT_EQ(s.shapes[2].mass_kind, MassKind::mass);
    EXPECT_EQ(s.shapes[2].mass_value, 9) << "of each point";
    ASSERT_EQ(origin.warnings.size(), 3U);
    EXPECT_NE(origin.warnings[1].find("the density 3 is taken as kg/m of its edges"), std::string::npos);
    EXPECT_NE(origin.warnings[2].find("the density 3 is taken as kg of each point"), std::string::npos);
}

TEST(RigidIpc, GroupsOfWhatNeverMeetsChangeNothing) {
    const auto ghosts =
        read(scene(brick(R"("group_id": 3)") + ", " + brick(R"("group_id": 3, "position": [9,0,0])"))).scene;
    EXPECT_EQ(ghosts.bodies[0].group, "group 3");
    EXPECT_EQ(ghosts.ignored_groups, (std::vector<NamedPair>{{"group 3", "group 3"}}));
    const auto [s, origin] = read(scene(brick(R"("group_id": 0, "type": "static")") + ", " +
                                        brick(R"("group_id": 0, "is_dof_fixed": true)") + ", " +
                                        brick(R"("group_id": 1, "position": [9,0,0])")));
    EXPECT_EQ(s.bodies.size(), 3U);
    EXPECT_TRUE(origin.warnings.empty());
}

TEST(RigidIpc, EveryProblemOnceAndAtItsPlaceInTheFile) {
    EXPECT_EQ(
        refusal(scene(brick(R"("position": [1e10, 0, 0], "linear_velocity": [0, "fast", 0], "density": -1)"),
                      R"("coefficient_friction": -1, )")),
        "f.json: /rigid_body_problem/rigid_bodies/0/linear_velocity/1: must be a number, got the string \"fast\"\n"
        "f.json: /rigid_body_problem/coefficient_friction: must be in 0 .. 1000, got -1\n"
        "f.json: /rigid_body_problem/rigid_bodies/0/density: must be in 1e-12 .. 1e+15 kg/m^3, got -1\n"
        "f.json: /rigid_body_problem/rigid_bodies/0/position: component 1e+10 exceeds the limit of 1e+09 m");
    EXPECT_EQ(refusal("{\"timestep\": 0, \"rigid_body_problem\": {}}"), "f.json: /timestep: must be positive, got 0");
    EXPECT_EQ(
        refusal(scene(brick(R"("type": "kinematic", "angular_velocity": [0, 1, 0])"), "", R"("max_time": 1e6, )")),
        "f.json: /rigid_body_problem/rigid_bodies/0/angular_velocity: needs 5e+07 keyframes, one a step; all scripts "
        "together may have 1e+06");
    EXPECT_EQ(
        refusal(scene(brick(R"("type": "kinematic", "angular_velocity": [0, 7, 1e300])"))),
        "f.json: /rigid_body_problem/rigid_bodies/0/angular_velocity: component 1.7453292519943297e+298 exceeds the "
        "limit of 1e+06 rad/s");
    EXPECT_EQ(refusal(scene(brick(R"("type": "kinematic", "kinematic_poses": [{"rotation": [1e300, 0, 0]}])"))),
              "f.json: /rigid_body_problem/rigid_bodies/0/kinematic_poses/0/rotation: component 1e+300 "
              "exceeds the limit of 1e+15 rad");
    EXPECT_EQ(refusal("{\"rigid_body_problem\": 3}"), "f.json: /rigid_body_problem: must be an object, got 3");
}

TEST(RigidIpc, WhatItIgnoresIsNamed) {
    const auto [s, origin] =
        read(scene(brick(R"("postion": [9,0,0], "#torque": [1,0,0])"), R"("coefficient_restitution": 0.5, )",
                   R"("#note": 1, "distance_barrier_constraint": {"minimum_separation_distance": 0.001}, )"));
    ASSERT_EQ(origin.warnings.size(), 3U);
    EXPECT_EQ(origin.warnings[0].find("f.json: /distance_barrier_constraint/minimum_separation_distance: ignored"), 0U);
    EXPECT_EQ(origin.warnings[1],
              "f.json: /rigid_body_problem/coefficient_restitution: ignored, as Rigid-IPC does in 3-D");
    EXPECT_EQ(origin.warnings[2], "f.json: /rigid_body_problem/rigid_bodies/0/postion: unknown key \"postion\"; did "
                                  "you mean \"position\"?; ignored, as Rigid-IPC does");
}

TEST(RigidIpc, MeshesAreFoundBesideTheSceneAndInFoldersAbove) {
    const test::TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "fixtures/3D");
    std::filesystem::create_directories(folder.path() / "meshes/sub");
    (void)folder.write("meshes/sub/quad.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n");
    (void)folder.write("meshes/line.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
    (void)folder.write("meshes/both.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nf 1 2 3\nl 1 2\n");
    const std::string file = folder.write("fixtures/3D/s.json", scene(R"({"mesh": "sub/quad.obj", "type": "static"})"));
    const SceneDescription s = read_scene(file);
    EXPECT_EQ(s.shapes[0].triangles.size(), 2U);
    EXPECT_EQ(s.bodies[0].name, "quad-0");
    EXPECT_TRUE(s.shapes[0].mesh_path.empty()) << "scaled and turned: the scene holds its vertices";
    (void)folder.write("meshes/cloud.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\n");
    for (const auto& [mesh, elements] :
         {std::pair{"line.obj", std::vector<Triangle>{segment_element(0, 1)}},
          std::pair{"both.obj", std::vector<Triangle>{{0, 1, 2}, segment_element(0, 1)}},
          std::pair{"cloud.obj", std::vector<Triangle>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}}}) {
        (void)folder.write("fixtures/3D/s.json", scene(std::string(R"({"mesh": ")") + mesh + "\"}"));
        EXPECT_EQ(read_scene(file).shapes[0].triangles, elements) << mesh;
    }
}

TEST(RigidIpc, ReadsItsOwnScenes) {
    const std::filesystem::path folder = std::filesystem::path(FLOTILLA_TEST_DATA) / "rigid_ipc" / "fixtures" / "3D";
    if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << folder << " is missing";
    int read = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().extension() != ".json") continue;
        EXPECT_FALSE(read_scene(entry.path()).bodies.empty()) << entry.path();
        ++read;
    }
    EXPECT_EQ(read, 31);
}

} // namespace
} // namespace flotilla
