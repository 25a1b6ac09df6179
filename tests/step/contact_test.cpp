// SPDX-License-Identifier: MIT
// Bounces and inclines against their closed forms.
#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// Coulomb's cone and a tight tolerance, at the time steps that the tests name.
Settings accurate_friction() {
    Settings s = preset("accurate");
    s.trajectory = Trajectory::linear;
    s.tolerance_share /= s.substeps;
    s.substeps = 1;
    return s;
}

struct Bounces {
    std::vector<double> heights; ///< m, largest rise after each bounce, of the lowest point above the plate
    double lowest = 1e300;       ///< m, of that point
    std::int64_t collisions = 0;
};

/// Corners at 0.5 m: the derived rest distance is 1/330 m. `rest_distance` 0: derived.
Bounces bounce(double height, double restitution, double dt, double rest_distance = 0) {
    constexpr std::size_t kWanted = 3;
    SceneDescription scene = empty_scene();
    scene.settings.time_step = dt;
    scene.settings.rest_distance = rest_distance;
    const auto ball = add_shape(scene, make_octahedron(0.5), 2);
    const auto plate = add_shape(scene, make_plate(10, 10));
    add_body(scene, ball, BodyType::dynamic, {0.1, 0.23, 0.5 + height}, 0, restitution);
    add_body(scene, plate, BodyType::fixed, {}, 0, restitution);
    World world(scene);
    Bounces out;
    double peak = 0;
    bool falling = true;
    while (out.heights.size() < kWanted && world.time() < 60) {
        out.collisions += world.step().collisions;
        const BodyState s = world.body(0);
        const double gap = s.position.z - 0.5;
        out.lowest = std::min(out.lowest, gap);
        if (s.velocity.z > 0) {
            falling = false;
            peak = std::max(peak, gap + 0.5 * s.velocity.z * s.velocity.z / kGravity);
        } else if (!falling) {
            out.heights.push_back(peak);
            falling = true;
            peak = 0;
        }
    }
    return out;
}

constexpr double kHeight = 5;
constexpr int kPhases = 8; // start heights, because where in a step the impact falls is an accident
double start_height(int phase) { return kHeight + 0.031 * phase; }

// A fast approach is a collision within the proximity distance of 2/330 m, where the energy of the height may not be
// reduced by e^2, so that one bounce rises (1 - e^2) of that too high. A share e^2 of the error is handed on.
TEST(Contact, BounceHeightsFollowRestitution) {
    for (const double e : {0.5, 0.8})
        for (const double dt : {1.0 / 48, 1.0 / 96, 1.0 / 192, 1.0 / 384})
            for (int phase = 0; phase < kPhases; ++phase) {
                double exact = start_height(phase), bound = 0;
                const Bounces b = bounce(exact, e, dt);
                ASSERT_EQ(b.heights.size(), 3u);
                EXPECT_GE(b.collisions, 3);
                EXPECT_GT(b.lowest, 0);
                for (double height : b.heights) {
                    bound = e * e * bound + (1 - e * e) * 2.0 / 330;
                    exact *= e * e;
                    EXPECT_NEAR(height, exact, bound) << "e " << e << ", dt " << dt;
                }
            }
}

// A hit that would not rebound, and that goes no farther in a step than contacts are found, is stopped by static contact.
TEST(Contact, SlowHitsWithoutReboundNeedNoCollision) {
    constexpr double kGap = 3.5e-3, kSpeed = 0.1; // m, m/s: 4.2 mm a step, and contacts are found within 6.1 mm
    const auto hit = [&](double restitution, double threshold, double speed) {
        SceneDescription scene = empty_scene();
        scene.gravity = {};
        scene.settings.approach_threshold = threshold;
        const auto ball = add_shape(scene, make_octahedron(0.5), 2), plate = add_shape(scene, make_plate(10, 10));
        add_body(scene, ball, BodyType::dynamic, {0.1, 0.23, 0.5 + kGap}, 0, restitution).velocity = {0, 0, -speed};
        add_body(scene, plate, BodyType::fixed, {}, 0, restitution);
        World world(scene);
        const std::int64_t collisions = world.step().collisions;
        world.step();
        EXPECT_GT(world.body(0).position.z, 0.5);
        EXPECT_NEAR(world.body(0).velocity.z, restitution * speed, 0.02 * speed);
        return collisions;
    };
    EXPECT_EQ(hit(0, -1, kSpeed), 0);
    EXPECT_GT(hit(0, 0, kSpeed), 0); // every approach is asked to be a collision
    EXPECT_GT(hit(0.5, -1, kSpeed), 0);
    EXPECT_GT(hit(0, -1, 10 * kSpeed), 0); // beyond where contacts are found
}

// Late hits leave a rebound the energy that is due, wherever in the step the body arrives: the error is that of the
// contact distances, at any time step.
TEST(Contact, ReboundsComeAsHighAsTheyShouldAtAnyTimeStep) {
    constexpr double kRest = 1e-5; // m
    for (const double e : {0.5, 0.8})
        for (const double dt : {1.0 / 24, 1.0 / 48, 1.0 / 768}) {
            double worst = 0;
            for (int phase = 0; phase < kPhases; ++phase) {
                const double h = start_height(phase);
                const Bounces b = bounce(h, e, dt, kRest);
                EXPECT_GE(b.collisions, 3);
                EXPECT_GT(b.lowest, 0);
                worst = std::max(worst, std::abs(b.heights.at(0) - h * e * e));
            }
            std::printf("bounce e = %g, dt = %.4f s: first height off by %.3g m\n", e, dt, worst);
            EXPECT_LT(worst, 2 * kRest) << e << ", " << dt;
        }
}

constexpr double kSlope = 20 * kPi / 180;

/// A flat block at its rest distance on an incline; the slope falls towards +x.
World block_on_incline(double friction, double dt) {
    SceneDescription scene = empty_scene(accurate_friction());
    scene.settings.time_step = dt;
    const auto block = add_shape(scene, make_box(1, 1, 0.4), 5);
    const auto plane = add_shape(scene, make_plate(60, 60));
    const Quat tilt = rotation_from_vector({0, kSlope, 0});
    const double rest = std::sqrt(1 + 1 + 0.16) / 330;
    add_body(scene, block, BodyType::dynamic, rotate(tilt, {-10, 0.13, 0.2 + 1.0001 * rest}), friction, 0).rotation =
        tilt;
    add_body(scene, plane, BodyType::fixed, {}, friction, 0).rotation = tilt;
    return World(scene);
}

TEST(Contact, BlockSticksJustAboveTheThreshold) {
    World world = block_on_incline(1.01 * std::tan(kSlope), 1.0 / 24);
    double fastest = 0;
    std::int64_t contacts = 1000;
    for (int n = 0; n < 240; ++n) {
        const StepReport r = world.step();
        if (n < 24) continue;
        contacts = std::min(contacts, r.contacts);
        fastest = std::max(fastest, length(world.body(0).velocity));
    }
    std::printf("incline, stick at 1.01: fastest %.3g m/s after 1 s, at least %lld contacts\n", fastest,
                static_cast<long long>(contacts));
    EXPECT_GE(contacts, 3);
    EXPECT_LT(fastest, 1e-6);
}

TEST(Contact, BlockSlipsWithTheRightAcceleration) {
    for (const double share : {0.0, 0.5, 0.9}) {
        const double friction = share * std::tan(kSlope);
        World world = block_on_incline(friction, 1.0 / 24);
        std::int64_t contacts = 1000;
        for (int n = 0; n < 24; ++n) (void)world.step();
        const Vec3 before = world.body(0).velocity;
        for (int n = 0; n < 24; ++n) contacts = std::min(contacts, world.step().contacts);
        const Vec3 down{std::cos(kSlope), 0, -std::sin(kSlope)};
        const double a = dot(world.body(0).velocity - before, down);
        const double exact = kGravity * (std::sin(kSlope) - friction * std::cos(kSlope));
        std::printf("incline, slip at %.1f: acceleration %.5f, exact %.5f m/s^2 (%.3f %%)\n", share, a, exact,
                    100 * (a / exact - 1));
        EXPECT_GE(contacts, 3);
        EXPECT_NEAR(a / exact, 1, 0.01);
    }
}

// The pyramid of a sliding contact is drawn anew in every step: between 1 and sqrt(2) of Coulomb's friction, 4/pi on
// average, and no direction is preferred. Tangents that stay, as those of contacts that stick do, would brake evenly
// and turn the block aside.
TEST(Contact, ASlidingBlockDrawsNewTangentsInEveryStep) {
    constexpr double kFriction = 0.2, kSpeed = 12, kStep = 1.0 / 240;
    constexpr int kSteps = 800;
    SceneDescription scene = empty_scene();
    scene.settings.time_step = kStep;
    scene.settings.tangents = Tangents::random;
    const auto block = add_shape(scene, make_box(1, 1, 0.4), 5);
    const auto plane = add_shape(scene, make_plate(200, 200));
    const double rest = std::sqrt(1 + 1 + 0.16) / 330;
    add_body(scene, block, BodyType::dynamic, {-90, 0.13, 0.2 + 1.0001 * rest}, kFriction, 0).velocity = {kSpeed, 0, 0};
    add_body(scene, plane, BodyType::fixed, {}, kFriction, 0);
    World world(scene);
    for (int n = 0; n < 24; ++n) world.step();
    const Vec3 start = world.body(0).velocity;
    double least = 10, most = 0, before = start.x;
    for (int n = 0; n < kSteps; ++n) {
        world.step();
        const double speed = world.body(0).velocity.x, friction = (before - speed) / (kFriction * kGravity * kStep);
        least = std::min(least, friction);
        most = std::max(most, friction);
        before = speed;
    }
    const double mean = (start.x - before) / (kFriction * kGravity * kStep * kSteps);
    const double aside = std::abs(world.body(0).velocity.y - start.y);
    std::printf("sliding block: friction %.3f of Coulomb's, %.3f to %.3f; %.3g m/s aside\n", mean, least, most, aside);
    EXPECT_NEAR(mean, 4 / kPi, 0.03);
    EXPECT_LT(least, 1.2);
    EXPECT_GT(most, 1.35);
    EXPECT_LT(aside, 0.02 * (start.x - before));
}

} // namespace
} // namespace flotilla::scenario
