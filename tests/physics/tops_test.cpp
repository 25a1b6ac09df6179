// SPDX-License-Identifier: MIT
// Tops, Euler's disk, and a ring that swings on a knife edge.
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

// Inertia (1, 2, 3) kg m^2 and almost all spin about the middle axis: period 39.1057 s (elliptic integral), two flips in it.
void asymmetric_top(const Run& run) {
    constexpr double kDue = 39.1057;
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto top = add_shape(scene, make_box(1, 1, 1), 6);
    scene.shapes.back().inertia = Mat3{{1, 0, 0, 0, 2, 0, 0, 0, 3}};
    add_body(scene, top, BodyType::dynamic, {}).angular_velocity = {0.01, 1, 0.01};
    Motion motion(scene);
    double before = 1, first = 0, last = 0, drift = 0;
    int crossings = 0;
    const Vec3 momentum{0.01, 2, 0.03};
    motion.run(55, [&](const StepReport& r) {
        const BodyState s = motion.body(0);
        const double middle = rotate(conjugate(s.rotation), s.angular_velocity).y;
        if (middle * before < 0) {
            const double time = r.time - run.dt() * middle / (middle - before);
            if (crossings++ == 0) first = time;
            if (crossings == 3) last = time;
        }
        before = middle;
        drift = std::max(drift, length(r.angular_momentum - momentum) / length(momentum));
    });
    const double energy = std::abs(motion.outcome().end / motion.outcome().start - 1);
    motion.print("period %.5f of %.5f s, energy off by %.2g, angular momentum by %.2g", last - first, kDue, energy,
                 drift);
    EXPECT_NEAR((last - first) / kDue, 1, 0.01);
    EXPECT_LT(energy, 1e-12);
    EXPECT_LT(drift, 1e-12);
}

// A symmetric top turns about its own axis relative to the precession at (I3 - I1) w3 / I1, which precesses at L / I1.
void symmetric_top(const Run& run) {
    SceneDescription scene = make_scene_with(run.settings(), {});
    const auto top = add_shape(scene, make_box(1, 1, 1), 6);
    scene.shapes.back().inertia = Mat3{{1, 0, 0, 0, 1, 0, 0, 0, 1.5}};
    add_body(scene, top, BodyType::dynamic, {}).angular_velocity = {0.3, 0, 1};
    Motion motion(scene);
    constexpr double kTime = 10;
    motion.run(kTime);
    const Vec3 l{0.3, 0, 1.5}, axis = normalized(l);
    const double angle = length(l) * motion.world().time();
    const Vec3 due = rotate(rotation_from_vector(angle * axis), {0, 0, 1}),
               found = rotate(motion.body(0).rotation, {0, 0, 1});
    const double off = length(found - due), step = length(l) * run.dt();
    motion.print("axis off by %.3g rad", off);
    // Second order: the precession of a step is off by its cube, a twelfth of it for the midpoint rule.
    EXPECT_LT(off, step * step * angle);
}

// A disk that rolls at rest in the middle: tilted by alpha to the ground it precesses at W^2 sin(alpha) = 4 g / a with the energy
// 1.5 m g a sin(alpha), for ever without friction of rolling. It turns about the diameter to the point of contact at W sin(alpha).
void eulers_disk(const Run& run) {
    constexpr double kRadius = 0.5, kTilt = 0.3, kTime = 0.5;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_disc(kRadius, 512);
    const auto disc = add_shape(scene, mesh, 1);
    const double precession = std::sqrt(4 * kGravity / (kRadius * std::sin(kTilt)));
    auto& body = add_body(scene, disc, BodyType::dynamic, {0, 0, kRadius * std::sin(kTilt) + rest_gap(mesh)}, 1, 0);
    body.rotation = rotation_from_vector({0, kTilt, 0});
    body.angular_velocity = -precession * std::sin(kTilt) * rotate(body.rotation, {1, 0, 0});
    add_ground(scene, 20, 1, 0);
    Motion motion(scene);
    const double start = motion.outcome().start_total;
    double azimuth = 0, turned = 0, tilts = 0, worst = 0;
    int window = 0;
    const int kWindow = std::max(2, run.rate / 12); // steps over which the precession is measured
    motion.run(kTime, [&](const StepReport&) {
        const Vec3 n = rotate(motion.body(0).rotation, {0, 0, 1});
        const double now = std::atan2(n.y, n.x);
        turned += std::remainder(now - azimuth, 2 * kPi);
        azimuth = now;
        tilts += std::acos(std::min(1.0, std::abs(n.z)));
        if (++window < kWindow) return;
        const double tilt = tilts / window, rate = turned / (window * run.dt());
        if (tilt > 0.1) worst = std::max(worst, std::abs(rate * rate * std::sin(tilt) * kRadius / (4 * kGravity) - 1));
        window = 0, turned = 0, tilts = 0;
    });
    const double kept = motion.outcome().end_total / start;
    motion.print("keeps %.4f of its energy, W^2 sin(alpha) off by up to %.3g", kept, worst);
    expect_no_rise(motion);
    if (run.rate < 120) return; // the disk's point of contact runs 0.35 m in a step of 1/24 s
    EXPECT_NEAR(kept, 1, 0.1);
    EXPECT_LT(worst, 0.05);
}

// A ring hung over the upper edge of a blade turns about the corner of its hole that lies on the edge.
void ring_on_a_knife_edge(const Run& run) {
    constexpr double kRing = 0.5, kTube = 0.05, kAmplitude = 0.2, kArm = kRing - kTube;
    constexpr int kPeriods = 7;
    SceneDescription scene = make_scene_with(run.settings());
    const TriangleMesh mesh = make_ring(kRing, kTube, 32, 12);
    const auto ring = add_solid(scene, mesh, 1000), blade = add_shape(scene, make_plate(0.2, 0.6));
    const double inertia = kRing * kRing + 0.75 * kTube * kTube; // over m, about its axis
    const double due =
        2 * kPi * std::sqrt((inertia + kArm * kArm) / (kGravity * kArm)) * (1 + kAmplitude * kAmplitude / 16);
    const Quat upright = rotation_from_vector({kPi / 2, 0, 0}), swing = rotation_from_vector({0, kAmplitude, 0});
    add_body(scene, ring, BodyType::dynamic, rotate(swing, {0, 0, -kArm}) + Vec3{0, 0, rest_gap(mesh)}, 1, 0).rotation =
        swing * upright;
    add_body(scene, blade, BodyType::fixed, {0, 0, -0.1}, 1, 0).rotation = rotation_from_vector({0, kPi / 2, 0});
    Motion motion(scene);
    double before = -1, peak = 0, last_peak = 0, first = 0, last = 0;
    int crossings = 0;
    motion.run((kPeriods + 0.3) * due, [&](const StepReport& r) {
        const Vec3 at = motion.body(0).center_of_mass;
        const double angle = std::atan2(at.x, -at.z);
        if (angle * before < 0) {
            const double time = r.time - run.dt() * angle / (angle - before);
            if (crossings++ == 0) first = time;
            last = time;
            last_peak = peak, peak = 0;
        }
        peak = std::max(peak, std::abs(angle));
        before = angle;
    });
    const double kept = last_peak / kAmplitude, period = crossings > 1 ? 2 * (last - first) / (crossings - 1) : 0;
    motion.print("keeps %.3f of its amplitude, period %.4f of %.4f s", kept, period, due);
    expect_no_rise(motion);
    EXPECT_EQ(motion.outcome().held, 0);
    if (run.rate < 120) return;
    EXPECT_NEAR(kept, 1, 0.1);
    EXPECT_NEAR(period / due, 1, 0.02);
}

[[maybe_unused]] const bool registered = [] {
    add_runs("Tops", "AsymmetricTopFlipsInTime", runs(), true, asymmetric_top);
    add_runs("Tops", "SymmetricTopPrecesses", runs(), true, symmetric_top);
    add_runs("Tops", "EulersDisk", runs(), true, eulers_disk);
    add_runs("Tops", "RingSwingsOnAKnifeEdge", runs(), true, ring_on_a_knife_edge);
    return true;
}();

} // namespace
} // namespace flotilla::physics
