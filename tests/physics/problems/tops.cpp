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

namespace {

constexpr double kConeRadius = 1.5, kTopTilt = 0.3, kTopSpin = 15; // m, rad, rad/s about its axis
constexpr double kTopInertia = 0.5 * kConeRadius * kConeRadius;    // kg m^2 of 1 kg, of a disc 1 m above the tip

/// rad/s, of the steady precession.
double due_precession() {
    const double about_tip = (0.5 * kTopInertia + 1) * std::cos(kTopTilt), spin = kTopInertia * kTopSpin;
    return (spin - std::sqrt(spin * spin - 4 * about_tip * kGravity)) / (2 * about_tip);
}

constexpr double kBlockWidth = 0.2, kBlockHeight = 0.6, kBlockTilt = 0.3; // m, rad
const double kBlockArm = 0.5 * std::hypot(kBlockWidth, kBlockHeight);     // m, from its edge to its centre

/// Of the centre of the block about its edge: half of the square of its angular velocity at an angle from the vertical.
double block_turn_energy(double angle) {
    const double inertia = (kBlockWidth * kBlockWidth + kBlockHeight * kBlockHeight) / 12 + kBlockArm * kBlockArm;
    return kGravity * kBlockArm * (std::cos(kBlockTilt) - std::cos(angle)) / inertia;
}

/// rad, from the vertical after a time, by the midpoint rule.
double due_block_angle(double time) {
    constexpr int kSteps = 10000;
    const double h = time / kSteps;
    const auto turning = [](double angle) {
        return kGravity * kBlockArm * std::sin(angle) /
               ((kBlockWidth * kBlockWidth + kBlockHeight * kBlockHeight) / 12 + kBlockArm * kBlockArm);
    };
    double angle = kBlockTilt, rate = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double middle = angle + 0.5 * h * rate, rate_then = rate + 0.5 * h * turning(angle);
        angle += h * rate_then;
        rate += h * turning(middle);
    }
    return angle;
}

} // namespace

TriangleMesh make_cone(double radius, int segments) {
    TriangleMesh mesh;
    mesh.vertices.push_back({});
    for (int i = 0; i < segments; ++i) {
        const double angle = 2 * kPi * i / segments;
        mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 1});
        mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % segments});
    }
    return mesh;
}

SceneDescription heavy_top(const Start& start) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = make_cone(kConeRadius, 24);
    const auto top = add_shape(scene, mesh, 1);
    scene.shapes.back().inertia = Mat3{{0.5 * kTopInertia, 0, 0, 0, 0.5 * kTopInertia, 0, 0, 0, kTopInertia}};
    scene.shapes.back().center_of_mass = Vec3{0, 0, 1};
    auto& body = add_body(scene, top, BodyType::dynamic, {0, 0, start.gap(mesh)}, 1, 0);
    body.rotation = rotation_from_vector({0, kTopTilt, 0});
    const Vec3 axis = rotate(body.rotation, {0, 0, 1}), up{0, 0, 1};
    body.angular_velocity = (kTopSpin - due_precession() * std::cos(kTopTilt)) * axis + due_precession() * up;
    body.velocity = cross(body.angular_velocity, axis);
    add_ground(scene, 20, 1, 0);
    return scene;
}

double heavy_top_off(const History& history) {
    const double angle = due_precession() * history.end();
    const Vec3 due{std::sin(kTopTilt) * std::cos(angle), std::sin(kTopTilt) * std::sin(angle), std::cos(kTopTilt)};
    return length(rotate(history.last(0).rotation, {0, 0, 1}) - due);
}

double tip_off(const History& history) {
    const Vec3 way = history.last(0).position - history.first(0).position;
    return std::hypot(way.x, way.y);
}

SceneDescription tipping_block(const Start& start) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = make_box(kBlockWidth, kBlockWidth, kBlockHeight);
    const auto block = add_solid(scene, mesh, 1000);
    const Vec3 center = kBlockArm * Vec3{std::sin(kBlockTilt), 0, std::cos(kBlockTilt)};
    add_body(scene, block, BodyType::dynamic, center + Vec3{0, 0, start.gap(mesh)}, 2, 0).rotation =
        rotation_from_vector({0, kBlockTilt + std::atan2(kBlockWidth, kBlockHeight), 0});
    add_ground(scene, 10, 2, 0);
    return scene;
}

Tipping tipping(const History& history) {
    const BodyState &first = history.first(0), &last = history.last(0);
    const Vec3 stood = first.center_of_mass - kBlockArm * Vec3{std::sin(kBlockTilt), 0, std::cos(kBlockTilt)};
    const double due = due_block_angle(history.end());
    const Vec3 edge = last.center_of_mass + rotate(last.rotation, {0.5 * kBlockWidth, 0, -0.5 * kBlockHeight}) - stood;
    const double angle = std::acos((last.center_of_mass.z - stood.z) / kBlockArm);
    Tipping out;
    out.off = length(last.center_of_mass - stood - kBlockArm * Vec3{std::sin(due), 0, std::cos(due)});
    out.speed = length(last.velocity) / (kBlockArm * std::sqrt(2 * block_turn_energy(angle))) - 1;
    out.edge = std::hypot(edge.x, edge.y);
    return out;
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
