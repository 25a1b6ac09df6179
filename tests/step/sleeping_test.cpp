// SPDX-License-Identifier: MIT
// Resting islands sleep, stand still to the bit, and wake when something comes.
#include <cmath>
#include <numbers>

#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// `count` blocks on each other, and a ground.
SceneDescription tower(int count) {
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = true;
    const auto block = add_shape(scene, make_box(1, 1, 0.5), 100);
    const auto ground = add_shape(scene, make_plate(20, 20));
    add_body(scene, ground, BodyType::fixed, {0, 0, 0}, 0.5);
    for (int i = 0; i < count; ++i) add_body(scene, block, BodyType::dynamic, {0, 0, 0.26 + 0.51 * i}, 0.5);
    return scene;
}

std::vector<BodyState> states(const World& world) {
    std::vector<BodyState> out;
    for (std::size_t i = 0; i < world.size(); ++i) out.push_back(world.body(i));
    return out;
}

/// Steps until `bodies` sleep; the number of steps, or -1 after `limit`.
int steps_until_asleep(World& world, int bodies, int limit) {
    for (int n = 1; n <= limit; ++n)
        if (world.step().sleeping == bodies) return n;
    return -1;
}

TEST(Sleeping, ATowerFallsAsleepAndStandsStill) {
    World world(tower(4));
    const int steps = steps_until_asleep(world, 4, 240);
    ASSERT_GE(steps, 12);
    const auto before = states(world);
    const StepReport first = world.step();
    for (int n = 0; n < 50; ++n) EXPECT_EQ(world.step().sleeping, 4);
    const auto after = states(world);
    for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(before[i].position, after[i].position);
        EXPECT_EQ(before[i].rotation, after[i].rotation);
        EXPECT_EQ(after[i].velocity, Vec3{});
    }
    EXPECT_EQ(world.step().energy, first.energy);
}

TEST(Sleeping, KeepsTheLiftThatWasWrittenDown) {
    SceneDescription scene = tower(4);
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) scene.bodies[i].velocity = {0, 0, -5};
    World world(scene);
    double awake = 0; // of the step before
    for (int n = 0; n < 240; ++n) {
        const StepReport report = world.step();
        if (report.sleeping == 4 && awake > 0) {
            EXPECT_EQ(world.step().lift, report.lift);
            EXPECT_GT(report.lift, 0);
            return;
        }
        awake = report.lift;
    }
    FAIL() << "fell asleep without lift";
}

TEST(Sleeping, ChangesRestByLessThanAMillimetre) {
    SceneDescription awake = tower(4);
    awake.settings.sleeping = false;
    World with(tower(4)), without(awake);
    std::int64_t slept = 0;
    for (int n = 0; n < 240; ++n) {
        slept = with.step().sleeping;
        EXPECT_EQ(without.step().sleeping, 0);
    }
    EXPECT_EQ(slept, 4);
    for (std::size_t i = 0; i < with.size(); ++i)
        EXPECT_LT(length(with.body(i).position - without.body(i).position), 1e-3);
}

TEST(Sleeping, WhatSlidesWithoutFrictionGoesOn) {
    constexpr double kSpeed = 4e-3; // m/s: less than a hundredth of what gravity adds in a step
    SceneDescription scene = tower(1);
    for (BodyDescription& body : scene.bodies) body.friction = 0;
    scene.bodies.back().velocity = {kSpeed, 0, 0};
    World world(scene);
    const double start = world.body(1).position.x;
    for (int n = 0; n < 48; ++n) world.step();
    EXPECT_NEAR(world.body(1).position.x - start, kSpeed * world.time(), 1e-6);
}

// At first |v| + |omega| radius gains 1/2,100 of what gravity adds.
TEST(Sleeping, WhatTipsOverSlowlyFalls) {
    constexpr double kPast = 3e-4, kDue = 3.18; // rad past its balance; s, until its middle is at 0.7 m
    for (const int rate : {24, 120}) {
        SceneDescription scene = empty_scene();
        scene.settings.sleeping = true;
        scene.settings.time_step = 1.0 / rate;
        scene.settings.rest_distance = 6e-4;
        const auto block = add_shape(scene, make_box(0.2, 1, 2), 100);
        scene.shapes.back().mass_kind = MassKind::density;
        const auto ground = add_shape(scene, make_plate(20, 20));
        add_body(scene, ground, BodyType::fixed, {0, 0, 0}, 1);
        const double tilt = std::atan(0.1) + kPast;
        add_body(scene, block, BodyType::dynamic,
                 {0, 0, std::cos(tilt) + 0.1 * std::sin(tilt) + scene.settings.rest_distance}, 1)
            .rotation = rotation_from_vector({0, tilt, 0});
        World world(scene);
        while (world.time() < 5 && world.body(1).position.z > 0.7) world.step();
        EXPECT_NEAR(world.time(), kDue, 0.02 + 1.0 / rate) << rate;
    }
}

TEST(Sleeping, ABodyThatFallsOnATowerWakesIt) {
    SceneDescription scene = tower(3);
    const auto ball = add_shape(scene, make_sphere(0.3, 2), 50);
    add_body(scene, ball, BodyType::dynamic, {0.1, 0, 60}, 0.5);
    World world(scene);
    ASSERT_GE(steps_until_asleep(world, 3, 80), 12);
    const double top = world.body(3).position.z;
    std::int64_t collisions = 0;
    int woken = 0;
    double moved = 0;
    for (int n = 0; n < 120; ++n) {
        const StepReport r = world.step();
        collisions += r.collisions;
        woken += r.sleeping == 0 ? 1 : 0;
        moved = std::max(moved, std::abs(world.body(3).position.z - top));
        ASSERT_EQ(count_intersections(scene, world), 0) << "step " << n;
    }
    EXPECT_GE(collisions, 1);
    EXPECT_GE(woken, 10);
    EXPECT_GT(moved, 1e-4);
}

TEST(Sleeping, NeighboursThatRestDoNotKeepEachOtherAwake) {
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = true;
    const auto bar = add_shape(scene, make_box(3, 0.2, 0.2), 60);
    add_body(scene, add_shape(scene, make_plate(20, 20)), BodyType::fixed, {0, 0, 0}, 0.5);
    const Quat turned = normalized(Quat{1, 0, 0, std::tan(0.125 * std::numbers::pi)}); // by 45 degrees
    add_body(scene, bar, BodyType::dynamic, {0, 0, 0.102}, 0.5).rotation = turned;
    // Beside it, with overlapping boxes: it comes to rest some steps later.
    add_body(scene, bar, BodyType::dynamic, {0.45, -0.45, 0.35}, 0.5).rotation = turned;
    World world(scene);
    ASSERT_NE(steps_until_asleep(world, 2, 120), -1);
    for (int n = 0; n < 40; ++n) EXPECT_EQ(world.step().sleeping, 2);
}

// A large body has to be quiet for longer: what is near it waits for it.
TEST(Sleeping, SmallNeighboursFallAsleepWithALargeBody) {
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = true;
    add_body(scene, add_shape(scene, make_plate(60, 60)), BodyType::fixed, {0, 0, 0}, 0.5);
    const double gap = 0.01;
    add_body(scene, add_shape(scene, make_box(0.2, 0.2, 0.2), 60), BodyType::dynamic, {0, 0, 0.1 + gap}, 0.5);
    // Turned, with a box around it that the small one is in.
    add_body(scene, add_shape(scene, make_box(20, 0.4, 0.4), 60), BodyType::dynamic, {1.5, -1.5, 0.2 + gap}, 0.5)
        .rotation = normalized(Quat{1, 0, 0, std::tan(0.125 * std::numbers::pi)});
    World world(scene);
    int first = -1, all = -1;
    for (int n = 1; n <= 240 && all < 0; ++n) {
        const std::int64_t sleeping = world.step().sleeping;
        if (sleeping > 0 && first < 0) first = n;
        if (sleeping == 2) all = n;
    }
    ASSERT_NE(all, -1);
    EXPECT_GE(all * scene.settings.time_step, std::sqrt(20 / kGravity));
    for (int n = 0; n < 40; ++n) EXPECT_EQ(world.step().sleeping, 2);
}

TEST(Sleeping, WhatAMostlySleepingSceneGivesBackChangesNoBits) {
    // Large meshes: vertices and boxes of a few of them are more than what is worth giving back.
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = true;
    const auto ball = add_shape(scene, make_sphere(0.5, 6), 50);
    add_body(scene, add_shape(scene, make_plate(20, 20)), BodyType::fixed, {0, 0, 0}, 0.5);
    for (int i = 0; i < 4; ++i) add_body(scene, ball, BodyType::dynamic, {1.5 * i - 1.5, 0, 0.503}, 0.5);
    World world(scene);
    const std::size_t awake = world.memory().bodies;
    ASSERT_GT(awake, std::size_t{16} << 20);
    ASSERT_NE(steps_until_asleep(world, 4, 120), -1);
    EXPECT_LT(world.memory().bodies, awake / 2);
    World before = world.clone();
    for (int n = 0; n < 3; ++n) (void)world.step(), (void)before.step();
    // One that has begun there, and one that gave back its buffers, go on alike.
    for (World* w : {&world, &before}) w->apply_impulse(w->id(1), {40, 0, 20}, {-1.5, 0, 0.5});
    for (int n = 0; n < 12; ++n) {
        const StepReport report = world.step();
        EXPECT_LT(report.sleeping, 4);
        EXPECT_EQ(report.state_hash, before.step().state_hash) << n;
    }
}

/// Frictionless cubes of 0.2 m in a row, so far apart, all asleep after a second, and one that comes along it.
SceneDescription row_of_sleepers(const Settings& settings, int count, double gap, double speed, double restitution) {
    SceneDescription scene = empty_scene();
    scene.settings = settings;
    constexpr double kEdge = 0.2;
    const auto cube = add_shape(scene, make_box(kEdge, kEdge, kEdge), 125);
    const auto add = [&](double x) -> BodyDescription& {
        BodyDescription& body = add_body(scene, cube, BodyType::dynamic, {x, 0, 0.5 * kEdge + 0.001}, 0);
        body.restitution = restitution;
        return body;
    };
    add_body(scene, add_shape(scene, make_plate(40, 40)), BodyType::fixed, {0, 0, 0}, 0).restitution = 0;
    for (int i = 0; i < count; ++i) add(i * (kEdge + gap));
    add(-kEdge - 1.1 * speed).velocity = {speed, 0, 0};
    return scene;
}

std::vector<double> speeds_after_blow(SceneDescription scene, bool sleeping, std::int64_t asleep) {
    scene.settings.sleeping = sleeping;
    World world(scene);
    std::int64_t most = 0;
    while (world.time() < 1.4) most = std::max(most, world.step().sleeping);
    EXPECT_EQ(most, sleeping ? asleep : 0);
    std::vector<double> out;
    for (std::size_t i = 1; i < world.size(); ++i) out.push_back(world.body(i).velocity.x);
    return out;
}

// Each of them meets the next one in the step in which it is hit itself.
TEST(Sleeping, ABlowGoesThroughSleepersAsThroughOthers) {
    for (const char* name : {"preview", "balanced", "accurate"})
        for (const double dt : {1.0 / 24, 1.0 / 240})
            for (const double restitution : {0.0, 1.0}) {
                Settings settings = preset(name);
                settings.sleeping = true;
                settings.time_step = dt;
                const SceneDescription scene = row_of_sleepers(settings, 4, 0.002, 4, restitution);
                const auto asleep = speeds_after_blow(scene, true, 4), awake = speeds_after_blow(scene, false, 4);
                double momentum = 0;
                for (std::size_t i = 0; i < asleep.size(); ++i) {
                    momentum += asleep[i];
                    EXPECT_NEAR(asleep[i], awake[i], 0.02) << name << " " << dt << " " << restitution << " " << i;
                }
                EXPECT_NEAR(momentum, 4, 1e-3) << name << " " << dt << " " << restitution;
            }
}

TEST(Sleeping, AScriptPushesARowOfSleepers) {
    for (const char* name : {"preview", "balanced"}) {
        Settings settings = preset(name);
        settings.sleeping = true;
        SceneDescription scene = row_of_sleepers(settings, 4, 0.003, 0, 0);
        scene.bodies.pop_back();
        BodyDescription& wall =
            add_body(scene, add_shape(scene, make_box(0.1, 1, 1)), BodyType::kinematic, {-1.2, 0, 0.6});
        wall.keyframes = {{0, {-1.2, 0, 0.6}, {}}, {1, {-1.2, 0, 0.6}, {}}, {3, {0.8, 0, 0.6}, {}}};
        World world(scene);
        ASSERT_GE(steps_until_asleep(world, 4, 24), 12);
        std::int64_t held = 0;
        while (world.time() < 3) held += world.step().held;
        EXPECT_EQ(held, 0) << name;
        EXPECT_NEAR(world.body(world.size() - 1).position.x, 0.8, 1e-9) << name;
    }
}

TEST(Sleeping, AScriptedBodyPushesASleepingOne) {
    SceneDescription scene = tower(1);
    const auto wall = add_shape(scene, make_box(0.2, 2, 1));
    BodyDescription& pusher = add_body(scene, wall, BodyType::kinematic, {-3, 0, 0.6}, 0.5);
    pusher.keyframes = {{0, {-3, 0, 0.6}, {}}, {3, {-3, 0, 0.6}, {}}, {6, {1, 0, 0.6}, {}}};
    World world(scene);
    ASSERT_GE(steps_until_asleep(world, 1, 70), 12);
    for (int n = 0; n < 150; ++n) {
        (void)world.step();
        ASSERT_EQ(count_intersections(scene, world), 0) << "step " << n;
    }
    EXPECT_GT(world.body(1).position.x, 0.5);
}

// ------------------------------------------------------------------------------------------------- contacts of
//                                                                                                   sleepers

struct NamedContact {
    std::int32_t a, b;
    Vec3 point;
    bool operator==(const NamedContact&) const = default;
};
std::vector<NamedContact> named(const std::vector<ContactState>& contacts) {
    std::vector<NamedContact> out;
    for (const ContactState& c : contacts) out.push_back({c.body_a, c.body_b, c.point});
    return out;
}

TEST(SleepingContacts, StayAndCarryTheWeight) {
    World world(tower(4));
    std::vector<NamedContact> last;
    while (world.step().sleeping < 4) {
        ASSERT_LT(world.steps(), 240);
        last = named(world.contacts());
    }
    const auto asleep = world.contacts();
    ASSERT_GE(asleep.size(), 12U); // three a pair at least
    EXPECT_EQ(asleep.size(), last.size());
    Vec3 on_lowest;
    for (const ContactState& c : asleep) {
        EXPECT_TRUE(c.asleep);
        EXPECT_GT(c.distance, 0);
        if (c.body_a == 0) on_lowest += c.impulse;
    }
    const double mass = 4 * 100; // kg
    EXPECT_NEAR(on_lowest.z, mass * 9.8 * world.settings().time_step, 1e-3 * on_lowest.z);
    for (int n = 0; n < 5; ++n) {
        const StepReport r = world.step();
        EXPECT_EQ(r.contacts, 0); // nothing was solved
        EXPECT_EQ(r.sleeping_contacts, static_cast<std::int64_t>(asleep.size()));
    }
    EXPECT_EQ(named(world.contacts()), named(asleep));
    for (const BodyActivity& body : world.activity()) EXPECT_GE(body.contacts, 3);
    EXPECT_EQ(world.activity()[2].cluster, ClusterState::asleep);
    EXPECT_EQ(world.activity()[0].cluster, ClusterState::free); // the ground does not sleep
}

// A plank that a box slides off to the next one is quiet all the time, and in the step in which the box leaves the
// impulses of its start are those of both loads.
TEST(SleepingContacts, OfWhatALoadLeftCarryWhatIsThere) {
    SceneDescription scene = empty_scene();
    scene.settings.sleeping = true;
    scene.settings.rest_distance = 1e-3;
    const auto pier = add_shape(scene, make_box(0.3, 1, 1));
    const auto plank = add_shape(scene, make_box(1.98, 0.8, 0.05), 47.5),
               load = add_shape(scene, make_box(0.3, 0.3, 0.3), 54);
    for (const double x : {0.0, 2.0, 4.0}) add_body(scene, pier, BodyType::fixed, {x, 0, 0}, 0.3);
    for (const double x : {1.0, 3.0}) add_body(scene, plank, BodyType::dynamic, {x, 0, 0.526}, 0.3);
    add_body(scene, load, BodyType::dynamic, {0.5, 0, 0.702}, 0.3).velocity = {3.5, 0, 0};
    World world(scene);
    ASSERT_NE(steps_until_asleep(world, 3, 120), -1);
    ASSERT_GT(world.body(5).position.x, 2.2); // on the second one alone
    Vec3 under_first;
    for (const ContactState& c : world.contacts())
        if (c.body_a < 2 && c.body_b == 3) under_first += c.impulse;
    const double due = 47.5 * 9.8 * world.settings().time_step;
    EXPECT_NEAR(under_first.z, due, 1e-3 * due);
}

TEST(SleepingContacts, AreThoseOfTheResumedRunAndGoWhenTheirBodiesWake) {
    SceneDescription scene = tower(3);
    const auto ball = add_shape(scene, make_sphere(0.3, 2), 50);
    add_body(scene, ball, BodyType::dynamic, {0.1, 0, 60}, 0.5);
    const auto far = add_shape(scene, make_box(0.5, 0.5, 0.5), 10); // sleeps on when the tower wakes
    add_body(scene, far, BodyType::dynamic, {5, 5, 0.26}, 0.5);
    World world(scene);
    int slept = 0, woken = 0;
    for (int n = 0; n < 120; ++n) {
        const StepReport r = world.step();
        const auto contacts = world.contacts();
        EXPECT_TRUE(std::is_sorted(contacts.begin(), contacts.end(), [](const auto& x, const auto& y) {
            return std::pair(x.body_a, x.body_b) < std::pair(y.body_a, y.body_b);
        }));
        EXPECT_GE(std::count_if(contacts.begin(), contacts.end(), [](const auto& c) { return c.asleep; }),
                  r.sleeping_contacts); // more in the step in which they fall asleep
        std::int64_t touching = 0;      // at two bodies each
        for (const BodyActivity& body : world.activity()) touching += body.contacts;
        // Some that stage 7 saw ahead are none; what parts in the step is listed besides.
        EXPECT_LE(touching / 2, r.contacts + r.sleeping_contacts) << "step " << n;
        EXPECT_LE(touching / 2, std::ssize(contacts)) << "step " << n;
        slept += r.sleeping == 4 ? 1 : 0;
        woken += r.sleeping == 1 && slept > 0 ? 1 : 0;
        if (n % 7 != 0) continue;
        const World resumed(scene, world.snapshot());
        const auto again = resumed.contacts();
        ASSERT_EQ(named(again), named(contacts)) << "step " << n;
        for (std::size_t i = 0; i < again.size(); ++i) {
            EXPECT_EQ(again[i].asleep, contacts[i].asleep);
            EXPECT_EQ(again[i].normal, contacts[i].normal);
            EXPECT_EQ(again[i].distance, contacts[i].distance);
            EXPECT_EQ(again[i].impulse, contacts[i].impulse);
        }
    }
    EXPECT_GT(slept, 0);
    EXPECT_GT(woken, 0);
}

} // namespace
} // namespace flotilla::scenario
