// SPDX-License-Identifier: MIT
// What goes round with something else: the impulses that keep it on its circle are half at the start of a step and half
// at its end, those of static contact, with their friction.
#include <algorithm>
#include <cmath>

#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

// Two blocks on the inside of a free hoop turn with it, without gravity. Nothing slips and nothing outside acts: energy
// and angular momentum stay. To the fourth order in the angle of a step, by which a chord is shorter than its arc.
void hoop_keeps_its_spin(const Run& run) {
    constexpr double kRadius = 0.5, kRate = 4, kTime = 4, kMass = 4;
    SceneDescription scene = make_scene_with(run.settings(), {});
    const TriangleMesh mesh = make_box(0.04, 0.06, 0.06);
    const auto hoop = add_solid(scene, make_hoop(kRadius, 0.02, 0.2, 8), 100), block = add_shape(scene, mesh, kMass);
    auto& ring = add_body(scene, hoop, BodyType::dynamic, {}, 0.5, 0);
    ring.angular_velocity = {0, 0, kRate};
    const double middle = kRadius - 0.02 - rest_gap(mesh);
    for (const double side : {1.0, -1.0}) {
        auto& body = add_body(scene, block, BodyType::dynamic, {side * middle, 0, 0}, 0.5, 0);
        body.velocity = {0, side * middle * kRate, 0};
        body.angular_velocity = {0, 0, kRate};
    }
    Motion motion(scene);
    const double start = motion.step().angular_momentum.z;
    double end = 0;
    motion.run(kTime, [&](const StepReport& r) { end = r.angular_momentum.z; });
    const double kept = end / start, energy = motion.outcome().end / motion.outcome().start;
    motion.print("keeps %.5f of its angular momentum, %.5f of its energy", kept, energy);
    const double step = kRate * run.dt(), due = 0.25 * step * step * step * kRate * kTime; // what chords leave
    EXPECT_NEAR(kept, 1, 1e-4 + due);
    EXPECT_NEAR(energy, 1, 1e-3 + 2 * due);
    expect_no_rise(motion);
}

/// A motion told for each step, at its times and as many between.
template <class PoseAt>
void tell(BodyDescription& body, double time, const PoseAt& pose_at) {
    constexpr double kEvery = 1.0 / 960; // s
    for (int k = 0; k * kEvery <= time + 0.1; ++k) {
        const auto [position, rotation] = pose_at(k * kEvery);
        body.keyframes.push_back({k * kEvery, position, rotation});
    }
}

// A box on the inside of a wall that goes round is held by friction: mu w^2 r is 1.6 g.
void rotor_holds_a_box(const Run& run) {
    constexpr double kRadius = 3, kRate = 4, kFriction = 0.326, kTime = 2;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.3, 0.3, 0.3);
    TriangleMesh wall = make_box(0.1, 2, 2);
    for (Vec3& v : wall.vertices) v.x += kRadius + 0.2 + rest_gap(mesh);
    auto& box = add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic, {kRadius, 0, 0}, kFriction, 0);
    box.velocity = {0, kRate * kRadius, 0};
    box.angular_velocity = {0, 0, kRate};
    tell(add_body(scene, add_shape(scene, wall), BodyType::kinematic, {}, kFriction, 0), kTime, [](double t) {
        return std::pair(Vec3{}, rotation_from_vector({0, 0, kRate * t}));
    });
    Motion motion(scene);
    double least = 1e300, most = 0, lowest = 0; // N, m
    motion.run(kTime, [&](const StepReport& r) {
        if (r.time < 0.5) return;
        const Vec3 force = motion.force_on(0);
        least = std::min(least, std::hypot(force.x, force.y));
        most = std::max(most, std::hypot(force.x, force.y));
        lowest = std::min(lowest, motion.body(0).center_of_mass.z);
    });
    const double due = motion.mass(0) * kRate * kRate * kRadius;
    motion.print("pressed by %.4f to %.4f of m w^2 r, sinks by %.4g mm", least / due, most / due, -1e3 * lowest);
    EXPECT_NEAR(least / due, 1, 0.01);
    EXPECT_NEAR(most / due, 1, 0.01);
    EXPECT_GT(lowest, -5e-3);
}

// So is one that a wall pushes ahead, and that has come to rest against it before.
void wall_pushes_a_box(const Run& run, double rate) {
    constexpr double kFriction = 0.6, kTime = 2;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.3, 0.3, 0.3);
    const Vec3 start{-0.2 - rest_gap(mesh), 0, 0};
    add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic, {}, kFriction, 0);
    tell(add_body(scene, add_shape(scene, make_box(0.1, 2, 2)), BodyType::kinematic, start, kFriction, 0), kTime,
         [&](double t) {
             return std::pair(start + Vec3{0.5 * rate * t * t, 0, 0}, Quat{});
         });
    Motion motion(scene);
    double least = 1e300, most = 0; // N
    motion.run(kTime, [&](const StepReport& r) {
        if (r.time < 0.5) return;
        least = std::min(least, motion.force_on(0).x);
        most = std::max(most, motion.force_on(0).x);
    });
    const double due = motion.mass(0) * rate, sinks = -motion.body(0).center_of_mass.z;
    motion.print("pressed by %.4f to %.4f of m a, sinks by %.4g mm", least / due, most / due, 1e3 * sinks);
    EXPECT_NEAR(least / due, 1, 0.01);
    EXPECT_NEAR(most / due, 1, 0.01);
    EXPECT_LT(sinks, 2e-3); // the wall begins to push in the first step
}

/// m, where the block is on the sheet that carries it round, from the sheet's middle, in its axes.
Vec3 place_on(const Motion& motion) {
    const BodyState block = motion.body(0), sheet = motion.body(1);
    return rotate(conjugate(sheet.rotation), block.center_of_mass - sheet.position);
}

/// A block that sticks to a sheet which turns at `rate`, and where it comes in `time`: the farthest, m.
template <class PoseAt>
double creeps_on(const Run& run, double friction, const Vec3& rate, double along, double time, const PoseAt& pose_at) {
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_box(0.06, 0.06, 0.03);
    const auto [position, rotation] = pose_at(0);
    const Vec3 start = position + rotate(rotation, {along, 0, 0.015 + rest_gap(mesh)});
    auto& block = add_body(scene, add_solid(scene, mesh, 1000), BodyType::dynamic, start, friction, 0);
    block.rotation = rotation;
    block.velocity = cross(rate, start);
    block.angular_velocity = rate;
    auto& sheet = add_body(scene, add_shape(scene, make_plate(2, 2)), BodyType::kinematic, position, friction, 0);
    sheet.rotation = rotation;
    tell(sheet, time, pose_at);
    Motion motion(scene);
    const Vec3 from = place_on(motion);
    double most = 0;
    motion.run(time, [&](const StepReport&) { most = std::max(most, length(place_on(motion) - from)); });
    motion.print("comes %.4g mm from its place in %.3g s", 1e3 * most, time);
    return most;
}

// What is left falls at least with the step: less than the square of the angle of a step, in radii, each second.
void slope_turns_under_a_block(const Run& run) {
    constexpr double kRate = 3.6, kSlope = kPi / 4, kAlong = 0.7, kTime = 4;
    const double creeps = creeps_on(run, 0.9, {0, 0, kRate}, kAlong, kTime, [](double t) {
        return std::pair(Vec3{}, rotation_from_vector({0, 0, kRate * t}) * rotation_from_vector({0, -kSlope, 0}));
    });
    const double step = kRate * run.dt();
    EXPECT_LT(creeps, 1e-4 + kAlong * step * step * kTime);
}
void tray_goes_round(const Run& run) {
    constexpr double kRate = 5, kTime = 4;
    const double creeps = creeps_on(run, 0.6, {0, -kRate, 0}, 0, kTime, [](double t) {
        const Quat turned = rotation_from_vector({0, -kRate * t, 0});
        return std::pair(rotate(turned, {0, 0, -1}), turned);
    });
    const double step = kRate * run.dt();
    EXPECT_LT(creeps, 1e-4 + step * step * kTime * 0.1);
}

[[maybe_unused]] const bool registered = [] {
    const std::vector<Run> all{{"balanced", 60}, {"balanced", 24},  {"balanced", 240}, {"preview", 60},
                               {"accurate", 60}, {"accurate", 120}, {"reference", 60}};
    const std::vector<Run> fine{{"balanced", 60}, {"balanced", 240}, {"preview", 60}, {"accurate", 60}};
    add_runs("Turning", "HoopKeepsItsSpin", all, true, hoop_keeps_its_spin);
    add_runs("Turning", "RotorHoldsABox", fine, true, rotor_holds_a_box); // at 1/24 s it goes its size and two thirds
    add_runs("Turning", "WallPushesABox", all, true, [](const Run& r) { wall_pushes_a_box(r, 40); });
    add_runs("Turning", "WallPushesABoxTenTimesAsFast", all, false, [](const Run& r) { wall_pushes_a_box(r, 400); });
    add_runs("Turning", "SlopeTurnsUnderABlock", all, true, slope_turns_under_a_block);
    add_runs("Turning", "TrayGoesRound", fine, true, tray_goes_round); // a fifth of a radian a step is too much for it
    return true;
}();

} // namespace
} // namespace flotilla::physics
