// SPDX-License-Identifier: MIT
// Rolling: on the level, down a slope, and from sliding to rolling.
#include "physics/physics.hpp"

#include <cmath>

#include "physics/problems/rolling.hpp"
#include "scene/household_meshes.hpp"

namespace flotilla::physics {
namespace {

void keeps_rolling(const Run& run, const Roller& roller, double speed) {
    constexpr double kTime = 2;
    Motion motion(rolling_scene(run.settings(), roller, {0, 0.5, speed, speed / kRollerRadius}));
    motion.run(kTime);
    const double kept = motion.body(0).velocity.x / speed, due = kept_by_facets(roller, speed * kTime / kRollerRadius);
    motion.print("keeps %.4f of its speed, due %.4f", kept, due);
    EXPECT_GT(kept, due - 0.005);
    EXPECT_LT(kept, 1.001);
    expect_no_rise(motion);
}

// Between a polygon of so many sides and a round body, within 2 %. Sides that cost exp(-c a) over an angle a cost two
// thirds of it where the angle grows with the square of time: the mean of 1 - t^2 is 2/3.
void rolls_down(const Run& run, const Roller& roller) {
    constexpr double kSlope = 5 * kDegree, kTime = 2;
    Motion motion(rolling_scene(run.settings(), roller, {kSlope, 0.5}));
    const double share = rolled_share(motion.record(kTime), roller, kSlope);
    const double due = kGravity * std::sin(kSlope) / (1 + roller.inertia) * motion.world().time();
    const double angle = 0.5 * due / kRollerRadius * motion.world().time(),
                 sides = 1 - 2.0 / 3 * (1 - kept_by_facets(roller, angle));
    motion.print("%.4f of the due speed %.4g m/s, %.4f with its sides", share, due, sides);
    EXPECT_GT(share, sides - 0.02);
    EXPECT_LT(share, 1.02);
    expect_no_rise(motion);
}

// A motor: the torque of a tenth of its weight at its radius, within 2 % as above.
void rolls_by_a_torque(const Run& run, const Roller& roller) {
    constexpr double kShare = 0.1, kTime = 2;
    Motion motion(rolling_scene(run.settings(), roller, {}));
    World& world = motion.world();
    world.set_force(world.id(0), {}, {0, kShare * motion.mass(0) * kGravity * kRollerRadius, 0});
    for (int k = 0; k < kTime * run.rate; ++k) world.step(); // a Motion takes the work for a gain
    const double due = kShare * kGravity / (1 + roller.inertia) * world.time(),
                 angle = 0.5 * due / kRollerRadius * world.time(),
                 sides = 1 - 2.0 / 3 * (1 - kept_by_facets(roller, angle));
    const double share = motion.body(0).velocity.x / due;
    motion.print("%.4f of the due speed %.4g m/s, %.4f with its sides", share, due, sides);
    EXPECT_GT(share, sides - 0.02);
    EXPECT_LT(share, 1.02);
}

// Friction mu g brakes the sliding until the point of contact rests: v0 / (1 + inertia) at t = v0 inertia / ((1 +
// inertia) mu g). The sides take their share of the spin as it turns, by half the angle of rolling at its last speed,
// so that it slides for longer: a ball of 20,480 triangles for 0.5895 s at 1/7680 s, 1.1 % longer than a sphere.
void slides_until_it_rolls(const Run& run, const Roller& roller) {
    Motion motion(rolling_scene(run.settings(), roller, {0, kRollingFriction, kRollingSpeed}));
    const auto [due_time, due] = due_to_roll(roller);
    const auto [time, speed] = slide_to_roll(motion.record(1.3 * due_time));
    motion.print("rolls at %.4g m/s after %.4g s, due %.4g m/s after %.4g s", speed, time, due, due_time);
    const double kept = kept_by_facets(roller, 0.5 * due / kRollerRadius * due_time);
    const double latest = (kRollingSpeed - kept * due) / (kRollingFriction * kGravity), share = 0.01;
    // On a corner it is higher than on a side, and slower by the energy of that.
    const double height = kRollerRadius * (1 - std::cos(kPi / roller.sides)),
                 slower = kGravity * height / ((1 + roller.inertia) * due * due);
    EXPECT_GT(speed / due, kept - slower - share);
    EXPECT_LT(speed / due, 1 + slower + share);
    EXPECT_GT(time, (1 - share) * due_time - run.dt());
    EXPECT_LT(time, latest + share * due_time + run.dt());
    expect_no_rise(motion);
}

// A ball needs friction of 2/7 tan (hollow 2/5) to roll: with less it slides and gains less spin than speed.
void rolls_where_friction_is_enough(const Run& run, const Roller& roller, double share) {
    constexpr double kSlope = 30 * kDegree;
    Motion motion(rolling_scene(run.settings(), roller, {kSlope, share * least_rolling_friction(roller, kSlope)}));
    const double slip = physics::slip(motion.record(0.5), kSlope), due = due_slip(roller, kSlope, share);
    motion.print("slip %.4f of the speed, due %.4f", slip, due);
    EXPECT_NEAR(slip, due, 0.01);
    expect_no_rise(motion);
}

// Landings take what plastic impacts take, and nothing else does: it ends up on the side that they say, rocking.
void rolls_to_its_side(const Run& run) {
    constexpr int kSides = 16;
    constexpr double kSpeed = 0.8, kTime = 20;
    static constexpr Roller kPrism{"Prism16", cylinder_mesh<kSides>, true, false, 0.5, kSides};
    const double side = 2 * kRollerRadius * std::sin(kPi / kSides), spin = kSpeed / kRollerRadius;
    Motion motion(rolling_scene(run.settings(), kPrism, {0, 1, kSpeed, spin}));
    const double start = motion.body(0).position.x;
    motion.run(kTime);
    const double rolled = (motion.body(0).position.x - start) / side, due = sides_of_prism(kSides, spin);
    motion.print("rolls %.3f sides, due %.1f", rolled, due);
    EXPECT_NEAR(rolled, due, 1.1);
    expect_no_rise(motion);
}

// A body has one weight, on however many others it rolls.
void rolls_alike_on_strips(const Run& run) {
    constexpr int kSides = 64, kStrips = 4;
    constexpr double kSpeed = 1.4, kWidth = 1.5, kTime = 2;
    const auto speed_on = [&](int strips) {
        SceneDescription scene = make_scene_with(run.settings());
        const TriangleMesh mesh = make_cylinder(kRollerRadius, kWidth, kSides);
        const auto roller = add_solid(scene, mesh, 100), strip = add_shape(scene, make_plate(60, 2 * kWidth / strips));
        auto& body = add_body(scene, roller, BodyType::dynamic, {0, 0, kRollerRadius + rest_gap(mesh)}, 1, 0);
        body.rotation = rotation_from_vector({kPi / 2, 0, 0});
        body.velocity = {kSpeed, 0, 0};
        body.angular_velocity = {0, kSpeed / kRollerRadius, 0};
        for (int k = 0; k < strips; ++k)
            add_body(scene, strip, BodyType::fixed, {0, 2 * kWidth * ((k + 0.5) / strips - 0.5), 0}, 1, 0);
        Motion motion(scene);
        double tilt = 0;
        while (motion.world().time() < kTime) {
            motion.step();
            tilt = std::max(tilt, std::abs(motion.body(0).angular_velocity.x));
        }
        expect_no_rise(motion);
        EXPECT_LT(0.5 * kWidth * tilt, 0.01 * kSpeed); // m/s, of its ends
        return motion.body(0).velocity.x;
    };
    const double one = speed_on(1), many = speed_on(kStrips);
    std::printf("keeps %.4f of its speed, on strips %.4f\n", one / kSpeed, many / kSpeed);
    EXPECT_NEAR(many / one, 1, 0.005);
}

// A cylinder that is heavy on one side swings on its round one as a pendulum does, for ever but for what its sides take.
void swings_on_its_round_side(const Run& run, int sides) {
    constexpr double kRadius = 0.3, kOff = 0.1, kAngle = 0.4, kMass = 5, kTime = 3.6; // m, rad, kg, s
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_cylinder(kRadius, 0.4, sides);
    const auto shape = add_solid(scene, mesh, 100), plane = add_shape(scene, make_plate(9, 9));
    constexpr double kInertia = 0.4 * kMass * kRadius * kRadius;
    ShapeDescription& s = scene.shapes[static_cast<std::size_t>(shape)];
    s.mass_kind = MassKind::mass, s.mass_value = kMass;
    s.inertia = diagonal({kInertia, kInertia, kInertia}), s.center_of_mass = Vec3{0, -kOff, 0};
    const double side = 2 * kPi / sides, angle = side * std::round(kAngle / side);
    add_body(scene, shape, BodyType::dynamic, {0, 0, kRadius + rest_gap(mesh)}, 1, 0).rotation =
        rotation_from_vector({0, angle, 0}) * rotation_from_vector({kPi / 2, 0, 0});
    add_body(scene, plane, BodyType::fixed, {}, 1, 0);
    Motion motion(scene);
    std::vector<double> farthest{0}; // rad, by half swing
    double last = angle;
    motion.run(kTime, [&](const StepReport&) {
        const double now = -std::asin(rotate(motion.body(0).rotation, {1, 0, 0}).z);
        if (last * now < 0) farthest.push_back(0);
        farthest.back() = std::max(farthest.back(), std::abs(now));
        last = now;
    });
    const double kept = farthest.size() > 3 ? farthest[3] / angle : 0;
    motion.print("comes back to %.4f of its angle in the third half swing", kept);
    EXPECT_GT(kept, 0.97);
    EXPECT_LT(kept, 1.01);
    expect_no_rise(motion);
}

std::vector<library::OutlinePoint> circle(double radius, int sides) {
    std::vector<library::OutlinePoint> points;
    for (int k = 0; k < sides; ++k) {
        const SinCos angle = sin_cos(2 * kPi * k / sides);
        points.push_back({radius * angle.cos, radius * angle.sin});
    }
    return points;
}

// A wheel on a fixed axle of 20 mm along y, with less play than its rest distance: what its corners come nearer as it
// turns, 0.1 mm at 32 sides, is not to brake it. Nothing else does without gravity; with it the wheel comes down, and
// its sides cost something.
void wheel_turns_on_its_axle(const Run& run, double gravity, double play, int sides) {
    constexpr double kAxle = 0.02, kRadius = 0.3, kWidth = 0.04, kSpeed = 3, kTime = 1;
    SceneDescription scene = make_scene_with(run.settings(), {0, 0, -gravity});
    const Quat along_y = rotation_from_vector({kPi / 2, 0, 0});
    add_body(scene, add_shape(scene, make_cylinder(kAxle, 0.3, sides), 1), BodyType::fixed, {}, 0, 0).rotation =
        along_y;
    const TriangleMesh wheel = library::extrude(circle(kRadius, sides), circle(kAxle + play, sides), kWidth);
    BodyDescription& body = add_body(scene, add_solid(scene, wheel, 1000), BodyType::dynamic, {}, 0, 0);
    body.rotation = along_y;
    body.angular_velocity = {0, kSpeed, 0};
    Motion motion(scene);
    motion.run(kTime);
    const double kept = motion.body(1).angular_velocity.y / kSpeed;
    motion.print("play %g m, %d sides, gravity %g: keeps %.5f of its speed", play, sides, gravity, kept);
    EXPECT_GT(kept, gravity > 0 ? 0.95 : 1 - 1e-6);
    EXPECT_LT(kept, 1 + 1e-6);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_no_rise(motion);
}

// A thin axle with heavy discs, whose radius of gyration is four times its own, spins on a rail and slides along it.
void axle_slides(const Run& run) {
    constexpr double kRadius = 0.01, kGyration = 0.04, kSpin = 60, kFriction = 0.2, kTime = 0.15;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_cylinder(kRadius, 0.06, 256);
    const auto axle = add_shape(scene, mesh, 1), rail = add_shape(scene, make_box(4, 0.04, 0.1));
    const double inertia = kGyration * kGyration;
    scene.shapes[static_cast<std::size_t>(axle)].inertia = diagonal({0.6 * inertia, 0.6 * inertia, inertia});
    auto& body = add_body(scene, axle, BodyType::dynamic, {0, 0, kRadius + rest_gap(mesh)}, kFriction, 0);
    body.rotation = rotation_from_vector({kPi / 2, 0, 0});
    body.angular_velocity = {0, kSpin, 0};
    body.locked_translation = {false, true, false};
    body.locked_rotation = {true, false, true};
    add_body(scene, rail, BodyType::fixed, {0, 0, -0.05}, kFriction, 0);
    Motion motion(scene);
    motion.run(kTime);
    const double share = motion.body(0).velocity.x / (kFriction * kGravity * motion.world().time());
    motion.print("gains %.4f of the speed that friction gives", share);
    EXPECT_NEAR(share, 1, 0.02);
    expect_no_rise(motion);
}

// A roller on a plank that lies loose on two blocks, so many times lighter: in each step a side of the one comes down a
// little ahead of it, and pushes the other to the blocks.
void rolls_over_a_plank(const Run& run, double ratio) {
    constexpr double kSpeed = 1, kTime = 0.8, kRadius = 0.1, kWay = 0.8;
    constexpr int kSides = 96;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh plank = make_box(2.3, 0.3, 0.02), mesh = make_cylinder(kRadius, 0.25, kSides);
    const auto block = add_shape(scene, make_box(0.4, 0.4, 0.2));
    const double under = rest_gap(plank), over = under + 0.02 + std::min(under, rest_gap(mesh)) + kRadius;
    add_body(scene, add_shape(scene, mesh, ratio), BodyType::dynamic, {-kWay, 0, over}, 0.5, 0).rotation =
        rotation_from_vector({kPi / 2, 0, 0});
    scene.bodies.back().velocity = {kSpeed, 0, 0};
    scene.bodies.back().angular_velocity = {0, kSpeed / kRadius, 0};
    add_body(scene, add_shape(scene, plank, 1), BodyType::dynamic, {0, 0, under + 0.01}, 0.5, 0);
    for (const double x : {-1.0, 1.0}) add_body(scene, block, BodyType::fixed, {x, 0, -0.1}, 0.5, 0);
    Motion motion(scene);
    motion.run(kTime);
    const double kept = motion.body(0).velocity.x / kSpeed,
                 due = std::exp(-kPi * kSpeed * kTime / kRadius / kSides / 1.5);
    motion.print("keeps %.4f of its speed, due %.4f", kept, due);
    EXPECT_GT(kept, due - 0.03);
    EXPECT_LT(kept, 1.02);
    EXPECT_EQ(motion.outcome().held, 0);
    EXPECT_EQ(motion.outcome().merges, 0);
    expect_no_rise(motion);
}

// A plank on four rollers, so many times heavier than one of them: what it presses goes through them to the ground, a few
// percent of their radius aside at either end while their sides land.
void rolls_on_rollers(const Run& run, double mass) {
    constexpr double kSlope = 6 * kDegree, kTime = 0.8, kRadius = 0.05, kRoller = 0.5, kAhead = 1e-4;
    constexpr int kSides = 64, kRollers = 4, kStarts = 4;
    for (int start = 0; start < kStarts; ++start) {
        SceneDescription scene = make_scene_with(run.settings());
        scene.gravity = kGravity * Vec3{std::sin(kSlope), 0, -std::cos(kSlope)};
        const TriangleMesh roller = make_cylinder(kRadius, 0.4, kSides), plank = make_box(1, 0.3, 0.04);
        const double under = rest_gap(roller), over = std::min(under, rest_gap(plank));
        const Quat across = rotation_from_vector({kPi / 2, 0, 0});
        // On a side, above and below.
        const Quat on_a_side = rotation_from_vector({0, kPi / kSides, 0}) * across;
        const double high = kRadius * std::cos(kPi / kSides);
        const auto shape = add_shape(scene, roller, kRoller);
        for (int k = 0; k < kRollers; ++k)
            add_body(scene, shape, BodyType::dynamic, {-0.3 + 0.2 * k + start * kAhead, 0, under + high}, 0.8, 0)
                .rotation = on_a_side;
        add_body(scene, add_shape(scene, plank, mass), BodyType::dynamic, {0, 0, under + over + 2 * high + 0.02}, 0.8,
                 0);
        add_body(scene, add_shape(scene, make_plate(20, 2)), BodyType::fixed, {}, 0.8, 0);
        Motion motion(scene);
        double removed = 0;
        motion.run(kTime, [&](const StepReport& report) { removed += report.energy_removed; });
        // Of an inertia of m r^2 / 2, at half the speed: M + 4 (m + m / 2) / 4, driven by M + 4 m / 2. Landing sides
        // take an eighth (1/960 s, preset paper).
        const double due = kGravity * std::sin(kSlope) * (mass + kRollers * kRoller / 2) /
                           (mass + kRollers * kRoller * 3 / 8) * motion.world().time();
        const double share = motion.body(kRollers).velocity.x / due;
        motion.print("%.4f of the due speed, %.3g J removed", share, removed);
        EXPECT_GT(share, 0.7);
        EXPECT_LT(share, 0.95);
        EXPECT_EQ(removed, 0);
        EXPECT_EQ(motion.outcome().held, 0);
        EXPECT_EQ(motion.outcome().merges, 0);
        expect_no_rise(motion);
    }
}

TriangleMesh wide_cylinder_mesh() { return make_cylinder(kRollerRadius, 6 * kRollerRadius, 512); }

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once = runs({24});
    add_runs("Rolling", "Cylinder512KeepsItsSpeed", runs(), true,
             [](const Run& r) { keeps_rolling(r, kCylinder, 0.5); });
    // A contact at its end is far from the centre of mass, and near the axis all the same.
    static constexpr Roller kWide{"WideCylinder512", wide_cylinder_mesh, true, false, 0.5, 512};
    add_runs("Rolling", "WideCylinder512KeepsItsSpeed", runs(), true,
             [](const Run& r) { keeps_rolling(r, kWide, 0.5); });
    add_runs("Rolling", "HeavyAxle256Slides", runs({60, 480}), true, axle_slides);
    std::vector<Run> prism = runs({120, 480});
    prism.push_back({"preview", 120});
    const std::vector<Run> often = {{"balanced", 60}, {"preview", 60}, {"balanced", 240}, {"accurate", 60}};
    for (const double play : {0.0005, 0.001, 0.0015}) {
        const std::string name = "WheelTurnsOnItsAxleWithPlayOf" + std::to_string(std::lround(play * 1e6)) + "um";
        add_runs("Rolling", name, often, true, [=](const Run& r) { wheel_turns_on_its_axle(r, 0, play, 32); });
        add_runs("Rolling", name + "InGravity", often, true,
                 [=](const Run& r) { wheel_turns_on_its_axle(r, kGravity, play, 32); });
    }
    for (const int ratio : {10, 100, 1000})
        add_runs("Rolling", "RollerOnAPlank" + std::to_string(ratio) + "TimesLighter",
                 {{"balanced", 60}, {"balanced", 24}, {"preview", 60}, {"balanced", 120}, {"accurate", 60}}, true,
                 [=](const Run& r) { rolls_over_a_plank(r, ratio); });
    for (const int mass : {10, 1000, 10'000, 100'000})
        add_runs("Rolling", "PlankOf" + std::to_string(mass) + "kgOnLightRollers",
                 {{"accurate", 24}, {"balanced", 60}, {"balanced", 24}, {"preview", 60}}, true,
                 [=](const Run& r) { rolls_on_rollers(r, mass); });
    add_runs("Rolling", "Prism16RollsToItsSide", prism, true, rolls_to_its_side);
    add_runs("Rolling", "Prism64RollsAlikeOnStrips", {{"balanced", 240}, {"accurate", 60}}, true,
             rolls_alike_on_strips);
    // Several steps to a side: the corner that lands next must not carry before it does.
    add_runs("Rolling", "Cylinder512KeepsItsSpeedInSmallSteps", {{"balanced", 480}}, true,
             [](const Run& r) { keeps_rolling(r, kCylinder, 0.5); });
    add_runs("Rolling", "Cylinder2048HeavyOnOneSideSwings",
             {{"balanced", 24}, {"balanced", 60}, {"balanced", 120}, {"accurate", 24}, {"reference", 24}}, true,
             [](const Run& r) { swings_on_its_round_side(r, 2048); });
    add_runs("Rolling", "Cylinder512HeavyOnOneSideSwings",
             {{"balanced", 24}, {"balanced", 120}, {"accurate", 24}, {"reference", 24}}, true,
             [](const Run& r) { swings_on_its_round_side(r, 512); });
    // Its tolerance, 25 times the others', must not hold up the side that lands next.
    add_runs("Rolling", "Cylinder512KeepsItsSpeedInPreview", {{"preview", 24}}, true,
             [](const Run& r) { keeps_rolling(r, kCylinder, 0.5); });
    static constexpr Roller kSides[] = {{"Cylinder256", cylinder_mesh<256>, true, false, 0.5, 256},
                                        {"Cylinder1024", cylinder_mesh<1024>, true, false, 0.5, 1024},
                                        {"Cylinder4096", cylinder_mesh<4096>, true, false, 0.5, 4096}};
    for (const Roller& roller : kSides) {
        add_runs("Rolling", std::string(roller.name) + "KeepsItsSpeed", once, roller.sides <= 1024,
                 [=](const Run& r) { keeps_rolling(r, roller, 0.5); });
        add_runs("Rolling", std::string(roller.name) + "RollsDown", once, roller.sides <= 1024,
                 [=](const Run& r) { rolls_down(r, roller); });
    }
    add_runs("Rolling", "BallKeepsItsSpeed", runs(), false, [](const Run& r) { keeps_rolling(r, kBall, 1); });
    for (const Roller& roller : {kCylinder, kTube, kBall, kHollowBall}) {
        const bool fast = !roller.round;
        add_runs("Rolling", std::string(roller.name) + "RollsDown", runs(), fast,
                 [=](const Run& r) { rolls_down(r, roller); });
        add_runs("Rolling", std::string(roller.name) + "SlidesUntilItRolls", runs(), fast,
                 [=](const Run& r) { slides_until_it_rolls(r, roller); });
    }
    add_runs("Rolling", "CoarseBallSlidesUntilItRolls", once, true,
             [](const Run& r) { slides_until_it_rolls(r, kCoarseBall); });
    for (const Roller& roller : {kCylinder, kTube}) {
        for (const int rate : {24, 60, 240})
            add_runs("Rolling", std::string(roller.name) + "RollsByATorque", {{"balanced", rate}}, true,
                     [=](const Run& r) { rolls_by_a_torque(r, roller); });
        add_runs("Rolling", std::string(roller.name) + "RollsWithEnoughFriction", runs(), true,
                 [=](const Run& r) { rolls_where_friction_is_enough(r, roller, 1.05); });
        add_runs("Rolling", std::string(roller.name) + "SlipsWithTooLittle", runs(), true,
                 [=](const Run& r) { rolls_where_friction_is_enough(r, roller, 0.7); });
    }
    return true;
}();

} // namespace
} // namespace flotilla::physics
