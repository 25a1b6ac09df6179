// SPDX-License-Identifier: MIT
#include "state/build_model.hpp"

#include <algorithm>
#include <array>

#include "mesh/convexity.hpp"

namespace flotilla {
namespace {

/// In the mesh's own axes where those are principal ones, so that what is symmetric stays so to the bit. The inverse of
/// a line: MassProperties::line.
PrincipalInertia principal_of(const MassProperties& m) {
    const std::array<double, 9>& t = m.inertia.m;
    const bool diagonal = t[1] == 0 && t[2] == 0 && t[5] == 0 && m.line == Vec3{};
    const Vec3 d = diagonal ? Vec3{t[0], t[4], t[8]} : m.principal_inertia;
    const double least = m.line == Vec3{} ? 0 : d.z;
    return {diagonal ? Quat{} : m.principal_axes,
            d,
            {1 / std::max(d.x, least), 1 / std::max(d.y, least), 1 / std::max(d.z, least)}};
}

} // namespace

RigidShape make_shape(const Shape& shape) {
    RigidShape out;
    out.mesh = shape.mesh;
    out.topology = shape.topology;
    out.bvh = shape.bvh;
    out.box = bounding_box(shape.mesh);
    out.outline = support_points(shape.mesh.vertices);
    out.convex = is_convex(shape.mesh);
    out.center_of_mass = shape.center;
    out.size = 2 * shape.sphere.radius;
    out.extent = shape.extent;
    out.longest_edge = shape.longest_edge;
    out.radius = shape.radius;
    if (shape.mass) {
        out.mass = shape.mass->mass;
        out.inertia = shape.mass->inertia;
        out.principal = principal_of(*shape.mass);
        out.line = shape.mass->line;
    }
    return out;
}

AxisMask mask(const std::array<bool, 3>& axes) {
    return static_cast<AxisMask>((axes[0] ? 1 : 0) | (axes[1] ? 2 : 0) | (axes[2] ? 4 : 0));
}

Body make_body(const Model& model, const BodyDescription& description) {
    const RigidShape& shape = model.shapes[static_cast<std::size_t>(description.shape)];
    Body body;
    body.shape = description.shape;
    body.type = description.type;
    if (body.movable()) {
        body.mass = shape.mass;
        body.inverse_mass = 1 / body.mass;
    }
    body.friction = description.friction;
    body.restitution = description.restitution;
    body.size = shape.size;
    body.extent = shape.extent;
    body.keyframes = description.keyframes;
    body.locked = {mask(description.locked_translation), mask(description.locked_rotation)};
    body.first_rotation = description.rotation;
    body.force = description.force;
    body.torque = description.torque;
    return body;
}

Body absent_body(const Model& model, std::int32_t shape) {
    Body body;
    body.shape = shape;
    body.type = BodyType::fixed;
    body.present = false;
    body.size = model.shapes[static_cast<std::size_t>(shape)].size;
    body.extent = model.shapes[static_cast<std::size_t>(shape)].extent;
    return body;
}

Model make_model(const Scene& scene) {
    Model model;
    model.gravity = scene.gravity;
    model.settings = scene.settings;
    for (const Shape& shape : scene.shapes) model.shapes.push_back(make_shape(shape));
    for (const BodyDescription& body : scene.bodies) model.bodies.push_back(make_body(model, body));
    model.filter = scene.filtered.filter;
    for (std::size_t i = 0; i < model.size(); ++i) model.bodies[i].group = scene.filtered.group[i];
    model.list_active();
    return model;
}

Motion make_motion(const Model& model, std::size_t body, const Quat& rotation, const Vec3& velocity,
                   const Vec3& angular_velocity) {
    if (!model.bodies[body].dynamic()) return {};
    return {velocity, free_part(model.bodies[body].locked.rotation,
                                angular_momentum(turned(model.shape_of(body).principal, rotation), angular_velocity))};
}

State initial_state(const Scene& scene, const Model& model) {
    State state;
    state.sleep.resize(scene.bodies.size());
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        const RigidShape& shape = model.shape_of(i);
        state.pose.push_back(pose_at_origin(shape, body.position, body.rotation));
        state.motion.push_back(make_motion(model, i, body.rotation, body.velocity, body.angular_velocity));
        state.script_clock.emplace_back();
        state.lift.push_back(0);
    }
    return state;
}

} // namespace flotilla
