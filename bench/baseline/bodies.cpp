// SPDX-License-Identifier: MIT
#include "bodies.hpp"

#include <algorithm>
#include <cmath>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"

namespace flotilla::baseline {
namespace {

/// Whether the box of `a`, turned into b's axes and boxed again, meets b's box.
bool boxes_meet(const Solid& a, const Mat3& into_b, const Vec3& offset, const Solid& b) {
    const Vec3 middle = into_b * (0.5 * (a.low + a.high)) + offset - 0.5 * (b.low + b.high);
    const Vec3 half_a = 0.5 * (a.high - a.low), half_b = 0.5 * (b.high - b.low);
    const auto apart = [&](int k) {
        const double reach = dot(abs(row(into_b, k)), half_a) + component(half_b, k);
        return std::abs(component(middle, k)) > reach;
    };
    return !apart(0) && !apart(1) && !apart(2);
}

/// Samples of `a` inside `b`; `sign` turns b's normal into that of the pair.
void add_samples_inside(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b, double sign,
                        std::vector<Interference>& out) {
    const Mat3 rotation_a = matrix(pose_a.rotation), rotation_b = matrix(pose_b.rotation);
    const Mat3 into_b = transpose(rotation_b) * rotation_a;
    const Vec3 offset = transpose(rotation_b) * (pose_a.center - pose_b.center);
    if (!boxes_meet(a, into_b, offset, b)) return;
    for (const Vec3& sample : a.samples) {
        const Depth found = depth_at(b, into_b * sample + offset);
        if (found.depth > 0)
            out.push_back({found.depth, rotation_a * sample + pose_a.center, sign * (rotation_b * found.normal)});
    }
}

} // namespace

Bodies make_bodies(const SceneDescription& scene, int samples_across, double thickness) {
    Bodies out;
    out.gravity = scene.gravity;
    for (const ShapeDescription& shape : scene.shapes)
        out.solids.push_back(make_solid(shape, samples_across, thickness));
    for (const BodyDescription& description : scene.bodies) {
        if (description.type == BodyType::kinematic)
            throw InputError("\"" + description.name + "\": kinematic bodies are not part of the baseline");
        Body body;
        body.solid = static_cast<std::size_t>(description.shape);
        body.movable = description.type == BodyType::dynamic;
        body.friction = description.friction;
        body.restitution = description.restitution;
        const Solid& solid = out.solids[body.solid];
        body.pose = {description.position + rotate(description.rotation, solid.center), description.rotation};
        if (body.movable) {
            body.velocity = description.velocity;
            body.angular_velocity = description.angular_velocity;
            set_inverse_mass(solid, body);
        }
        out.all.push_back(body);
    }
    return out;
}

void set_inverse_mass(const Solid& solid, Body& body) {
    const Mat3 r = matrix(body.pose.rotation);
    body.inverse_mass = 1 / solid.mass;
    body.inverse_inertia = r * (solid.inverse_inertia * transpose(r));
}

Pose moved(const Body& body, double dt, const Vec3& extra) {
    return {body.pose.center + dt * (body.velocity + extra),
            normalized(rotation_from_vector(dt * body.angular_velocity) * body.pose.rotation)};
}

void advance(const Solid& solid, Body& body, double dt) {
    const Mat3 before = matrix(body.pose.rotation);
    const Vec3 momentum = before * (solid.inertia * (transpose(before) * body.angular_velocity));
    body.pose = moved(body, dt);
    set_inverse_mass(solid, body);
    body.angular_velocity = body.inverse_inertia * momentum;
}

void find_interferences(const Solid& a, const Pose& pose_a, const Solid& b, const Pose& pose_b,
                        std::vector<Interference>& out) {
    out.clear();
    if (length(pose_a.center - pose_b.center) > a.radius + b.radius) return;
    add_samples_inside(a, pose_a, b, pose_b, 1, out);
    add_samples_inside(b, pose_b, a, pose_a, -1, out);
    std::stable_sort(out.begin(), out.end(), [](const auto& p, const auto& q) { return p.depth > q.depth; });
}

std::vector<PoseRow> rows(const Bodies& bodies) {
    std::vector<PoseRow> out;
    for (const Body& body : bodies.all)
        out.push_back({body.pose.center - rotate(body.pose.rotation, bodies.solids[body.solid].center),
                       body.pose.rotation, body.velocity, body.angular_velocity});
    return out;
}

} // namespace flotilla::baseline
