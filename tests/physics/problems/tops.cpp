// SPDX-License-Identifier: MIT
#include "physics/problems/tops.hpp"

#include <cmath>

namespace flotilla::physics {
namespace {

constexpr double kDiskRadius = 0.5, kDiskTilt = 0.3;
constexpr double kRing = 0.5, kTube = 0.05, kAmplitude = 0.2, kArm = kRing - kTube;

SceneDescription top_with(const Start& start, const Vec3& inertia, const Vec3& spin) {
    SceneDescription scene = make_scene_with(start.settings, {});
    const auto top = add_shape(scene, make_box(1, 1, 1), 6);
    scene.shapes.back().inertia = Mat3{{inertia.x, 0, 0, 0, inertia.y, 0, 0, 0, inertia.z}};
    add_body(scene, top, BodyType::dynamic, {}).angular_velocity = spin;
    return scene;
}

} // namespace

SceneDescription asymmetric_top(const Start& start) { return top_with(start, {1, 2, 3}, {0.01, 1, 0.01}); }

double flip_period(const History& history) {
    Crossings flips(1);
    for (std::size_t k = 1; k < history.instants().size(); ++k) {
        const BodyState& s = history.instants()[k].bodies[0];
        flips.add(history.instants()[k].time, rotate(conjugate(s.rotation), s.angular_velocity).y, history.dt());
    }
    return flips.count() > 2 ? flips.time(2) - flips.time(0) : 0;
}

SceneDescription symmetric_top(const Start& start) { return top_with(start, {1, 1, 1.5}, {0.3, 0, 1}); }

double axis_off(const History& history) {
    const Vec3 turn = history.end() * length(kTopMomentum) * normalized(kTopMomentum);
    return length(rotate(history.last(0).rotation, {0, 0, 1}) - rotate(rotation_from_vector(turn), {0, 0, 1}));
}

SceneDescription eulers_disk(const Start& start) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = make_disc(kDiskRadius, 512);
    const auto disc = add_shape(scene, mesh, 1);
    const double precession = std::sqrt(4 * kGravity / (kDiskRadius * std::sin(kDiskTilt)));
    auto& body =
        add_body(scene, disc, BodyType::dynamic, {0, 0, kDiskRadius * std::sin(kDiskTilt) + start.gap(mesh)}, 1, 0);
    body.rotation = rotation_from_vector({0, kDiskTilt, 0});
    body.angular_velocity = -precession * std::sin(kDiskTilt) * rotate(body.rotation, {1, 0, 0});
    add_ground(scene, 20, 1, 0);
    return scene;
}

Disk disk(const History& history) {
    Disk out;
    double azimuth = 0, turned = 0, tilts = 0;
    int window = 0;
    const int steps = std::max(2, static_cast<int>(std::lround(1 / (12 * history.dt()))));
    for (std::size_t k = 1; k < history.instants().size(); ++k) {
        const Vec3 n = rotate(history.instants()[k].bodies[0].rotation, {0, 0, 1});
        const double now = std::atan2(n.y, n.x), tilt_now = std::acos(std::min(1.0, std::abs(n.z)));
        turned += std::remainder(now - azimuth, 2 * kPi);
        azimuth = now;
        tilts += tilt_now;
        out.sine = std::sin(tilt_now) / std::sin(kDiskTilt);
        if (++window < steps) continue;
        const double tilt = tilts / window, rate = turned / (window * history.dt());
        if (tilt > 0.1)
            out.worst = std::max(out.worst, std::abs(rate * rate * std::sin(tilt) * kDiskRadius / (4 * kGravity) - 1));
        window = 0, turned = 0, tilts = 0;
    }
    return out;
}

SceneDescription ring_on_knife_edge(const Start& start) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = make_ring(kRing, kTube, 32, 12);
    const auto ring = add_solid(scene, mesh, 1000), blade = add_shape(scene, make_plate(0.2, 0.6));
    const Quat upright = rotation_from_vector({kPi / 2, 0, 0}), swing = rotation_from_vector({0, kAmplitude, 0});
    add_body(scene, ring, BodyType::dynamic, rotate(swing, {0, 0, -kArm}) + Vec3{0, 0, start.gap(mesh)}, 1, 0)
        .rotation = swing * upright;
    add_body(scene, blade, BodyType::fixed, {0, 0, -0.1}, 1, 0).rotation = rotation_from_vector({0, kPi / 2, 0});
    return scene;
}

double due_ring_period() {
    const double inertia = kRing * kRing + 0.75 * kTube * kTube; // over m, about its axis
    return 2 * kPi * std::sqrt((inertia + kArm * kArm) / (kGravity * kArm)) * (1 + kAmplitude * kAmplitude / 16);
}

Swing swing(const History& history) {
    Swing out;
    Crossings middle(-1);
    double peak = 0, last_peak = 0;
    for (std::size_t k = 1; k < history.instants().size(); ++k) {
        const Vec3 at = history.instants()[k].bodies[0].center_of_mass;
        const double angle = std::atan2(at.x, -at.z);
        if (middle.add(history.instants()[k].time, angle, history.dt())) last_peak = peak, peak = 0;
        peak = std::max(peak, std::abs(angle));
    }
    return {last_peak / kAmplitude, middle.period()};
}

SceneDescription chain_of(const Settings& settings, int links, const TriangleMesh& link, double pitch, bool hangs) {
    SceneDescription scene = make_scene_with(settings);
    const auto fixed = add_shape(scene, link), free = add_solid(scene, link, kSteel);
    const Quat along = hangs ? rotation_from_vector({0, kPi / 2, 0}) : Quat{}; // x to -z
    for (int i = 0; i < links; ++i)
        add_body(scene, i == 0 ? fixed : free, i == 0 ? BodyType::fixed : BodyType::dynamic,
                 rotate(along, {i * pitch, 0, 0}), 0, 0)
            .rotation = along * rotation_from_vector({i % 2 * kPi / 2, 0, 0});
    return scene;
}

HangingChain::HangingChain(int links) : links_(links), link_(make_ring(0.28, 0.02, 32, 8)) {
    gap_ = rest_gap(link_);
    pitch_ = 2 * (0.28 - 0.02) - 1.0 * gap_;
    length_ = (links + 0.25) * pitch_;
    shape_.push_back(0);
    for (int i = 1; i <= links; ++i) {
        const double s = std::max(0.0, 1 - i * pitch_ / length_);
        shape_.push_back(std::cyl_bessel_j(0.0, 2.404825557695773 * std::sqrt(s)));
    }
}

SceneDescription HangingChain::scene(const Start& start) const {
    SceneDescription scene = chain_of(start.settings, links_ + 1, link_, pitch_, true);
    // Swings across the x axis; each centre follows its neighbour at the pitch, turned along the tangent between them.
    constexpr double kSwing = 0.02; // of the length
    Vec3 at;
    for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
        const double aside = kSwing * length_ * shape_[i] - at.x;
        at += Vec3{aside, 0, -std::sqrt(pitch_ * pitch_ - aside * aside)};
        scene.bodies[i].position = at;
        scene.bodies[i].rotation = rotation_from_vector({0, -std::asin(aside / pitch_), 0}) * scene.bodies[i].rotation;
    }
    for (BodyDescription& b : scene.bodies) b.friction = 1; // no slipping along the sides of a hole
    return scene;
}

double HangingChain::frequency() const { return 1.2024 * std::sqrt(kGravity / length_); }

HangingChain::Found HangingChain::found(const History& history) const {
    Crossings middle(1);
    for (std::size_t k = 1; k < history.instants().size(); ++k) {
        double part = 0;
        const Instant& now = history.instants()[k];
        for (std::size_t i = 1; i < shape_.size(); ++i) part += shape_[i] * now.bodies[i].center_of_mass.x;
        middle.add(now.time, part, history.dt());
    }
    return {middle.count() > 1 ? 2 * kPi / middle.period() : 0, middle.count()};
}

} // namespace flotilla::physics
