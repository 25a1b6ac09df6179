// SPDX-License-Identifier: MIT
// Rolling: on the level, down a slope, and from sliding to rolling.
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

constexpr double kRadius = 0.5; // m

/// What rolls about the y axis. `inertia` is that about this axis over m r^2.
struct Roller {
    const char* name;
    TriangleMesh (*mesh)();
    bool solid;
    double inertia;
    double sides; ///< around
};

template <int sides>
TriangleMesh cylinder() {
    return make_cylinder(kRadius, 0.6, sides);
}
TriangleMesh tube() { return make_tube(kRadius, 0.6, 512); }
TriangleMesh ball() { return make_sphere(kRadius, 5); }
TriangleMesh coarse_ball() { return make_sphere(kRadius, 3); }

constexpr Roller kCylinder{"Cylinder512", cylinder<512>, true, 1.0 / 2, 512};
constexpr Roller kTube{"Tube512", tube, false, 1, 512};
// A ball of 20 4^n triangles has about 5 2^n sides around.
constexpr Roller kBall{"Ball20480", ball, true, 2.0 / 5, 160};
constexpr Roller kHollowBall{"HollowBall20480", ball, false, 2.0 / 3, 160};
constexpr Roller kCoarseBall{"Ball1280", coarse_ball, true, 2.0 / 5, 40};

/// It rests on a side of its own (a vertex, for a ball) at the place where the slope's normal meets it, and rolls towards +x.
Motion roll(const Run& run, const Roller& roller, double slope, double friction, double speed, double spin) {
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = roller.mesh();
    const auto shape = roller.solid ? add_solid(scene, mesh, 100) : add_shape(scene, mesh, 50);
    const auto plane = add_shape(scene, make_plate(60, 10));
    const Quat tilt = rotation_from_vector({0, slope, 0});
    const bool round = roller.mesh == ball || roller.mesh == coarse_ball;
    const Quat axis = round ? Quat{} : rotation_from_vector({kPi / 2, 0, 0});
    auto& body = add_body(scene, shape, BodyType::dynamic, rotate(tilt, {0, 0, kRadius + rest_gap(mesh)}), friction, 0);
    body.rotation = tilt * axis;
    body.velocity = rotate(tilt, {speed, 0, 0});
    body.angular_velocity = rotate(tilt, {0, spin, 0});
    add_body(scene, plane, BodyType::fixed, {}, friction, 0).rotation = tilt;
    return Motion(scene);
}

// A polygon of n sides that rolls with pure impacts on its next corner loses (2 pi / n)^2 / 2 of its speed times 1 / (1 + inertia) each
// side: over an angle a it keeps exp(-pi a / n / (1 + inertia)), 99 % of a cylinder of 512 sides.
double kept_by_facets(const Roller& roller, double angle) {
    return std::exp(-kPi * angle / roller.sides / (1 + roller.inertia));
}

void keeps_rolling(const Run& run, const Roller& roller, double speed) {
    constexpr double kTime = 2;
    Motion motion = roll(run, roller, 0, 0.5, speed, speed / kRadius);
    motion.run(kTime);
    const double kept = motion.body(0).velocity.x / speed, due = kept_by_facets(roller, speed * kTime / kRadius);
    motion.print("keeps %.4f of its speed, due %.4f", kept, due);
    EXPECT_GT(kept, due - 0.005);
    EXPECT_LT(kept, 1.001);
    expect_no_rise(motion);
}

// Between a polygon of so many sides and a round body, within 2 %. Sides that cost exp(-c a) over an angle a cost two thirds of it
// where the angle grows with the square of time: the mean of 1 - t^2 is 2/3.
void rolls_down(const Run& run, const Roller& roller) {
    constexpr double kSlope = 5 * kDegree, kTime = 2;
    Motion motion = roll(run, roller, kSlope, 0.5, 0, 0);
    motion.run(kTime);
    const Vec3 down = rotate(rotation_from_vector({0, kSlope, 0}), {1, 0, 0});
    const double due = kGravity * std::sin(kSlope) / (1 + roller.inertia) * motion.world().time();
    const double share = dot(motion.body(0).velocity, down) / due;
    const double angle = 0.5 * due / kRadius * motion.world().time(),
                 sides = 1 - 2.0 / 3 * (1 - kept_by_facets(roller, angle));
    motion.print("%.4f of the due speed %.4g m/s, %.4f with its sides", share, due, sides);
    EXPECT_GT(share, sides - 0.02);
    EXPECT_LT(share, 1.02);
    expect_no_rise(motion);
}

// Friction mu g brakes the sliding until the point of contact rests: v0 / (1 + inertia) at t = v0 inertia / ((1 + inertia) mu g). The
// sides take their share of the spin as it turns, by half the angle of rolling at its last speed, so that it slides for longer: a ball
// of 20,480 triangles for 0.5895 s at 1/7680 s, 1.1 % longer than a sphere.
void slides_until_it_rolls(const Run& run, const Roller& roller) {
    constexpr double kSpeed = 2, kFriction = 0.1;
    Motion motion = roll(run, roller, 0, kFriction, kSpeed, 0);
    const double due = kSpeed / (1 + roller.inertia),
                 due_time = kSpeed * roller.inertia / ((1 + roller.inertia) * kFriction * kGravity);
    double time = 0, speed = 0;
    motion.run(1.3 * due_time, [&](const StepReport& r) {
        const BodyState s = motion.body(0);
        if (time == 0 && s.velocity.x - kRadius * s.angular_velocity.y < 1e-3 * kSpeed)
            time = r.time, speed = s.velocity.x;
    });
    motion.print("rolls at %.4g m/s after %.4g s, due %.4g m/s after %.4g s", speed, time, due, due_time);
    const double kept = kept_by_facets(roller, 0.5 * due / kRadius * due_time);
    const double latest = (kSpeed - kept * due) / (kFriction * kGravity), share = 0.01;
    // On a corner it is higher than on a side, and slower by the energy of that.
    const double height = kRadius * (1 - std::cos(kPi / roller.sides)),
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
    const double least = roller.inertia / (1 + roller.inertia) * std::tan(kSlope);
    Motion motion = roll(run, roller, kSlope, share * least, 0, 0);
    motion.run(0.5);
    const Vec3 down = rotate(rotation_from_vector({0, kSlope, 0}), {1, 0, 0});
    const BodyState s = motion.body(0);
    const double speed = dot(s.velocity, down), slip = 1 - kRadius * s.angular_velocity.y / speed;
    // What is missing of the friction turns it less: spin / speed = share (1 - least / tan) / (1 - share least / tan).
    const double part = least / std::tan(kSlope), due = share >= 1 ? 0 : 1 - share * (1 - part) / (1 - share * part);
    motion.print("slip %.4f of the speed, due %.4f", slip, due);
    EXPECT_NEAR(slip, due, 0.01);
    expect_no_rise(motion);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> once = runs({24});
    add_runs("Rolling", "Cylinder512KeepsItsSpeed", runs(), true,
             [](const Run& r) { keeps_rolling(r, kCylinder, 0.5); });
    // Several steps to a side: the corner that lands next must not carry before it does.
    add_runs("Rolling", "Cylinder512KeepsItsSpeedInSmallSteps", {{"balanced", 480}}, true,
             [](const Run& r) { keeps_rolling(r, kCylinder, 0.5); });
    static constexpr Roller kSides[] = {{"Cylinder256", cylinder<256>, true, 0.5, 256},
                                        {"Cylinder1024", cylinder<1024>, true, 0.5, 1024},
                                        {"Cylinder4096", cylinder<4096>, true, 0.5, 4096}};
    for (const Roller& roller : kSides) {
        add_runs("Rolling", std::string(roller.name) + "KeepsItsSpeed", once, roller.sides <= 1024,
                 [=](const Run& r) { keeps_rolling(r, roller, 0.5); });
        add_runs("Rolling", std::string(roller.name) + "RollsDown", once, roller.sides <= 1024,
                 [=](const Run& r) { rolls_down(r, roller); });
    }
    add_runs("Rolling", "BallKeepsItsSpeed", runs(), false, [](const Run& r) { keeps_rolling(r, kBall, 1); });
    for (const Roller& roller : {kCylinder, kTube, kBall, kHollowBall}) {
        const bool fast = roller.mesh != ball;
        add_runs("Rolling", std::string(roller.name) + "RollsDown", runs(), fast,
                 [=](const Run& r) { rolls_down(r, roller); });
        add_runs("Rolling", std::string(roller.name) + "SlidesUntilItRolls", runs(), fast,
                 [=](const Run& r) { slides_until_it_rolls(r, roller); });
    }
    add_runs("Rolling", "CoarseBallSlidesUntilItRolls", once, true,
             [](const Run& r) { slides_until_it_rolls(r, kCoarseBall); });
    for (const Roller& roller : {kCylinder, kTube}) {
        add_runs("Rolling", std::string(roller.name) + "RollsWithEnoughFriction", runs(), true,
                 [=](const Run& r) { rolls_where_friction_is_enough(r, roller, 1.05); });
        add_runs("Rolling", std::string(roller.name) + "SlipsWithTooLittle", runs(), kNotReached,
                 [=](const Run& r) { rolls_where_friction_is_enough(r, roller, 0.7); });
    }
    return true;
}();

} // namespace
} // namespace flotilla::physics
