// SPDX-License-Identifier: MIT
// Scripts that would crush a body, by `unsatisfiable_script`: hold, follow, error.
#include "step/scripts.hpp"

#include <optional>

#include "base/rotation.hpp"
#include "state/build_model.hpp"
#include "step/scenario.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kSpeed = 1; // m/s, of jaws
constexpr std::size_t kCube = 0, kRight = 3;

BodyDescription& add_script(SceneDescription& scene, std::int32_t shape, std::vector<Keyframe> keyframes) {
    BodyDescription& body = add_body(scene, shape, BodyType::kinematic, keyframes.front().position);
    body.keyframes = std::move(keyframes);
    return body;
}

/// Two jaws that would meet in a cube of half a metre at 1 s, and open again by 2 s.
SceneDescription jaws(UnsatisfiableScript policy) {
    SceneDescription scene = empty_scene();
    scene.settings.unsatisfiable_script = policy;
    add_body(scene, add_shape(scene, make_box(0.5, 0.5, 0.5), 60), BodyType::dynamic, {0, 0, 0.26}).name = "cube";
    add_body(scene, add_shape(scene, make_box(20, 20, 0.2)), BodyType::fixed, {0, 0, -0.1}).name = "ground";
    const std::int32_t jaw = add_shape(scene, make_box(0.2, 2, 2));
    for (const double side : {-1.0, 1.0}) {
        const Vec3 open{side * 1.1, 0, 1.2}, shut{side * 0.1, 0, 1.2};
        add_script(scene, jaw, {{0, open, {}}, {1 / kSpeed, shut, {}}, {2 / kSpeed, open, {}}}).name =
            side < 0 ? "left" : "right";
    }
    return scene;
}

/// A stack of three boxes on the ground and a press that leaves no room for it at 1 s and is up again at 2 s.
SceneDescription press(UnsatisfiableScript policy) {
    SceneDescription scene = empty_scene();
    scene.settings.unsatisfiable_script = policy;
    const auto box = add_shape(scene, make_box(0.5, 0.5, 0.5), 60);
    for (int i = 0; i < 3; ++i) add_body(scene, box, BodyType::dynamic, {0, 0, 0.26 + 0.51 * i}, 0.5, 0);
    add_body(scene, add_shape(scene, make_box(20, 20, 0.2)), BodyType::fixed, {0, 0, -0.1}, 0.5, 0);
    const Vec3 up{0, 0, 3.1}, down{0, 0, 1.1};
    add_script(scene, add_shape(scene, make_box(2, 2, 0.2)), {{0, up, {}}, {1, down, {}}, {2, up, {}}}).name = "press";
    return scene;
}

struct Course {
    std::vector<Vec3> place, velocity;  ///< of one body, after every step
    std::int64_t delayed = 0, held = 0; ///< steps, and those with held bodies
    std::int64_t last_delayed = 0;      ///< step
};

/// Runs the scene and checks what holds in every step: no intersections, and the velocity is that of the way made.
Course watch(const SceneDescription& scene, std::size_t body, int steps) {
    World world(scene);
    Course out;
    const double dt = scene.settings.time_step;
    for (int n = 0; n < steps; ++n) {
        const BodyState before = world.body(body);
        const StepReport r = world.step();
        const BodyState after = world.body(body);
        const Vec3 made = (after.center_of_mass - before.center_of_mass) / dt;
        EXPECT_LT(length(after.velocity - made), 1e-12) << "step " << r.step;
        if (after.position == before.position) {
            EXPECT_EQ(after.velocity, Vec3{}) << "step " << r.step;
        }
        EXPECT_EQ(count_intersections(scene, world), 0) << "step " << r.step;
        out.place.push_back(after.position);
        out.velocity.push_back(after.velocity);
        out.held += r.held > 0 ? 1 : 0;
        if ((r.warnings & kScriptDelayed) == 0) continue;
        ++out.delayed;
        out.last_delayed = r.step;
    }
    return out;
}

double fastest(const Course& course) {
    double speed = 0;
    for (const Vec3& v : course.velocity) speed = std::max(speed, length(v));
    return speed;
}

TEST(UnsatisfiableScript, JawsThatAreHeldStayShut) {
    const Course right = watch(jaws(UnsatisfiableScript::hold), kRight, 72);
    EXPECT_GT(right.delayed, 40);
    EXPECT_LE(right.place.back().x, right.place[24].x) << "they may come nearer";
    EXPECT_NEAR(right.place.back().x, 0.35, 0.01);
    EXPECT_EQ(right.velocity.back(), Vec3{});
}

TEST(UnsatisfiableScript, JawsThatFollowOpenWithTheirScript) {
    const Course right = watch(jaws(UnsatisfiableScript::follow), kRight, 72);
    EXPECT_GT(right.delayed, 5);
    EXPECT_NEAR(right.place[23].x, 0.35, 0.01);     // shut, were it not for the cube
    for (std::size_t step = 36; step <= 48; ++step) // on their way out the script is 0.5 m and more from the middle
        EXPECT_NEAR(right.place[step - 1].x, 0.1 + kSpeed * (static_cast<double>(step) / 24 - 1), 1e-12) << step;
    EXPECT_EQ(right.place.back(), (Vec3{1.1, 0, 1.2}));
    EXPECT_LE(fastest(right), 2 * kSpeed * (1 + 1e-12));
}

TEST(UnsatisfiableScript, APressThatIsHeldComesLate) {
    const Course held = watch(press(UnsatisfiableScript::hold), 4, 60);
    EXPECT_GT(held.delayed, 20);
    EXPECT_LT(held.place.back().z, 1.7);
    const Course follows = watch(press(UnsatisfiableScript::follow), 4, 60);
    EXPECT_GT(follows.delayed, 0); // how often is up to how what it presses on gives way
    EXPECT_EQ(follows.place[47], (Vec3{0, 0, 3.1}));
    EXPECT_LE(fastest(follows), 2 * 2.0 * (1 + 1e-12));
}

/// A pusher on a way with a corner; a block between it and a gate, which opens at 1.5 s, stops it before that.
SceneDescription gated(UnsatisfiableScript policy) {
    SceneDescription scene = empty_scene();
    scene.settings.unsatisfiable_script = policy;
    const auto cube = add_shape(scene, make_box(0.4, 0.4, 0.4), 30), slab = add_shape(scene, make_box(0.2, 1, 1));
    add_body(scene, cube, BodyType::dynamic, {1, 0, 0.21}, 0.1, 0);
    add_body(scene, add_shape(scene, make_box(40, 40, 0.2)), BodyType::fixed, {0, 0, -0.1}, 0.1, 0);
    const Vec3 shut{1.4, 0, 0.6}, open{1.4, 0, 4.6};
    add_script(scene, slab, {{0, shut, {}}, {1.5, shut, {}}, {2, open, {}}});
    add_script(scene, slab, {{0, {0.3, 0, 0.6}, {}}, {2, {2.3, 0, 0.6}, {}}, {5, {2.3, 3, 0.6}, {}}});
    return scene;
}

TEST(UnsatisfiableScript, ABodyThatFollowsCatchesUpAlongItsPath) {
    const Course pusher = watch(gated(UnsatisfiableScript::follow), 3, 120);
    EXPECT_GT(pusher.delayed, 5);
    EXPECT_LT(pusher.place[35].x, 1.2);          // at 1.5 s it was due at 1.8 m
    EXPECT_LE(fastest(pusher), 2 * (1 + 1e-12)); // m/s; the script has 1
    EXPECT_GT(fastest(pusher), 1.9);
    for (const Vec3& p : pusher.place) // round the corner, which a step may cut
        EXPECT_TRUE(p.y == 0 || p.x > 2.3 - 2.0 / 24) << p.x << ' ' << p.y;
    EXPECT_EQ(pusher.place.back(), (Vec3{2.3, 3, 0.6}));
    const Course held = watch(gated(UnsatisfiableScript::hold), 3, 120);
    EXPECT_LT(held.place.back().y, 2.7);
    EXPECT_LE(fastest(held), 1 + 1e-12);
}

/// A pusher at 1 m/s behind a row of ten blocks, which a gate stops; it opens from 2 s on, if it does.
SceneDescription row(UnsatisfiableScript policy, bool opens) {
    SceneDescription scene = empty_scene();
    scene.settings.unsatisfiable_script = policy;
    const auto cube = add_shape(scene, make_box(0.4, 0.4, 0.4), 30), slab = add_shape(scene, make_box(0.2, 1, 1));
    for (int i = 0; i < 10; ++i) add_body(scene, cube, BodyType::dynamic, {0.43 * i, 0, 0.21}, 0.1, 0);
    add_body(scene, add_shape(scene, make_box(60, 60, 0.2)), BodyType::fixed, {0, 0, -0.1}, 0.1, 0);
    const Vec3 shut{4.4, 0, 0.6}, open{4.4, 0, 5.6};
    add_script(scene, slab, {{0, shut, {}}, {2, shut, {}}, {2.5, opens ? open : shut, {}}});
    add_script(scene, slab, {{0, {-0.4, 0, 0.6}, {}}, {10, {9.6, 0, 0.6}, {}}});
    return scene;
}
constexpr std::size_t kPusher = 12;

// Pushed on in every step the blocks would be held in every one, and nothing would rest by itself.
TEST(UnsatisfiableScript, AScriptThatIsStoppedTriesRarely) {
    const Course pusher = watch(row(UnsatisfiableScript::hold, false), kPusher, 144);
    EXPECT_GT(pusher.delayed, 100);
    EXPECT_LT(4 * pusher.held, pusher.delayed);
    EXPECT_NEAR(pusher.place.back().x, 0.2, 0.02) << "the row of 4 m is pushed together";
}

TEST(UnsatisfiableScript, AScriptThatWaitedIsSoonAtItsSpeed) {
    const Course pusher = watch(row(UnsatisfiableScript::hold, true), kPusher, 120);
    EXPECT_GT(pusher.delayed, 20);
    EXPECT_GT(pusher.last_delayed, 48);
    EXPECT_LE(pusher.last_delayed, 51 + 31) << "waits of at most 16, 8, 4, 2 and 1 steps";
    EXPECT_NEAR(length(pusher.velocity.back()), 1, 1e-12);
}

TEST(UnsatisfiableScript, AnEditThatMakesRoomEndsItsWait) {
    for (const bool removed : {true, false}) {
        SceneDescription scene = row(UnsatisfiableScript::hold, false);
        scene.bodies[kPusher - 1].type = BodyType::fixed;
        scene.bodies[kPusher - 1].keyframes.clear();
        World world(scene);
        const BodyId wall = world.id(kPusher - 1);
        for (int n = 0; n < 80; ++n) (void)world.step();
        EXPECT_EQ(world.body(kPusher).velocity, Vec3{});
        if (removed)
            world.remove_body(wall);
        else
            world.set_pose(wall, {4.4, 0, 5.6}, {});
        for (int n = 0; n < 2; ++n) (void)world.step(); // in the first it pushes the row into motion
        EXPECT_NEAR(length(world.body(kPusher).velocity), 1, 1e-12) << removed;
    }
}

// A marker that is put elsewhere in every step, far away, is nothing that stopped anything.
TEST(UnsatisfiableScript, EditsFarAwayEndNoWait) {
    SceneDescription scene = row(UnsatisfiableScript::hold, false);
    add_body(scene, add_shape(scene, make_box(1, 1, 1)), BodyType::fixed, {0, 0, 100}).name = "marker";
    World edited(scene), left_alone(scene);
    for (int n = 0; n < 60; ++n) {
        edited.set_pose(edited.find("marker"), {0, 0, 100.0 + n % 2}, {});
        EXPECT_EQ(edited.step().held, left_alone.step().held) << n;
    }
    EXPECT_EQ(edited.body(kPusher).position, left_alone.body(kPusher).position);
}

/// The jaws close on a cube in the air, whose support then goes away.
SceneDescription grip(std::string_view name, double time_step) {
    SceneDescription scene = jaws(UnsatisfiableScript::hold);
    scene.settings = preset(name);
    scene.settings.time_step = time_step;
    scene.bodies[0].position.z = 1.2;
    scene.bodies[0].friction = 0.5;
    scene.bodies[1].position = {0, 0, 0.845};
    scene.bodies[1].keyframes = {{0, {0, 0, 0.845}, {}}, {1.2, {0, 0, 0.845}, {}}, {2, {0, 0, -0.1}, {}}};
    scene.bodies[1].type = BodyType::kinematic;
    return scene;
}

// They stand in most steps, and would lose what they hold if they did not press on it. What they hold is free.
TEST(UnsatisfiableScript, JawsThatWaitKeepTheirLoad) {
    for (const std::string_view preset : {"preview", "balanced", "accurate"})
        for (const double time_step : {1.0 / 24, 1.0 / 120}) {
            World world(grip(preset, time_step));
            double gripped = 0;
            std::int64_t held = 0, steps = 0;
            while (world.time() < 4) {
                const StepReport r = world.step();
                if (world.time() < 1.1) {
                    gripped = world.body(kCube).position.z;
                    continue;
                }
                held += r.held > 0 ? 1 : 0;
                ++steps;
            }
            EXPECT_NEAR(world.body(kCube).position.z, gripped, 1e-4) << preset << ' ' << time_step;
            EXPECT_LT(3 * held, steps) << preset << ' ' << time_step;
        }
}

// What waits is no concern of others: a lift with a stack on it far away from jaws that press is never late.
TEST(UnsatisfiableScript, AScriptThatWaitsDelaysNoOther) {
    SceneDescription scene = jaws(UnsatisfiableScript::hold);
    const auto box = add_shape(scene, make_box(0.4, 0.4, 0.4), 30);
    for (int i = 0; i < 4; ++i) add_body(scene, box, BodyType::dynamic, {50 + 0.003 * i, 0, 0.31 + 0.41 * i}, 0.5, 0);
    const Vec3 low{50, 0, 0}, high{50, 0, 0.9};
    add_script(scene, add_shape(scene, make_box(4, 4, 0.2)), {{0, low, {}}, {1, low, {}}, {10, high, {}}});
    const std::size_t lift = scene.bodies.size() - 1;
    World world(scene);
    for (int n = 0; n < 192; ++n) world.step();
    EXPECT_NEAR(world.body(lift).position.z, 0.1 * (world.time() - 1), 1e-12);
}

// A row of so few is solved exactly: pressed, it rests. Where a script tries again, every 16 steps, the row is held or
// gives way in that step, by up to the rest distances that it has left; which of them is by chance of where it lies.
TEST(UnsatisfiableScript, WhatAScriptPressesOnRests) {
    constexpr int kStarts = 6, kFirst = 96, kEnd = 192;
    constexpr double kEdge = 0.4;
    int moved = 0;
    for (int start = 0; start < kStarts; ++start) {
        SceneDescription scene = row(UnsatisfiableScript::hold, false);
        std::erase_if(scene.bodies,
                      [](const BodyDescription& b) { return b.type == BodyType::dynamic && b.position.x < 1.7; });
        for (BodyDescription& b : scene.bodies)
            if (b.type == BodyType::dynamic) b.position.z += 1e-5 * start;
        World world(scene);
        std::vector<Vec3> places(world.size());
        int held = 0;
        for (int n = 0; n < kEnd; ++n) {
            const StepReport r = world.step();
            if (n < kFirst) {
                for (std::size_t i = 0; i < world.size(); ++i) places[i] = world.body(i).position;
                continue;
            }
            held += r.held > 0 ? 1 : 0;
            moved += r.held == 0 && r.kinetic_energy > 1e-6 ? 1 : 0;
        }
        EXPECT_LT(held, 8) << start;
        for (std::size_t i = 0; i < world.size(); ++i)
            EXPECT_LT(length(world.body(i).position - places[i]), 0.01 * kEdge) << start << ", body " << i;
    }
    EXPECT_LE(moved, 2 * kStarts); // of six tries each
}

TEST(UnsatisfiableScript, AnErrorNamesTheBodiesAndLeavesTheWorldAsItWas) {
    const SceneDescription scene = jaws(UnsatisfiableScript::error);
    World held(jaws(UnsatisfiableScript::hold)), world(scene);
    std::int64_t delayed = 0;
    while (delayed == 0) {
        const std::vector<std::byte> before = world.snapshot();
        const std::size_t contacts = world.contacts().size();
        const BodyState cube = world.body(kCube);
        const Vec3 turn = world.turn(kCube);
        if ((held.step().warnings & kScriptDelayed) == 0) {
            EXPECT_EQ(world.step().state_hash, held.state_hash());
            continue;
        }
        delayed = held.steps();
        for (int again = 0; again < 2; ++again) {
            try {
                world.step();
                FAIL() << "no exception";
            } catch (const ScriptError& e) {
                EXPECT_EQ(e.step(), delayed);
                ASSERT_EQ(e.pairs().size(), 2u);
                EXPECT_EQ(e.pairs()[0].name_a, "left");
                EXPECT_EQ(e.pairs()[1].name_a, "right");
                for (const BodyNames& pair : e.pairs()) EXPECT_EQ(pair.name_b, "cube");
                const std::string step = "step " + std::to_string(delayed) + ": the script of body ";
                EXPECT_EQ(e.what(), step + "\"left\" cannot go on: it would crush body \"cube\"\n" + step +
                                        "\"right\" cannot go on: it would crush body \"cube\"");
            }
            EXPECT_EQ(world.snapshot(), before);
            EXPECT_EQ(world.contacts().size(), contacts);
            EXPECT_EQ(world.body(kCube).position, cube.position);
            EXPECT_EQ(world.turn(kCube), turn);
        }
    }
    World on(jaws(UnsatisfiableScript::hold), world.snapshot());
    EXPECT_EQ(on.step().state_hash, held.state_hash());
    EXPECT_THROW(World(jaws(UnsatisfiableScript::follow), world.snapshot()), InputError);
    EXPECT_THROW(
        {
            World pressed(press(UnsatisfiableScript::error));
            for (int n = 0; n < 60; ++n) pressed.step();
        },
        ScriptError);
}

TEST(UnsatisfiableScript, ThreadsAndSnapshotsChangeNoBit) {
    const UnsatisfiableScript hold = UnsatisfiableScript::hold, follow = UnsatisfiableScript::follow;
    for (const SceneDescription& scene : {jaws(hold), jaws(follow), row(hold, true), gated(follow)}) {
        const auto expected = hashes_of_run(scene, 48, {1, Executor::serial});
        for (const int threads : {2, 3, 8}) EXPECT_EQ(hashes_of_run(scene, 48, {threads}), expected) << threads;
        World whole(scene);
        for (std::size_t n = 0; n < expected.size(); ++n) {
            std::optional<World> rest;
            if (n % 4 == 0) rest.emplace(scene, whole.snapshot(), "scene", WorldOptions{1 + static_cast<int>(n % 3)});
            ASSERT_EQ(whole.step().state_hash, expected[n]);
            if (rest) {
                ASSERT_EQ(rest->step().state_hash, expected[n]) << "step " << n;
            }
        }
    }
}

TEST(UnsatisfiableScript, WhereNothingIsInTheWayAllHaveTheSameBits) {
    const auto hashes = [](UnsatisfiableScript policy) {
        SceneDescription scene = gated(policy);
        scene.bodies[0].position.y = 2; // beside the pusher
        scene.bodies[3].keyframes[1].rotation = rotation_from_vector({0, 0.3, 0});
        return hashes_of_run(scene, 100, {1});
    };
    const auto expected = hashes(UnsatisfiableScript::hold);
    EXPECT_EQ(hashes(UnsatisfiableScript::follow), expected);
    EXPECT_EQ(hashes(UnsatisfiableScript::error), expected);
}

TEST(UnsatisfiableScript, WaysBelowTheRoundingOfPlacesAreMadeAllTheSame) {
    const auto run = [](UnsatisfiableScript policy) {
        SceneDescription scene = empty_scene();
        scene.settings.unsatisfiable_script = policy;
        const Vec3 far{1e9 - 10, 0, 0};
        add_script(scene, add_shape(scene, make_box(1, 1, 1)), {{0, far, {}}, {1e3, far + Vec3{1e-3, 0, 0}, {}}});
        return hashes_of_run(scene, 200, {1}); // 4e-8 m a step, where doubles are 1.2e-7 m apart
    };
    EXPECT_EQ(run(UnsatisfiableScript::follow), run(UnsatisfiableScript::hold));
}

struct ScriptedBody {
    explicit ScriptedBody(std::vector<Keyframe> keyframes) : scene(empty_scene()) {
        add_script(scene, add_shape(scene, make_box(2, 2, 2)), std::move(keyframes));
        model = make_model(build_scene(scene));
    }
    [[nodiscard]] double latest(const Vec3& place, double from, double to, double reach) const {
        return latest_within(model.shapes[0], model.bodies[0], pose_at_origin(model.shapes[0], place, {}), from, to,
                             reach);
    }
    [[nodiscard]] double fastest() const { return fastest_speed(model.shapes[0], model.bodies[0]); }
    SceneDescription scene;
    Model model;
};

TEST(LatestWithin, FindsThePlaceOnThePath) {
    const ScriptedBody line({{0, {}, {}}, {10, {10, 0, 0}, {}}});
    EXPECT_EQ(line.fastest(), 1);
    EXPECT_EQ(line.latest({3, 0, 0}, 3, 3.5, 1), 3.5); // all of it is within reach
    EXPECT_NEAR(line.latest({3, 0, 0}, 3, 9, 1), 4, 1.0 / 64);
    EXPECT_LE(line.latest({3, 0, 0}, 3, 9, 1), 4);
    EXPECT_EQ(line.latest({3, 5, 0}, 3, 9, 1), 3);       // nothing is
    EXPECT_EQ(line.latest({9, 0, 0}, 9, 1e9, 1.5), 1e9); // the last keyframe holds
    const ScriptedBody back({{0, {}, {}}, {10, {10, 0, 0}, {}}, {1000, {10, 0, 0}, {}}, {1010, {}, {}}});
    EXPECT_NEAR(back.latest({3, 0, 0}, 3, 1005.5, 1), 4, 1.0 / 64); // not yet
    EXPECT_EQ(back.latest({3, 0, 0}, 3, 1007, 1), 1007);
    EXPECT_NEAR(back.latest({3, 0, 0}, 3, 1010, 1), 1008, 1.0 / 64);
    const ScriptedBody still({{0, {1, 2, 3}, {}}, {5, {1, 2, 3}, {}}});
    EXPECT_EQ(still.fastest(), 0);
    EXPECT_EQ(still.latest({1, 2, 3}, 1, 4, 0), 4);
}

TEST(LatestWithin, TurnsCountByTheFarthestPoint) {
    const double corner = std::sqrt(3.0);
    const ScriptedBody turning({{0, {}, {}}, {1, {}, rotation_from_vector({0, 0, 1})}});
    EXPECT_NEAR(turning.fastest(), corner, 1e-12);
    EXPECT_NEAR(turning.latest({}, 0, 1, 0.5 * corner), 0.5, 1.0 / 64);
}

} // namespace
} // namespace flotilla::scenario
