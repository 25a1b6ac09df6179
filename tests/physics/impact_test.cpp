// SPDX-License-Identifier: MIT
// Impacts: free fall, bounces, what lands flat, what hands a blow on.
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

// Exact for constant gravity but for rounding.
void ballistic(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto box = add_solid(scene, make_box(1, 0.7, 0.4), 500);
    auto& body = add_body(scene, box, BodyType::dynamic, {1, 2, 3});
    body.velocity = {4, -3, 10};
    body.angular_velocity = {1, 5, -2};
    Motion motion(scene);
    double worst = 0, most = 3;
    motion.run(2, [&](const StepReport& r) {
        const Vec3 due = Vec3{1, 2, 3} + r.time * Vec3{4, -3, 10} - Vec3{0, 0, 0.5 * kGravity * r.time * r.time};
        worst = std::max(worst, length(motion.body(0).center_of_mass - due));
        most = std::max(most, length(due));
    });
    motion.print("off by %.3g m", worst);
    EXPECT_LE(worst, 10 * motion.outcome().steps * scenario::kRoundOff * most);
    EXPECT_LT(motion.outcome().rise, 1e-11);
}

/// A body on a single point above a plate, each rise of which is e^2 of that before.
struct Bounces {
    std::vector<double> heights;
    double end_of_bouncing = 0; ///< s, since when it stays within a rest distance of the plate
};

Bounces bounce(Motion& motion, double time) {
    Bounces out;
    double peak = 0;
    bool falls = true;
    const double rest = motion.size(0) / 330;
    motion.run(time, [&](const StepReport& r) {
        const BodyState s = motion.body(0);
        const double gap = s.position.z - 0.5;
        if (gap > 2 * rest) out.end_of_bouncing = r.time;
        if (s.velocity.z > 0) {
            falls = false;
            peak = std::max(peak, gap + 0.5 * s.velocity.z * s.velocity.z / kGravity);
        } else if (!falls) {
            out.heights.push_back(peak);
            falls = true, peak = 0;
        }
    });
    return out;
}

// Each bounce misses its height by what the fall of a step is worth: v dt (1 - e^2), and that of those before.
void bounces(const Run& run, double e) {
    constexpr double kHeight = 5;
    SceneDescription scene = make_scene_with(run.settings());
    add_body(scene, add_shape(scene, scenario::make_octahedron(0.5), 2), BodyType::dynamic, {0.1, 0.23, 0.5 + kHeight},
             0, e);
    add_ground(scene, 10, 0, e);
    Motion motion(scene);
    const double due_time = std::sqrt(2 * kHeight / kGravity) * (1 + e) / (1 - e);
    const Bounces b = bounce(motion, 1.3 * due_time);
    ASSERT_GE(b.heights.size(), 3u);
    motion.print("heights %.4f %.4f %.4f of %.4f %.4f %.4f m, stops at %.3f of %.3f s", b.heights[0], b.heights[1],
                 b.heights[2], kHeight * e * e, kHeight * std::pow(e, 4), kHeight * std::pow(e, 6), b.end_of_bouncing,
                 due_time);
    double exact = kHeight, bound = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double v = std::sqrt(2 * kGravity * (exact + bound));
        bound = e * e * bound + (1 - e * e) * (v * run.dt() + 2.0 / 330) + kGravity * run.dt() * run.dt();
        exact *= e * e;
        EXPECT_NEAR(b.heights[i], exact, bound) << "bounce " << i;
    }
    expect_no_rise(motion);
}

// All corners hit at once: no spin, no tilt, and each rise as for a point.
void lands_flat(const Run& run, double e) {
    SceneDescription scene = make_scene_with(run.settings());
    const auto crate = add_solid(scene, make_box(1, 1, 1), 200);
    add_body(scene, crate, BodyType::dynamic, {0, 0, 0.5 + 1}, 0.3, e).rotation = rotation_from_vector({0, 0, 0.3});
    add_ground(scene, 20, 0.3, e);
    Motion motion(scene);
    double hit = 0, spin = 0, tilt = 0;
    const double fall = std::sqrt(2 / kGravity);
    motion.run(fall + run.dt() + 0.25, [&](const StepReport& r) {
        const BodyState s = motion.body(0);
        if (hit == 0 && s.velocity.z > 0) hit = r.time;
        const double turning = 0.5 * motion.mass(0) / 6 * length_sq(s.angular_velocity);
        spin = std::max(spin, turning / (motion.mass(0) * kGravity));
        tilt = std::max(tilt, std::acos(std::min(1.0, rotate(s.rotation, {0, 0, 1}).z)) / kDegree);
    });
    motion.print("%.3g of its energy in spin, tilted by %.3g degrees", spin, tilt);
    EXPECT_LT(spin, 1e-6);
    EXPECT_LT(tilt, 0.05);
    expect_no_rise(motion);
}

// N equal bodies in a row, met one after the other: the last one leaves with ((1 + e) / 2)^(N - 1) of the first one's speed.
void cradle(const Run& run, double e) {
    constexpr int kBodies = 5;
    constexpr double kSpeed = 2;
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto ball = add_solid(scene, make_box(1, 1, 1), 100);
    for (int i = 0; i < kBodies; ++i)
        add_body(scene, ball, BodyType::dynamic, {1.2 * i, 0, 0}, 0, e).velocity = {i == 0 ? kSpeed : 0, 0, 0};
    Motion motion(scene);
    Vec3 momentum;
    motion.run(2.5, [&](const StepReport& r) { momentum = r.momentum; });
    const double due = std::pow((1 + e) / 2, kBodies - 1) * kSpeed, last = motion.body(kBodies - 1).velocity.x;
    double spin = 0;
    for (std::size_t i = 0; i < kBodies; ++i) spin = std::max(spin, length(motion.body(i).angular_velocity));
    const double start = motion.mass(0) * kSpeed;
    motion.print("last at %.5g m/s, due %.5g; spin %.3g rad/s", last, due, spin);
    EXPECT_NEAR(last, due, 1e-3 * kSpeed);
    EXPECT_LT(spin, 1e-3);
    EXPECT_LT(length(momentum - Vec3{start, 0, 0}), 1e-12 * start);
    expect_no_rise(motion);
}

[[maybe_unused]] const bool registered = [] {
    add_runs("Impact", "FreeFallIsExact", runs(), true, ballistic);
    for (const int e : {50, 80})
        add_runs("Impact", "BouncesWithRestitution0_" + std::to_string(e), runs(), true,
                 [=](const Run& r) { bounces(r, 0.01 * e); });
    for (const int e : {0, 50, 90})
        add_runs("Impact", "CrateLandsFlatWithRestitution" + std::to_string(e) + "Percent", runs(), true,
                 [=](const Run& r) { lands_flat(r, 0.01 * e); });
    for (const int e : {100, 50})
        add_runs("Impact", "CradleWithRestitution" + std::to_string(e) + "Percent", runs(), true,
                 [=](const Run& r) { cradle(r, 0.01 * e); });
    return true;
}();

} // namespace
} // namespace flotilla::physics
