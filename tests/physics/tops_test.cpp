// SPDX-License-Identifier: MIT
// Tops, a block that tips over, Euler's disk, and a ring that swings on a knife edge.
#include "physics/physics.hpp"
#include "physics/problems/tops.hpp"

namespace flotilla::physics {
namespace {

void asymmetric_top_moves(const Run& run) {
    Motion motion(asymmetric_top(run.settings()));
    double drift = 0;
    History history(run.dt());
    history.add({0, {motion.body(0)}});
    motion.run(55, [&](const StepReport& r) {
        history.add({r.time, {motion.body(0)}});
        drift = std::max(drift, length(r.angular_momentum - kFlipMomentum) / length(kFlipMomentum));
    });
    const double period = flip_period(history);
    const double energy = std::abs(motion.outcome().end / motion.outcome().start - 1);
    motion.print("period %.5f of %.5f s, energy off by %.2g, angular momentum by %.2g", period, kFlipPeriod, energy,
                 drift);
    EXPECT_NEAR(period / kFlipPeriod, 1, 0.01);
    EXPECT_LT(energy, 1e-12);
    EXPECT_LT(drift, 1e-12);
}

void symmetric_top_moves(const Run& run) {
    Motion motion(symmetric_top(run.settings()));
    const double off = axis_off(motion.record(10)), step = length(kTopMomentum) * run.dt(),
                 angle = length(kTopMomentum) * motion.world().time();
    motion.print("axis off by %.3g rad", off);
    // Second order: the precession of a step is off by its cube, a twelfth of it for the midpoint rule.
    EXPECT_LT(off, step * step * angle);
}

// A top that stands on its tip: second order in the turn of a step, which is 0.6 rad at 1/24 s. It begins a rounding
// above the ground, and its tip moves by a fifth of a millimetre until it stands, whatever the step.
void heavy_top_precesses(const Run& run) {
    Motion motion(heavy_top(run.settings()));
    const History history = motion.record(kHeavyTopTime);
    const double off = heavy_top_off(history), tip = tip_off(history);
    const double kept = motion.outcome().end / motion.outcome().start;
    motion.print("axis off by %.3g rad, tip by %.3g m, keeps %.5f of its energy", off, tip, kept);
    const double coarse = 24.0 / run.rate;
    EXPECT_LT(off, 0.2 * coarse * coarse + 5e-4);
    EXPECT_LT(tip, 0.05 * coarse * coarse + 5e-4);
    EXPECT_NEAR(kept, 1, 1e-3);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_no_rise(motion);
}

// A toy that turns by more than a radian in a step, about its tip, which hardly moves for it: it goes round at the rate of
// steady precession, at its tilt.
void fast_top_precesses(const Run& run, double spin) {
    constexpr double kHigh = 0.05, kArm = 0.04, kMass = 0.2, kAcross = 2e-4, kAlong = 3e-4, kTilt = 0.3; // kg m^2
    SceneDescription scene = make_scene_with(run.settings());
    TriangleMesh mesh = make_cone(1, 24);
    for (Vec3& v : mesh.vertices) v = kHigh * v;
    const auto top = add_shape(scene, mesh, kMass);
    scene.shapes.back().inertia = Mat3{{kAcross, 0, 0, 0, kAcross, 0, 0, 0, kAlong}};
    scene.shapes.back().center_of_mass = Vec3{0, 0, kArm};
    auto& body = add_body(scene, top, BodyType::dynamic, {0, 0, rest_gap(mesh)}, 0.5, 0);
    body.rotation = rotation_from_vector({0, kTilt, 0});
    const Vec3 axis = rotate(body.rotation, {0, 0, 1}), up{0, 0, 1};
    const double about_tip = (kAcross + kMass * kArm * kArm) * std::cos(kTilt), l = kAlong * spin;
    const double rate = (l - std::sqrt(l * l - 4 * about_tip * kMass * kGravity * kArm)) / (2 * about_tip);
    body.angular_velocity = (spin - rate * std::cos(kTilt)) * axis + rate * up;
    body.velocity = cross(body.angular_velocity, kArm * axis);
    add_ground(scene, 20, 0.5, 0);
    Motion motion(scene);
    double tilt = 0, wandered = 0;
    motion.run(2, [&](const StepReport&) {
        const BodyState s = motion.body(0);
        tilt = std::max(tilt, std::abs(std::acos(rotate(s.rotation, {0, 0, 1}).z) - kTilt));
        wandered = std::max(wandered, std::hypot(s.position.x, s.position.y));
    });
    const double kept = motion.outcome().end / motion.outcome().start;
    motion.print("tilt off by %.3g rad, tip by %.3g m, keeps %.5f of its energy", tilt, wandered, kept);
    EXPECT_LT(tilt, 0.05);
    EXPECT_LT(wandered, 0.01);
    EXPECT_NEAR(kept, 1, 0.01);
    expect_no_rise(motion);
}

void block_tips_over_its_edge(const Run& run) {
    Motion motion(tipping_block(run.settings()));
    const Tipping found = tipping(motion.record(kTippingTime));
    motion.print("centre off by %.3g m, speed by %.3g, edge by %.3g m", found.off, found.speed, found.edge);
    const double coarse = 24.0 / run.rate;
    EXPECT_LT(found.off, 2e-3 * coarse * coarse + 1e-5);
    EXPECT_NEAR(found.speed, 0, 0.02 * coarse * coarse + 1e-4);
    EXPECT_LT(found.edge, 1e-3 * coarse * coarse + 1e-5);
    EXPECT_EQ(motion.outcome().held, 0);
    expect_no_rise(motion);
}

void eulers_disk_moves(const Run& run) {
    Motion motion(eulers_disk(run.settings()));
    const double start = motion.outcome().start_total, worst = disk(motion.record(0.5)).worst;
    const double kept = motion.outcome().end_total / start;
    motion.print("keeps %.4f of its energy, W^2 sin(alpha) off by up to %.3g", kept, worst);
    expect_no_rise(motion);
    if (run.rate < 120) return; // the disk's point of contact runs 0.35 m in a step of 1/24 s
    EXPECT_NEAR(kept, 1, 0.1);
    EXPECT_LT(worst, 0.05);
}

void ring_on_a_knife_edge(const Run& run) {
    Motion motion(ring_on_knife_edge(run.settings()));
    const double due = due_ring_period();
    const auto [kept, period] = swing(motion.record(kRingPeriods * due));
    motion.print("keeps %.3f of its amplitude, period %.4f of %.4f s", kept, period, due);
    expect_no_rise(motion);
    EXPECT_EQ(motion.outcome().held, 0);
    if (run.rate < 120) return;
    EXPECT_NEAR(kept, 1, 0.1);
    EXPECT_NEAR(period / due, 1, 0.02);
}

[[maybe_unused]] const bool registered = [] {
    add_runs("Tops", "AsymmetricTopFlipsInTime", runs(), true, asymmetric_top_moves);
    add_runs("Tops", "SymmetricTopPrecesses", runs(), true, symmetric_top_moves);
    add_runs("Tops", "HeavyTopPrecesses", runs(), true, heavy_top_precesses);
    for (const int spin : {60, 200})
        add_runs("Tops", "TopOf" + std::to_string(spin) + "RadiansASecondPrecesses",
                 {{"balanced", 24}, {"balanced", 60}, {"balanced", 120}, {"preview", 60}, {"accurate", 24}}, true,
                 [=](const Run& r) { fast_top_precesses(r, spin); });
    add_runs("Tops", "BlockTipsOverItsEdge", runs(), true, block_tips_over_its_edge);
    add_runs("Tops", "EulersDisk", runs({120, 24, 480}), true, eulers_disk_moves); // 1/24 s is asked little
    add_runs("Tops", "RingSwingsOnAKnifeEdge", runs(), true, ring_on_a_knife_edge);
    return true;
}();

} // namespace
} // namespace flotilla::physics
