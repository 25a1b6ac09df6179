// SPDX-License-Identifier: MIT
// Every change of a World between steps: what it does, what it refuses, and that a refusal leaves everything as it was.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>

#include "api/audited_world.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::test {
namespace {

using testing::HasSubstr;

constexpr double kHalf = 0.5;

ShapeDescription shape_of(const char* name, TriangleMesh mesh, double mass) {
    ShapeDescription shape;
    shape.name = name;
    shape.vertices = std::move(mesh.vertices);
    shape.triangles = std::move(mesh.triangles);
    if (mass > 0) shape.mass_kind = MassKind::mass, shape.mass_value = mass;
    return shape;
}

/// A floor of 40 m at z = 0 and a crate of 1 m and 2 kg that stands on it.
SceneDescription crate_on_floor() {
    SceneDescription scene;
    scene.shapes = {shape_of("crate", make_box(1, 1, 1), 2), shape_of("floor", make_plate(40, 40), 0),
                    shape_of("massless", make_box(1, 1, 1), 0)};
    scenario::add_body(scene, 1, BodyType::fixed, {}).name = "floor";
    scenario::add_body(scene, 0, BodyType::dynamic, {0, 0, kHalf + 0.004}).name = "crate";
    return scene;
}

BodyDescription crate_at(const Vec3& position, const char* name = "") {
    BodyDescription body;
    body.name = name;
    body.position = position;
    return body;
}

/// What the edit is refused with; it must leave every bit as it was.
template <class Failure, class Edit>
std::string refusal(World& world, Edit&& edit) {
    const std::uint64_t hash = world.state_hash();
    const std::vector<std::byte> before = world.snapshot();
    std::string message = "(accepted)";
    try {
        edit();
    } catch (const Failure& e) {
        message = e.what();
    }
    EXPECT_EQ(world.state_hash(), hash) << message;
    EXPECT_TRUE(world.snapshot() == before) << message;
    return message;
}

void run(AuditedWorld& w, int steps) {
    for (int i = 0; i < steps; ++i) ASSERT_EQ(w.step(), "");
}

double height(const World& world, BodyId body) { return world.body(static_cast<std::size_t>(body.index)).position.z; }

TEST(WorldEdit, AddedBodiesFallAndRestOnWhatIsThere) {
    AuditedWorld w(crate_on_floor());
    run(w, 30);
    const BodyId crate = w.world.find("crate"), added = w.world.add_body(crate_at({0.2, 0.1, 2.5}, "second"));
    EXPECT_EQ(added, (BodyId{2, 0}));
    EXPECT_EQ(w.world.name(added), "second");
    EXPECT_EQ(w.world.num_bodies(), 3u);
    EXPECT_EQ(w.world.ids(), (std::vector<BodyId>{{0, 0}, crate, added}));
    run(w, 90);
    EXPECT_NEAR(height(w.world, added), 1.5 + 0.02, 0.03);
    EXPECT_NEAR(height(w.world, crate), kHalf + 0.01, 0.02);
}

TEST(WorldEdit, AddingRefusesWhatASceneWouldRefuse) {
    World world(crate_on_floor());
    for (int i = 0; i < 3; ++i) (void)world.step();
    const auto refused = [&](BodyDescription body) {
        return refusal<InputError>(world, [&] { world.add_body(body); });
    };
    EXPECT_THAT(refused(crate_at({0, 0, 3}, "crate")), HasSubstr("there is one of that name"));
    EXPECT_THAT(refused(crate_at({0, 0, std::nan("")})), HasSubstr("/position: must be finite"));
    BodyDescription body = crate_at({0, 0, 3});
    body.shape = 9;
    EXPECT_THAT(refused(body), HasSubstr("shape 9 does not exist"));
    body.shape = 2;
    EXPECT_THAT(refused(body), HasSubstr("has no mass"));
    body.shape = 0;
    body.rotation = {2, 0, 0, 0};
    EXPECT_THAT(refused(body), HasSubstr("must be a unit quaternion"));
    body.rotation = {};
    body.position = {1e10, 0, 3};
    EXPECT_THAT(refused(body), HasSubstr("exceeds the limit"));
    body.position = {0, 0, 3};
    body.friction = -1;
    EXPECT_THAT(refused(body), HasSubstr("/friction"));
}

TEST(WorldEdit, WhatWouldIntersectIsRefusedByName) {
    World world(crate_on_floor());
    const auto overlap = [&](auto&& edit) { return refusal<OverlapError>(world, edit); };
    EXPECT_EQ(overlap([&] {
                  world.add_body(crate_at({0.9, 0, 0.6}, "b"));
              }),
              "body \"b\" would intersect body \"crate\"");
    EXPECT_THAT(overlap([&] { world.add_body(crate_at({0.9, 0, 0.3}, "b")); }), HasSubstr("body \"floor\""));
    EXPECT_EQ(overlap([&] {
                  world.set_pose(world.find("crate"), {0, 0, 0.2}, {});
              }),
              "body \"crate\" would intersect body \"floor\"");
    try {
        world.add_body(crate_at({0.9, 0, 0.6}, "b"));
        FAIL();
    } catch (const OverlapError& e) {
        ASSERT_EQ(e.pairs().size(), 1u);
        EXPECT_EQ(e.pairs()[0].name_a, "crate");
        EXPECT_EQ(e.pairs()[0].name_b, "b");
        EXPECT_EQ(e.pairs()[0].a, 1);
    }
}

TEST(WorldEdit, RemovedBodiesHoldNothingUpAndTheirIdsAreRefused) {
    AuditedWorld w(crate_on_floor());
    const BodyId lower = w.world.find("crate"), upper = w.world.add_body(crate_at({0, 0, 1.52}, "upper"));
    StepReport report;
    for (int i = 0; i < 60; ++i) ASSERT_EQ(w.step(&report), "");
    ASSERT_EQ(report.sleeping, 2) << "at rest before";
    w.world.remove_body(lower);
    EXPECT_FALSE(w.world.contains(lower));
    EXPECT_EQ(w.world.num_bodies(), 2u);
    EXPECT_THAT(refusal<InputError>(w.world, [&] { w.world.remove_body(lower); }), HasSubstr("was removed"));
    EXPECT_THAT(refusal<InputError>(w.world, [&] { (void)w.world.find("crate"); }), HasSubstr("there is no body"));
    EXPECT_THAT(refusal<InputError>(w.world,
                                    [&] {
                                        w.world.set_velocity({7, 0}, {}, {});
                                    }),
                HasSubstr("does not exist"));
    run(w, 60);
    EXPECT_NEAR(height(w.world, upper), kHalf + 0.01, 0.02) << "fell on the floor";
    const BodyId next = w.world.add_body(crate_at({5, 0, 2}, "crate")); // the name is free again, and so is the place
    EXPECT_EQ(next, (BodyId{lower.index, lower.generation + 1}));
    EXPECT_FALSE(w.world.contains(lower));
    run(w, 5);
}

TEST(WorldEdit, PosesAreSetAndVelocitiesStay) {
    AuditedWorld w(crate_on_floor());
    const BodyId crate = w.world.find("crate");
    w.world.set_velocity(crate, {0, 0, 2}, {0, 0, 3});
    w.world.set_pose(crate, {3, 0, 4}, {std::sqrt(0.5), 0, std::sqrt(0.5), 0});
    const BodyState state = w.world.body(1);
    EXPECT_EQ(state.position, (Vec3{3, 0, 4}));
    EXPECT_EQ(state.velocity, (Vec3{0, 0, 2}));
    EXPECT_NEAR(state.angular_velocity.z, 3, 1e-12);
    run(w, 60);
    EXPECT_NEAR(height(w.world, crate), kHalf + 0.01, 0.02);
}

TEST(WorldEdit, ImpulsesChangeMomentumByWhatTheyAre) {
    SceneDescription scene = crate_on_floor();
    scene.gravity = {};
    World world(scene);
    const BodyId crate = world.find("crate");
    world.apply_impulse(crate, {0, 0, 6}, {0.5, 0, kHalf});
    const BodyState state = world.body(1);
    EXPECT_NEAR(state.velocity.z, 3, 1e-14);
    const double inertia = 2 * (1.0 / 6) * (5.0 / 3); // a shell of six plates
    EXPECT_NEAR(state.angular_velocity.y, -3 / inertia, 1e-9);
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.apply_impulse(world.find("floor"), {1, 0, 0}, {});
                                    }),
                HasSubstr("is not dynamic"));
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.apply_impulse(crate, {1e14, 0, 0}, {});
                                    }),
                HasSubstr("velocity after the impulse"));
}

TEST(WorldEdit, ForcesActForAStepOrUntilTheyAreSet) {
    SceneDescription scene = crate_on_floor();
    scene.gravity = {};
    World world(scene);
    const BodyId crate = world.find("crate");
    const double dt = world.settings().time_step;
    world.apply_force(crate, {6, 0, 0}, world.body(1).center_of_mass);
    world.apply_force(crate, {0, 4, 0}, world.body(1).center_of_mass); // they add up
    (void)world.step();
    EXPECT_NEAR(world.body(1).velocity.x, 3 * dt, 1e-14);
    EXPECT_NEAR(world.body(1).velocity.y, 2 * dt, 1e-14);
    (void)world.step();
    EXPECT_NEAR(world.body(1).velocity.x, 3 * dt, 1e-14) << "for one step";
    world.set_force(crate, {0, 0, 2}, {});
    for (int k = 0; k < 10; ++k) (void)world.step();
    EXPECT_NEAR(world.body(1).velocity.z, 10 * dt, 1e-13);
    world.set_force(crate, {}, {});
    (void)world.step();
    EXPECT_NEAR(world.body(1).velocity.z, 10 * dt, 1e-13);
    world.apply_torque(crate, {0, 0, 5});
    const StepReport r = world.step();
    EXPECT_GT(world.body(1).angular_velocity.z, 0.1);
    EXPECT_EQ(r.energy_corrections, 0);
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.set_force(world.find("floor"), {1, 0, 0}, {});
                                    }),
                HasSubstr("not dynamic"));
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.apply_torque(world.find("floor"), {1, 0, 0});
                                    }),
                HasSubstr("is not dynamic"));
}

TEST(WorldEdit, LoadsAreRefusedAsInAScene) {
    World world(crate_on_floor());
    const BodyId crate = world.find("crate");
    EXPECT_THAT(refusal<InputError>(world, [&] { world.set_force(crate, {1e8, 0, 0}, {}); }), HasSubstr("accelerates"));
    EXPECT_THAT(refusal<InputError>(world, [&] { world.set_force(crate, {}, {0, 0, 1e9}); }), HasSubstr("may turn"));
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.apply_force(crate, {1e8, 0, 0}, {0, 0, kHalf});
                                    }),
                HasSubstr("\"crate\""));
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.apply_force(crate, {1, 0, 0}, {0, std::nan(""), 0});
                                    }),
                HasSubstr("torque on body \"crate\""));
    EXPECT_THAT(refusal<InputError>(world, [&] { world.apply_torque(crate, {0, 1e9, 0}); }), HasSubstr("may turn"));
    world.apply_force(crate, {1.5e6, 0, 0}, {0, 0, kHalf + 0.004});
    EXPECT_THAT(refusal<InputError>(world,
                                    [&] {
                                        world.set_force(crate, {1.5e6, 0, 0}, {});
                                    }),
                HasSubstr("accelerates"));
    EXPECT_THAT(refusal<InputError>(world, [&] { world.set_force(world.find("floor"), {}, {}); }),
                HasSubstr("not dynamic"));
    BodyDescription pushed = crate_at({0, 0, 5});
    pushed.force = {0, 0, 1e8};
    EXPECT_THAT(refusal<InputError>(world, [&] { (void)world.add_body(pushed); }), HasSubstr("accelerates"));
}

TEST(WorldEdit, LockedAxesStayLocked) {
    SceneDescription scene = crate_on_floor();
    scene.gravity = {};
    scene.bodies[1].locked_translation = {true, false, true};
    scene.bodies[1].locked_rotation = {true, true, false};
    World world(scene);
    const BodyId crate = world.find("crate");
    world.apply_impulse(crate, {2, 2, 2}, world.body(1).center_of_mass);
    world.apply_torque(crate, {3, 3, 3});
    EXPECT_EQ(world.body(1).velocity, (Vec3{0, 1, 0}));
    world.set_pose(crate, {1, 2, 3}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)});
    World restored(scene, world.snapshot());
    for (int k = 0; k < 10; ++k) ASSERT_EQ(restored.step().state_hash, world.step().state_hash) << k;
    EXPECT_EQ(world.body(1).position.x, 1);
    EXPECT_EQ(world.body(1).position.z, 3);
    EXPECT_GT(world.body(1).angular_velocity.z, 0.1);
    EXPECT_EQ(world.body(1).angular_velocity.x, 0);
    EXPECT_THAT(refusal<InputError>(world, [&] { world.set_velocity(crate, {1, 0, 0}, {}); }), HasSubstr("/velocity"));
}

// A slider that is stopped for a while, as a fixture or by a script, goes on as it did: on its rail, under its load.
TEST(WorldEdit, WhatIsDynamicAgainHasItsLocksAndForcesBack) {
    for (const bool by_script : {false, true}) {
        SceneDescription scene = crate_on_floor();
        scene.gravity = {};
        scene.bodies[1].position.z = 5;
        scene.bodies[1].locked_translation = {true, false, false};
        scene.bodies[1].locked_rotation = {false, false, true};
        World world(scene);
        const BodyId crate = world.find("crate");
        world.set_force(crate, {3, 2, 0}, {0, 0.1, 0});
        if (by_script)
            world.set_script(crate, {{1, {0, 1, 5}, {}}});
        else
            world.set_type(crate, BodyType::fixed);
        EXPECT_EQ(world.description(crate).force, Vec3{});
        (void)world.step();
        World resumed(scene, world.snapshot());
        for (World* w : {&world, &resumed}) {
            w->set_type(crate, BodyType::dynamic);
            const BodyDescription body = w->description(crate);
            EXPECT_EQ(body.locked_translation, (std::array{true, false, false}));
            EXPECT_EQ(body.locked_rotation, (std::array{false, false, true}));
            EXPECT_EQ(body.force, (Vec3{3, 2, 0}));
            EXPECT_EQ(body.torque, (Vec3{0, 0.1, 0}));
            const double before = w->time();
            for (int i = 0; i < 24; ++i) (void)w->step();
            const BodyState state = w->body(static_cast<std::size_t>(crate.index));
            EXPECT_EQ(state.velocity.x, 0);
            EXPECT_NEAR(state.velocity.y, 2.0 / 2 * (w->time() - before), 1e-12);
        }
        EXPECT_EQ(world.state_hash(), resumed.state_hash());
        world.set_force(crate, {}, {});
        world.set_type(crate, BodyType::fixed);
        world.set_type(crate, BodyType::dynamic);
        EXPECT_EQ(world.description(crate).force, Vec3{});
    }
}

TEST(WorldEdit, TypesChange) {
    AuditedWorld w(crate_on_floor());
    const BodyId crate = w.world.find("crate"), floor = w.world.find("floor");
    w.world.set_pose(crate, {0, 0, 3}, {});
    w.world.set_type(crate, BodyType::fixed);
    run(w, 5);
    EXPECT_EQ(height(w.world, crate), 3);
    EXPECT_THAT(refusal<InputError>(w.world, [&] { w.world.set_type(floor, BodyType::dynamic); }),
                HasSubstr("has no mass"));
    EXPECT_THAT(refusal<InputError>(w.world, [&] { w.world.set_type(crate, BodyType::kinematic); }),
                HasSubstr("set_script"));
    w.world.set_type(crate, BodyType::dynamic);
    run(w, 60);
    EXPECT_NEAR(height(w.world, crate), kHalf + 0.01, 0.02);
    // Bodies of infinite mass may intersect; what moves may not.
    BodyDescription inside = crate_at({0, 0, 0.2}, "inside");
    inside.shape = 0;
    inside.position = {10, 0, 0.2};
    inside.type = BodyType::fixed;
    const BodyId block = w.world.add_body(inside);
    EXPECT_THAT(refusal<OverlapError>(w.world, [&] { w.world.set_type(block, BodyType::dynamic); }),
                HasSubstr("\"inside\" would intersect body \"floor\""));
}

TEST(WorldEdit, ScriptsTakeOverFromWhereABodyIs) {
    AuditedWorld w(crate_on_floor());
    run(w, 4);
    const BodyId crate = w.world.find("crate");
    const double now = w.world.time(), before = height(w.world, crate);
    EXPECT_THAT(refusal<InputError>(w.world,
                                    [&] {
                                        w.world.set_script(crate, {{now, {}, {}}});
                                    }),
                HasSubstr("is not later than the time"));
    w.world.set_script(crate, {{now + 1, {2, 0, 2}, {}}, {now + 2, {2, 0, 4}, {}}});
    EXPECT_EQ(height(w.world, crate), before);
    run(w, 12);
    EXPECT_NEAR(height(w.world, crate), before + 0.5 * (2 - before), 0.02);
    run(w, 40);
    EXPECT_NEAR(height(w.world, crate), 4, 1e-12);
    EXPECT_THAT(refusal<InputError>(w.world, [&] { w.world.set_pose(crate, {0, 0, 9}, {}); }), HasSubstr("its script"));
    w.world.set_script(crate, {{w.world.time() + 0.5, {2, 0, 3}, {}}});
    run(w, 20);
    EXPECT_NEAR(height(w.world, crate), 3, 1e-12);
    w.world.set_type(crate, BodyType::dynamic);
    run(w, 60);
    EXPECT_NEAR(height(w.world, crate), kHalf + 0.01, 0.02);
}

TEST(WorldEdit, MaterialsAndGravityCountFromTheNextStep) {
    SceneDescription scene = crate_on_floor();
    World world(scene);
    const BodyId crate = world.find("crate"), floor = world.find("floor");
    StepReport report;
    for (int i = 0; i < 40; ++i) report = world.step();
    ASSERT_EQ(report.sleeping, 1);
    world.set_gravity(scene.gravity);
    EXPECT_EQ(world.step().sleeping, 1) << "the same gravity wakes nobody";
    world.set_material(crate, 0.5, 0);
    world.set_material(floor, 0.5, 0);
    world.set_gravity({4, 0, -9.8}); // tan is 0.41: it stays
    for (int i = 0; i < 24; ++i) (void)world.step();
    EXPECT_NEAR(world.body(1).position.x, 0, 1e-6);
    world.set_material(crate, 0, 0);
    for (int i = 0; i < 24; ++i) (void)world.step();
    EXPECT_NEAR(world.body(1).velocity.x, 4, 0.01);
    EXPECT_THAT(refusal<InputError>(world, [&] { world.set_material(crate, -1, 0); }), HasSubstr("/friction"));
    EXPECT_THAT(refusal<InputError>(world, [&] { world.set_gravity({0, 0, 1e9}); }), HasSubstr("gravity"));
}

TEST(WorldEdit, GroupsAndPairsPassThroughEachOther) {
    SceneDescription scene = crate_on_floor();
    scene.bodies[1].group = "ghosts";
    scene.ignored_groups = {{"ghosts", "ghosts"}};
    AuditedWorld w(scene);
    BodyDescription above = crate_at({0.1, 0, 3}, "above");
    above.group = "ghosts";
    const BodyId falling = w.world.add_body(above), crate = w.world.find("crate");
    w.ignored = [](const std::string& a, const std::string& b) { return a != "floor" && b != "floor"; };
    run(w, 60);
    EXPECT_NEAR(height(w.world, falling), kHalf + 0.01, 0.02) << "through the crate";
    EXPECT_THAT(refusal<OverlapError>(w.world, [&] { w.world.set_group(falling, ""); }), HasSubstr("intersect"));
    EXPECT_THAT(refusal<OverlapError>(w.world, [&] { w.world.ignore_groups("ghosts", "ghosts", false); }),
                HasSubstr("intersect"));
    w.world.ignore_pair(falling, crate);
    w.world.set_group(falling, "");
    run(w, 20);
    EXPECT_NEAR(height(w.world, falling), kHalf + 0.01, 0.02);
    w.world.set_pose(falling, {0, 0, 4}, {});
    w.world.ignore_pair(falling, crate, false);
    w.ignored = {};
    run(w, 70);
    EXPECT_NEAR(height(w.world, falling), 1.5 + 0.02, 0.03) << "on the crate";
}

TEST(WorldEdit, GroupsThatNobodyIgnoresWakeNobodyAndChangeNoBits) {
    SceneDescription scene = crate_on_floor();
    scene.bodies[1].group = "crates";
    scene.settings.sleeping = true;
    scenario::add_body(scene, 0, BodyType::dynamic, {4, 0, kHalf + 0.004}).name = "other";
    World world(scene);
    while (world.step().sleeping < 2 && world.steps() < 200) {
    }
    ASSERT_LT(world.steps(), 200);
    world.remove_body(world.find("other"));
    EXPECT_EQ(world.step().sleeping, 1) << "far away";
    World restored(scene, world.snapshot());
    for (World* w : {&world, &restored}) (void)w->add_body(crate_at({-6, 0, 5}, "new"));
    EXPECT_EQ(world.state_hash(), restored.state_hash());
    for (World* w : {&world, &restored}) EXPECT_EQ(w->step().sleeping, 1);
    EXPECT_EQ(world.state_hash(), restored.state_hash());
}

// Who may meet whom is of the bodies that are named, and of nobody else.
TEST(WorldEdit, FiltersWakeTheirOwnBodies) {
    SceneDescription scene = crate_on_floor();
    for (const double x : {-6.0, -3.0, 3.0, 6.0})
        scenario::add_body(scene, 0, BodyType::dynamic, {x, 0, kHalf + 0.004}).name = "crate " + std::to_string(x);
    scene.bodies[2].group = "left", scene.bodies[3].group = "left", scene.bodies[4].group = "right";
    World world(scene);
    const auto sleepers = [&] {
        int sleeping = 0;
        for (int i = 0; i < 60; ++i) sleeping = static_cast<int>(world.step().sleeping);
        return sleeping;
    };
    ASSERT_EQ(sleepers(), 5);
    const BodyId crate = world.find("crate");
    world.ignore_pair(crate, BodyId{5, 0});
    EXPECT_EQ(world.step().sleeping, 3);
    ASSERT_EQ(sleepers(), 5);
    world.ignore_groups("left", "right");
    EXPECT_EQ(world.step().sleeping, 2);
    ASSERT_EQ(sleepers(), 5);
    world.set_group(BodyId{4, 0}, "");
    EXPECT_EQ(world.step().sleeping, 4);
    ASSERT_EQ(sleepers(), 5);
    world.remove_body(BodyId{5, 0});
    EXPECT_EQ(world.step().sleeping, 4) << "who was ignored with it sleeps on";
    BodyDescription right = crate_at({0, 9, kHalf + 0.004});
    right.group = "right";
    (void)world.add_body(right);
    EXPECT_EQ(world.step().sleeping, 4) << "the first of an ignored group";
    // What rests on one that it may now pass falls through it.
    world.ignore_pair(crate, world.find("floor"));
    for (int i = 0; i < 10; ++i) (void)world.step();
    EXPECT_LT(height(world, crate), kHalf - 0.5);
}

TEST(WorldEdit, AddedShapesAreLikeThoseOfTheScene) {
    AuditedWorld w(crate_on_floor());
    run(w, 2);
    const std::int32_t ball = w.add_shape(shape_of("ball", make_sphere(0.5, 2), 3));
    EXPECT_EQ(ball, 3);
    EXPECT_THAT(refusal<InputError>(w.world, [&] { w.world.add_shape(shape_of("ball", make_sphere(0.5, 2), 3)); }),
                HasSubstr("there is one of that name"));
    EXPECT_THAT(refusal<InputError>(w.world, [&] { w.world.add_shape(shape_of("none", {}, 3)); }),
                HasSubstr("at least one triangle"));
    BodyDescription body = crate_at({4, 0, 2}, "ball");
    body.shape = ball;
    const BodyId id = w.world.add_body(body);
    run(w, 60);
    EXPECT_NEAR(height(w.world, id), 0.5, 0.03);
}

TEST(WorldEdit, ShapesWithoutANameGetOneAndAreFoundByIt) {
    World world(crate_on_floor());
    const std::int32_t first = world.add_shape(shape_of("", make_sphere(0.5, 2), 3)),
                       second = world.add_shape(shape_of("", make_sphere(0.4, 2), 3));
    EXPECT_EQ(std::pair(first, second), std::pair(3, 4));
    EXPECT_EQ(world.num_shapes(), 5U);
    EXPECT_EQ(world.shape(first).name, "shape3");
    EXPECT_EQ(world.find_shape("shape4"), second);
    EXPECT_THAT(refusal<InputError>(world, [&] { (void)world.find_shape("shape5"); }), HasSubstr("\"shape5\""));
    EXPECT_THAT(refusal<InputError>(world, [&] { (void)world.shape(5); }), HasSubstr("does not exist"));
}

TEST(WorldEdit, ShapesAreLetGoOf) {
    const SceneDescription scene = crate_on_floor();
    AuditedWorld w(scene);
    World& world = w.world;
    run(w, 2);
    const std::int32_t ball = w.add_shape(shape_of("ball", make_sphere(0.5, 2), 3)),
                       other = w.add_shape(shape_of("other", make_sphere(0.4, 2), 3));
    BodyDescription body = crate_at({4, 0, 2}, "of ball");
    body.shape = ball;
    const BodyId id = world.add_body(body);
    body = crate_at({-4, 0, 2}, "of other");
    body.shape = other;
    (void)world.add_body(body);
    const auto refused = [&](std::int32_t shape) {
        return refusal<InputError>(world, [&] { world.remove_shape(shape); });
    };
    EXPECT_THAT(refused(ball), HasSubstr("removing shape \"ball\": body \"of ball\" has it"));
    EXPECT_THAT(refused(0), HasSubstr("of the scene"));
    EXPECT_THAT(refused(5), HasSubstr("does not exist"));
    const std::vector<std::byte> with_both = world.snapshot();
    const std::uint64_t hash_with_both = world.state_hash();
    world.remove_body(id);
    const std::size_t before = world.memory().shapes;
    world.remove_shape(ball);
    EXPECT_LT(world.memory().shapes, before);
    EXPECT_THAT(refused(ball), HasSubstr("shape 3 was removed"));
    body.name = "again";
    body.shape = ball;
    body.position = {4, 0, 2};
    EXPECT_THAT(refusal<InputError>(world, [&] { (void)world.add_body(body); }), HasSubstr("shape 3 was removed"));
    EXPECT_THAT(refusal<InputError>(world, [&] { (void)world.overlapping(ball, {}, {}); }), HasSubstr("removed"));
    EXPECT_THAT(refusal<InputError>(world, [&] { (void)world.find_shape("ball"); }), HasSubstr("\"ball\""));
    EXPECT_EQ(std::pair(world.contains_shape(ball), world.contains_shape(other)), std::pair(false, true));

    // The same bits from a snapshot and in a clone, before its number is given away and after.
    World restored(scene, world.snapshot()), copy = world.clone();
    const auto all = {&world, &restored, &copy};
    for (World* each : all) (void)each->step();
    for (World* each : all) EXPECT_EQ(each->add_shape(shape_of("ball", make_box(0.6, 0.5, 0.4), 3)), ball);
    for (World* each : all) (void)each->step();
    for (World* each : all) (void)each->add_body(body);
    World late(scene, world.snapshot());
    for (int i = 0; i < 40; ++i) {
        const std::uint64_t hash = world.step().state_hash;
        EXPECT_EQ(restored.step().state_hash, hash);
        EXPECT_EQ(copy.step().state_hash, hash);
        EXPECT_EQ(late.step().state_hash, hash);
    }
    EXPECT_NEAR(height(world, world.find("again")), 0.2, 0.03);
    EXPECT_NEAR(height(world, world.find("of other")), 0.4, 0.03);
    world.restore(with_both);
    EXPECT_EQ(world.state_hash(), hash_with_both);
    EXPECT_EQ(world.shape(ball).vertices.size(), shape_of("ball", make_sphere(0.5, 2), 3).vertices.size());
}

TEST(WorldEdit, BodiesThatAreResizedForEverTakeNoMoreMemory) {
    World world(crate_on_floor());
    std::size_t memory = 0, snapshot = 0;
    for (int i = 0; i < 60; ++i) {
        BodyDescription body = crate_at({4, 0, 2}, "resized");
        body.shape = world.add_shape(shape_of("", make_sphere(0.3 + 0.01 * (i % 7), 2), 3));
        const BodyId id = world.add_body(body);
        (void)world.step();
        world.remove_body(id);
        world.remove_shape(body.shape);
        if (i == 30) memory = world.memory().shapes, snapshot = world.snapshot().size();
    }
    EXPECT_EQ(world.memory().shapes, memory);
    EXPECT_LT(world.snapshot().size(), snapshot + snapshot / 10);
}

TEST(WorldEdit, ObserversEndAStepThatThenNeverWas) {
    World world(make_scene("boats-in-bowl", 12, 3));
    for (int i = 0; i < 20; ++i) (void)world.step();
    World other = world.clone();
    std::vector<Phase> seen;
    for (const Phase last : {Phase::collisions, Phase::half_static_contact, Phase::failsafe, Phase::static_contact}) {
        world.set_observer([&](Phase phase) { return phase != last; });
        EXPECT_THAT(refusal<StepCancelled>(world, [&] { (void)world.step(); }), HasSubstr("cancelled by its observer"));
    }
    world.set_observer([](Phase) -> bool { throw std::runtime_error("of the observer's own"); });
    EXPECT_EQ(refusal<std::runtime_error>(world, [&] { (void)world.step(); }), "of the observer's own");
    world.set_observer({});
    for (int i = 0; i < 20; ++i) ASSERT_EQ(world.step().state_hash, other.step().state_hash) << i;
}

TEST(WorldEdit, TheForceCallbackMayChangeTheWorldBeforeEachStep) {
    World world(crate_on_floor());
    int calls = 0;
    world.set_force_callback([&](World& w) {
        if (++calls == 3) throw std::runtime_error("third");
        w.apply_impulse(w.find("crate"), {1, 0, 0}, w.body(1).center_of_mass);
    });
    (void)world.step();
    (void)world.step();
    EXPECT_GT(world.body(1).velocity.x, 0.5);
    EXPECT_THROW((void)world.step(), std::runtime_error);
    EXPECT_EQ(world.steps(), 2);
    (void)world.step();
    EXPECT_EQ(world.steps(), 3);
}

TEST(WorldEdit, RecordedEditsLeadToWhereTheWorldIs) {
    const SceneDescription scene = crate_on_floor();
    World world(scene);
    const BodyId crate = world.find("crate");
    world.wake(crate); // before the record
    const std::vector<std::byte> start = world.snapshot();
    world.record_edits(true);
    world.set_velocity(crate, {1, 0, 0}, {});
    for (int i = 0; i < 5; ++i) (void)world.step();
    const std::vector<std::byte> fifth = world.snapshot();
    world.remove_body(crate);
    (void)world.step();
    const std::vector<std::byte> removed = world.snapshot();
    world.restore(fifth);
    ASSERT_EQ(world.recorded_edits().size(), 1u) << "what was undone is not in the record";
    world.set_velocity(crate, {0, 1, 0}, {});
    for (int i = 0; i < 5; ++i) (void)world.step();
    World again(scene);
    again.wake(crate);
    std::size_t next = 0;
    while (again.steps() < world.steps()) {
        for (; next < 2 && world.recorded_edits()[next].step == again.steps(); ++next)
            (void)again.apply(world.recorded_edits()[next]);
        (void)again.step();
    }
    EXPECT_EQ(again.state_hash(), world.state_hash());
    world.restore(removed);
    EXPECT_THROW((void)world.recorded_edits(), Error) << "edits of another branch";
    world.wake(world.find("floor"));
    const std::vector<std::byte> beyond = world.snapshot();
    world.restore(start);
    EXPECT_TRUE(world.recorded_edits().empty());
    world.restore(beyond);
    EXPECT_THROW((void)world.recorded_edits(), Error) << "what was done where the record did not lead is not in it";
    world.record_edits(true);
    EXPECT_TRUE(world.recorded_edits().empty());
}

TEST(WorldEdit, RecordsKnowAfterWhichStepAnEditWasMade) {
    const SceneDescription scene = crate_on_floor();
    World world(scene);
    const BodyId crate = world.find("crate");
    const std::vector<std::byte> start = world.snapshot();
    world.record_edits(true);
    world.set_velocity(crate, {1, 0, 0}, {});
    for (int i = 0; i < 5; ++i) (void)world.step();
    const std::vector<std::byte> at_once = world.snapshot();
    world.restore(start);
    (void)world.step();
    world.set_velocity(crate, {1, 0, 0}, {});
    ASSERT_EQ(world.recorded_edits().size(), 1u);
    world.restore(at_once);
    EXPECT_THROW((void)world.recorded_edits(), Error) << "the same edit, a step earlier";
    world.record_edits(true);
    world.wake(crate);
    world.record_edits(false);
    world.set_velocity(crate, {}, {});
    world.record_edits(true);
    EXPECT_TRUE(world.recorded_edits().empty()) << "one was made meanwhile";
}

TEST(WorldEdit, RefusalsAndWarningsAreLogged) {
    World world(crate_on_floor());
    std::vector<std::string> lines;
    world.set_log([&](const std::string& line) { lines.push_back(line); });
    EXPECT_THROW(world.add_body(crate_at({0, 0, 0.3}, "b")), OverlapError);
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_THAT(lines[0], HasSubstr("refused: body \"b\" would intersect"));
}

TEST(WorldEdit, ALogThatThrowsAfterAStepLeavesAWorldThatGoesOn) {
    SceneDescription scene = make_scene("boats-in-bowl", 16, 2);
    scene.settings.dynamic_pair_iterations = 1;
    scene.settings.collision_iterations = 1; // ends before it is quiet: a warning
    World world(scene), quiet(scene);
    int thrown = 0;
    world.set_log([](const std::string& line) { throw std::runtime_error(line); });
    for (int i = 0; i < 30; ++i) {
        const std::uint64_t expected = quiet.step().state_hash;
        try {
            (void)world.step();
        } catch (const std::runtime_error& e) {
            EXPECT_THAT(e.what(), HasSubstr("step " + std::to_string(i + 1) + ": "));
            ++thrown;
        }
        EXPECT_EQ(world.state_hash(), expected);
    }
    EXPECT_GT(thrown, 0);
}

} // namespace
} // namespace flotilla::test
