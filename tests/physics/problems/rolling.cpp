// SPDX-License-Identifier: MIT
#include "physics/problems/rolling.hpp"

#include <cmath>

namespace flotilla::physics {
namespace {

Vec3 down(double slope) { return rotate(rotation_from_vector({0, slope, 0}), {1, 0, 0}); }

} // namespace

SceneDescription rolling_scene(const Start& start, const Roller& roller, const Release& release) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = roller.mesh();
    const auto shape = roller.solid ? add_solid(scene, mesh, 100) : add_shape(scene, mesh, 50);
    const auto plane = add_shape(scene, make_plate(60, 10));
    const Quat tilt = rotation_from_vector({0, release.slope, 0});
    const Quat axis = roller.round ? Quat{} : rotation_from_vector({kPi / 2, 0, 0});
    auto& body = add_body(scene, shape, BodyType::dynamic, rotate(tilt, {0, 0, kRollerRadius + start.gap(mesh)}),
                          release.friction, 0);
    body.rotation = tilt * axis;
    body.velocity = rotate(tilt, {release.speed, 0, 0});
    body.angular_velocity = rotate(tilt, {0, release.spin, 0});
    add_body(scene, plane, BodyType::fixed, {}, release.friction, 0).rotation = tilt;
    return scene;
}

double kept_by_facets(const Roller& roller, double angle) {
    return std::exp(-kPi * angle / roller.sides / (1 + roller.inertia));
}

double sides_of_prism(int sides, double spin) {
    const double r = kRollerRadius, half = kPi / sides;
    const double inertia = 0.5 * r * r * (1 - 2.0 / 3 * std::sin(half) * std::sin(half)), of_corner = inertia + r * r;
    const double to_pass = std::sqrt(2 * kGravity * r * (1 - std::cos(half)) / of_corner); // rad/s, on a side
    const double kept = (inertia + r * r * std::cos(2 * half)) / of_corner;
    double rolled = 0.5;
    for (spin = kept * std::hypot(spin, to_pass); spin > to_pass; spin *= kept) ++rolled;
    return rolled;
}

double rolled_share(const History& history, const Roller& roller, double slope) {
    const double due = kGravity * std::sin(slope) / (1 + roller.inertia) * history.end();
    return dot(history.last(0).velocity, down(slope)) / due;
}

SlideToRoll due_to_roll(const Roller& roller) {
    return {kRollingSpeed * roller.inertia / ((1 + roller.inertia) * kRollingFriction * kGravity),
            kRollingSpeed / (1 + roller.inertia)};
}

SlideToRoll slide_to_roll(const History& history) {
    for (std::size_t k = 1; k < history.instants().size(); ++k) {
        const Instant& i = history.instants()[k];
        const BodyState& s = i.bodies[0];
        if (s.velocity.x - kRollerRadius * s.angular_velocity.y < 1e-3 * kRollingSpeed) return {i.time, s.velocity.x};
    }
    return {};
}

double least_rolling_friction(const Roller& roller, double slope) {
    return roller.inertia / (1 + roller.inertia) * std::tan(slope);
}

double slip(const History& history, double slope) {
    const BodyState& s = history.last(0);
    return 1 - kRollerRadius * s.angular_velocity.y / dot(s.velocity, down(slope));
}

double due_slip(const Roller& roller, double slope, double share) {
    // What is missing of the friction turns it less: spin / speed = share (1 - least / tan) / (1 - share least / tan).
    const double part = least_rolling_friction(roller, slope) / std::tan(slope);
    return share >= 1 ? 0 : 1 - share * (1 - part) / (1 - share * part);
}

} // namespace flotilla::physics
