// SPDX-License-Identifier: MIT
// Energy never rises by itself, whatever the scene.
#include "base/random.hpp"
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

SceneDescription falling_stack(const Settings& settings, int boxes, double gap) {
    constexpr double kEdge = 0.3; // m
    SceneDescription scene = make_scene_with(settings);
    const auto box = add_shape(scene, make_box(kEdge, kEdge, kEdge), 30);
    for (int i = 0; i < boxes; ++i)
        add_body(scene, box, BodyType::dynamic, {0, 0, 0.5 * kEdge + gap + i * (kEdge + gap)});
    add_ground(scene, 20);
    return scene;
}

void fall_as_a_stack(const Run& run, int boxes, double time_step, double time) {
    Settings settings = run.settings();
    settings.time_step = time_step;
    Motion motion(falling_stack(settings, boxes, 0.01));
    motion.run(time);
    motion.print("%d boxes, dt %.4g s", boxes, time_step);
    expect_no_rise(motion);
}

/// 27 cubes that fall as a loose block, each turned anyhow.
SceneDescription heap(const Settings& settings, double edge, double friction, double restitution) {
    SceneDescription scene = make_scene_with(settings);
    const auto cube = add_solid(scene, make_box(edge, edge, edge), 1000);
    Numbers numbers(1);
    for (int i = 0; i < 27; ++i) {
        const Vec3 cell{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 + 1.0};
        add_body(scene, cube, BodyType::dynamic, 1.9 * edge * cell, friction, restitution).rotation =
            numbers.rotation();
    }
    add_ground(scene, 100 * edge, friction, restitution);
    return scene;
}

void heap_with_friction(const Run& run, double friction) {
    Motion motion(heap(run.settings(), 0.5, friction, 0.1));
    motion.run(4);
    motion.print();
    expect_no_rise(motion);
}

void bouncing_box(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto box = add_solid(scene, make_box(1, 0.8, 0.6), 500);
    auto& body = add_body(scene, box, BodyType::dynamic, {0, 0, 2}, 0, 1);
    body.rotation = Numbers(3).rotation();
    body.angular_velocity = {1, 2, -1};
    add_ground(scene, 60, 0, 1);
    Motion motion(scene);
    motion.run(4);
    motion.print();
    expect_no_rise(motion);
}

// Without gravity, so that the kinetic energy is all there is.
void closed_box(const Run& run) {
    constexpr double kEdge = 0.3;
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto cube = add_solid(scene, make_box(kEdge, kEdge, kEdge), 1000);
    const auto walls = add_shape(scene, make_box(3, 3, 3));
    Numbers numbers(5);
    for (int i = 0; i < 27; ++i) {
        const Vec3 cell{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
        auto& body = add_body(scene, cube, BodyType::dynamic, 0.9 * cell, 0, 1);
        body.rotation = numbers.rotation();
        body.velocity = 3 * numbers.vector();
    }
    add_body(scene, walls, BodyType::fixed, {}, 0, 1);
    Motion motion(scene);
    motion.run(4);
    const double kept = motion.outcome().end / motion.outcome().start;
    motion.print("keeps %.4f of its energy", kept);
    expect_no_rise(motion);
    if (run.rate >= 240) {
        EXPECT_GT(kept, 0.99);
    }
}

// The largest step of a frame rate that a user may think of: boats fall several lengths in it.
void boats_at_a_step_of_a_second(const Run& run) {
    SceneDescription scene = make_scene("falling-boats", 9);
    scene.settings = run.settings();
    scene.settings.time_step = 1;
    Motion motion(scene);
    motion.run(12);
    motion.print();
    expect_no_rise(motion);
}

void small_boats_in_a_bowl(const Run& run, double time) {
    SceneDescription scene = scaled(make_scene("boats-in-bowl", 12), 1e-3);
    scene.settings = run.settings();
    Motion motion(scene);
    // A step of the tight presets can take minutes once boats are fast; the first one, of 5 lengths, shows what there
    // is to show.
    motion.run(run.preset == "balanced" ? time : run.dt());
    // What falls by many lengths in a step may be thrown over the rim: 18 boats of 130 with thirteen seeds. Where energy
    // grew all were.
    int boats = 0, left = 0;
    for (std::size_t i = 0; i < motion.world().size(); ++i) {
        if (!(motion.mass(i) > 0)) continue;
        ++boats;
        if (motion.body(i).center_of_mass.z < -0.01) ++left;
    }
    motion.print("%d of %d left the bowl, aside by %.3g m", left, boats, motion.farthest_aside());
    expect_no_rise(motion);
    EXPECT_LT(left, boats);
}

// One plate spins amid others: its corners reach the four nearest, and all of them come closer.
void spinning_plate(const Run& run, double speed) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto plate = add_shape(scene, make_plate(1, 1), 1);
    add_body(scene, plate, BodyType::dynamic, {}).angular_velocity = speed * normalized(Vec3{0.2, 0.1, 1});
    for (int i = 0; i < 8; ++i) {
        const Quat turn = rotation_from_vector({0, 0, i * kPi / 4});
        auto& body = add_body(scene, plate, BodyType::dynamic, rotate(turn, {i % 2 == 0 ? 1.1 : 1.4, 0, 0}));
        body.rotation = turn * rotation_from_vector({kPi / 2 + 0.1, 0, 0});
        body.velocity = rotate(turn, {-0.5, 0, 0});
        body.angular_velocity = {0, 0, 0.1 * i};
    }
    Motion motion(scene);
    motion.run(1);
    motion.print();
    expect_no_rise(motion);
}

void plates_shot_at_a_wall(const Run& run, double speed) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto plate = add_shape(scene, make_plate(1, 1), 1), wall = add_shape(scene, make_plate(60, 60));
    Numbers numbers(9);
    for (int i = 0; i < 8; ++i) {
        auto& body =
            add_body(scene, plate, BodyType::dynamic, {0.4 * numbers.next(), 0.4 * numbers.next(), 2 + 1.6 * i});
        body.rotation = numbers.rotation();
        body.velocity = {0, 0, -speed};
    }
    add_body(scene, wall, BodyType::fixed, {});
    Motion motion(scene);
    motion.run(1);
    motion.print();
    expect_no_rise(motion);
}

// An impulse at the time t of a hit uses arms of that time and momenta of the start of the step: it changes the angular
// momentum by at most t |v_a - v_b| |j|, velocities of the centres. Of a step with one impulse |j| is known, half of
// the sum of all changes of momentum; with k of them it is at most k times that where they do not cancel.
void plates_that_fly_together(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto plate = add_shape(scene, make_plate(1, 1), 1);
    Numbers numbers(11);
    for (int i = 0; i < 12; ++i) {
        const Vec3 at{i % 3 - 1.0, i / 3 % 2 - 0.5, i / 6 - 0.5};
        auto& body = add_body(scene, plate, BodyType::dynamic, 1.6 * at, 0, 1);
        body.rotation = numbers.rotation();
        body.velocity = -1.5 * at + 0.3 * numbers.vector();
        body.angular_velocity = numbers.vector();
    }
    Motion motion(scene);
    const std::size_t bodies = motion.world().size();
    std::vector<Vec3> velocities(bodies);
    for (std::size_t i = 0; i < bodies; ++i) velocities[i] = motion.body(i).velocity;
    Vec3 before;
    double drift = 0, scale = 0, worst = 0;
    std::int64_t hits = 0;
    motion.run(3, [&](const StepReport& r) {
        double impulses = 0, relative = 0;
        for (std::size_t i = 0; i < bodies; ++i)
            for (std::size_t j = 0; j < i; ++j) {
                const Vec3 old = velocities[i] - velocities[j], now = motion.body(i).velocity - motion.body(j).velocity;
                relative = std::max({relative, length(old), length(now)});
            }
        for (std::size_t i = 0; i < bodies; ++i) {
            const Vec3 now = motion.body(i).velocity;
            impulses += 0.5 * motion.mass(i) * length(now - velocities[i]);
            velocities[i] = now;
        }
        scale = std::max(scale, length(r.angular_momentum));
        if (r.step > 1) {
            const double change = length(r.angular_momentum - before);
            const double due = run.dt() * static_cast<double>(r.collisions) * relative * impulses + 1e-9 * scale;
            drift += change;
            worst = std::max(worst, change / due);
        }
        before = r.angular_momentum;
        hits += r.collisions;
    });
    motion.print("%lld hits, angular momentum changed by %.4g of %.4g, at most %.3g of the bound",
                 static_cast<long long>(hits), drift, scale, worst);
    expect_no_rise(motion);
    EXPECT_GT(hits, 10);
    EXPECT_LT(worst, 1);
}

/// Half a round trough along y, of so many sides.
TriangleMesh trough(double radius, double width, int sides) {
    TriangleMesh mesh;
    for (int i = 0; i <= sides; ++i)
        for (const double y : {-0.5 * width, 0.5 * width}) {
            const double angle = kPi * i / sides;
            mesh.vertices.push_back({-radius * std::cos(angle), y, -radius * std::sin(angle)});
        }
    for (int i = 0; i < 2 * sides; i += 2) {
        mesh.triangles.push_back({i, i + 1, i + 3});
        mesh.triangles.push_back({i, i + 3, i + 2});
    }
    return mesh;
}

// A stick without friction swings across a trough as a pendulum, for ever but for what the sides take at which its ends
// arrive: a step may pass them a part of a step late, one way as often as the other.
void stick_swings_in_a_trough(const Run& run, double angle) {
    constexpr double kRadius = 0.5, kLength = 0.6, kHeight = 0.04, kTime = 20; // m, s
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(kLength, 0.1, kHeight);
    const double corner = kRadius - rest_gap(mesh),
                 depth = std::sqrt(corner * corner - 0.25 * kLength * kLength) - 0.5 * kHeight;
    auto& stick = add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic,
                           {-depth * std::sin(angle), 0, -depth * std::cos(angle)}, 0, 0);
    stick.rotation = rotation_from_vector({0, angle, 0});
    stick.locked_translation = {false, true, false};
    stick.locked_rotation = {true, false, true};
    add_body(scene, add_shape(scene, trough(kRadius, 0.2, 720)), BodyType::fixed, {}, 0, 0);
    Motion motion(scene);
    double farthest = 0, last = 0; // rad, of all and of the last second, which is more than half a swing
    motion.run(kTime, [&](const StepReport& r) {
        const Vec3 at = motion.body(0).center_of_mass;
        const double now = std::abs(std::atan2(at.x, -at.z));
        farthest = std::max(farthest, now);
        if (r.time > kTime - 1) last = std::max(last, now);
    });
    motion.print("swings by %.4f of its angle, and by %.4f in the end", farthest / angle, last / angle);
    EXPECT_LT(farthest / angle, 1.05);
    EXPECT_GT(last / angle, 0.95);
    expect_no_rise(motion);
}

// A ball of corners and sides swings so as well, and does not come to spin: its load is below its middle in the mean.
void ball_swings_in_a_trough(const Run& run) {
    constexpr double kRadius = 0.5, kBall = 0.02, kAngle = 0.2, kTime = 3; // m, rad, s: two swings
    SceneDescription scene = make_scene_with(run.settings());
    scene.settings.rest_distance = 1e-3; // a chord of 1/24 s rises by 0.3 mm
    const TriangleMesh mesh = make_sphere(kBall, 2);
    const double depth = kRadius * std::cos(0.5 * kPi / 400) - kBall - scene.settings.rest_distance;
    add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic,
             {-depth * std::sin(kAngle), 0, -depth * std::cos(kAngle)}, 0, 0);
    add_body(scene, add_shape(scene, trough(kRadius, 0.4, 400)), BodyType::fixed, {}, 0, 0);
    Motion motion(scene);
    double last = 0, spin = 0; // rad, in the last half swing; J
    motion.run(kTime, [&](const StepReport& r) {
        const BodyState ball = motion.body(0);
        if (r.time > kTime - 0.75) last = std::max(last, std::atan2(std::abs(ball.center_of_mass.x), depth));
        const double inertia = 0.4 * motion.mass(0) * kBall * kBall;
        spin = std::max(spin, 0.5 * inertia * length_sq(ball.angular_velocity));
    });
    const double energy = motion.mass(0) * kGravity * depth * (1 - std::cos(kAngle));
    motion.print("swings by %.3f of its angle in the end, spins with up to %.3f of its energy", last / kAngle,
                 spin / energy);
    EXPECT_GT(last / kAngle, 0.75);
    EXPECT_LT(spin / energy, 0.1);
    expect_no_rise(motion);
}

// Rings of 2 mm that fall, linked, and turn hundreds of times a step. Where stage 5 finds no way for them they go as far
// as half of their velocities takes them. What they did not fall by then is potential energy, which no motion of theirs
// against each other may be enough to pay for.
void linked_rings_fall(const Run& run) {
    constexpr int kPairs = 900, kSteps = 3;
    constexpr double kStep = 0.5, kSpeed = 3, kSpin = 3000, kApart = 1e-3;
    int slowed = 0, pairs = 0, risen = 0;
    for (int pair = 0; pair < kPairs; ++pair) {
        std::uint64_t drawn = 0;
        const auto draw = [&] { return 2 * unit_interval(random_bits(static_cast<std::uint64_t>(pair), drawn++)) - 1; };
        const auto vector = [&](double most) { return most * Vec3{draw(), draw(), draw()}; };
        Settings settings = run.settings();
        settings.time_step = kStep;
        SceneDescription scene = make_scene_with(settings);
        const auto one = add_shape(scene, make_ring(1e-3, 2e-4, 6, 4), 2),
                   other = add_shape(scene, make_ring(8e-4, 2e-4, 8, 3), 1);
        for (const auto shape : {one, other}) {
            auto& body = add_body(scene, shape, BodyType::dynamic, {shape == one ? 0 : kApart, 0, 0}, 0.5, 1);
            body.rotation = rotation_from_vector(vector(kPi));
            body.velocity = vector(kSpeed);
            body.angular_velocity = vector(kSpin);
        }
        try {
            Motion motion(scene);
            for (int step = 0; step < kSteps; ++step) slowed += motion.step().rung_changes > 0 ? 1 : 0;
            ++pairs;
            risen += motion.outcome().rise > kRise ? 1 : 0;
        } catch (const Error&) { // they intersect at the start
        }
    }
    std::printf("LinkedRingsFall: %d pairs, %d steps with bodies slowed, energy rose in %d\n", pairs, slowed, risen);
    EXPECT_GT(slowed, 3);
    EXPECT_EQ(risen, 0);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once{{"balanced", 24}, {"accurate", 24}, {"reference", 24}};
    add_runs("Energy", "TenBoxesFallOneCentimetreApart", runs(), true,
             [](const Run& r) { fall_as_a_stack(r, 10, r.dt(), 2); });
    add_runs("Energy", "FiftyBoxesFallOneCentimetreApart", once, false,
             [](const Run& r) { fall_as_a_stack(r, 50, r.dt(), 2); });
    add_runs("Energy", "TenBoxesFallAtASixthOfASecond", once, true,
             [](const Run& r) { fall_as_a_stack(r, 10, 1.0 / 6, 4); });
    for (const int friction : {2, 10, 100, 1000})
        add_runs("Energy", "HeapWithFriction" + std::to_string(friction), once, true,
                 [=](const Run& r) { heap_with_friction(r, friction); });
    add_runs("Energy", "LinkedRingsFall", once, true, linked_rings_fall);
    add_runs("Energy", "FrictionlessBoxBouncesForEver", runs(), true, bouncing_box);
    add_runs("Energy", "CubesInAClosedBoxKeepIt", runs({24, 240}), true, closed_box);
    add_runs("Energy", "BoatsAtAStepOfASecond", once, true, boats_at_a_step_of_a_second);
    add_runs("Energy", "BoatsOfThreeMillimetresLand", runs({24}), true,
             [](const Run& r) { small_boats_in_a_bowl(r, 0.5); });
    add_runs("Energy", "BoatsOfThreeMillimetresSettle", {Run{}}, false,
             [](const Run& r) { small_boats_in_a_bowl(r, 2); });
    for (const int speed : {100, 1000, 10000})
        add_runs("Energy", "PlateSpinsAt" + std::to_string(speed), once, true,
                 [=](const Run& r) { spinning_plate(r, speed); });
    for (const int speed : {100, 1000})
        add_runs("Energy", "PlatesShotAtAWallAt" + std::to_string(speed), once, true,
                 [=](const Run& r) { plates_shot_at_a_wall(r, speed); });
    add_runs("Energy", "PlatesThatFlyTogether", runs(), true, plates_that_fly_together);
    add_runs("Energy", "StickSwingsInATroughBy100Milliradians", {{"balanced", 60}, {"balanced", 240}, {"accurate", 60}},
             true, [](const Run& r) { stick_swings_in_a_trough(r, 0.1); });
    add_runs("Energy", "StickSwingsInATroughBy20Milliradians", {{"balanced", 240}, {"accurate", 60}}, true,
             [](const Run& r) { stick_swings_in_a_trough(r, 0.02); });
    add_runs("Energy", "BallSwingsInATrough",
             {{"balanced", 24}, {"balanced", 60}, {"balanced", 240}, {"preview", 24}, {"accurate", 24}}, true,
             ball_swings_in_a_trough);
    return true;
}();

} // namespace
} // namespace flotilla::physics
