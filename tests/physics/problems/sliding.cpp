// SPDX-License-Identifier: MIT
#include "physics/problems/sliding.hpp"

#include <cmath>
#include <utility>

namespace flotilla::physics {

double Slope::rate(double friction) const {
    const SinCos s = sin_cos(angle);
    return kGravity * (s.sin - friction * s.cos);
}

SceneDescription on_slope(const Start& start, const Slope& slope, double friction, TriangleMesh mesh,
                          double half_height, double mass) {
    SceneDescription scene = make_scene_with(start.settings);
    const double gap = start.gap(mesh);
    const auto body = add_shape(scene, std::move(mesh), mass), plane = add_shape(scene, make_plate(80, 80));
    add_body(scene, body, BodyType::dynamic, rotate(slope.tilt(), {0, 0, half_height + gap}), friction, 0).rotation =
        slope.tilt();
    add_body(scene, plane, BodyType::fixed, {}, friction, 0).rotation = slope.tilt();
    return scene;
}

SceneDescription block_on_slope(const Start& start, const Slope& slope, double friction) {
    return on_slope(start, slope, friction, make_box(1, 1, 0.4), 0.2);
}

Sliding sliding(const History& history, const Slope& slope, double friction) {
    const Vec3 gained = history.at(1.5, 0).velocity - history.at(0.5, 0).velocity;
    return {dot(gained, slope.down()) / slope.rate(friction),
            std::abs(std::atan2(dot(gained, slope.aside()), dot(gained, slope.down())))};
}

double way_down(const History& history, const Slope& slope) {
    return dot(history.last(0).position - history.first(0).position, slope.down());
}

SceneDescription thrown_block(const Start& start, double heading) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = make_box(1, 1, 0.4);
    const auto block = add_shape(scene, mesh, 5);
    const Vec3 along = rotate(rotation_from_vector({0, 0, heading}), {1, 0, 0});
    add_body(scene, block, BodyType::dynamic, {0, 0, 0.2 + start.gap(mesh)}, kThrownFriction, 0).velocity =
        kThrownSpeed * along;
    add_ground(scene, 40, kThrownFriction, 0);
    return scene;
}

Thrown thrown(const History& history, double heading) {
    const Vec3 along = rotate(rotation_from_vector({0, 0, heading}), {1, 0, 0}), way = history.last(0).position;
    const double due = kThrownSpeed * kThrownSpeed / (2 * kThrownFriction * kGravity);
    return {dot(way, along) / due, std::abs(std::atan2(cross(along, way).z, dot(along, way)))};
}

SceneDescription spinning_block(const Start& start) {
    SceneDescription scene = make_scene_with(start.settings);
    const TriangleMesh mesh = make_box(1, 1, 0.2);
    const auto block = add_shape(scene, mesh, 5);
    auto& body = add_body(scene, block, BodyType::dynamic, {0, 0, 0.1 + start.gap(mesh)}, 0.3, 0);
    body.velocity = {3, 0, 0};
    body.angular_velocity = {0, 0, 8};
    add_ground(scene, 40, 0.3, 0);
    return scene;
}

} // namespace flotilla::physics
