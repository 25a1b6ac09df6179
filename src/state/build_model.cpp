// SPDX-License-Identifier: MIT
#include "state/build_model.hpp"

#include <algorithm>

#include "base/rotation.hpp"
#include "state/rotation_step.hpp"

namespace flotilla {
namespace {

/// Inverse of a symmetric positive definite matrix from its principal form: R diag(1/d) R^T.
Mat3 inverse_of(const MassProperties& m) {
    const Mat3 r = matrix(m.principal_axes);
    const Vec3& d = m.principal_inertia;
    return r * (diagonal({1 / d.x, 1 / d.y, 1 / d.z}) * transpose(r));
}

RigidShape make_shape(const Shape& shape) {
    RigidShape out;
    out.mesh = shape.mesh;
    out.topology = shape.topology;
    out.bvh = shape.bvh;
    out.box = bounding_box(shape.mesh);
    out.center_of_mass = shape.center;
    out.radius = shape.radius;
    if (shape.mass) {
        out.mass = shape.mass->mass;
        out.inertia = shape.mass->inertia;
        out.inverse_inertia = inverse_of(*shape.mass);
    }
    return out;
}

/// The least one of the mesh along the axes of a rotation, m.
double least_extent(const TriangleMesh& mesh, const Quat& axes) {
    Box box;
    for (const Vec3& v : mesh.vertices) {
        const Vec3 x = rotate(conjugate(axes), v);
        box.lower = min(box.lower, x);
        box.upper = max(box.upper, x);
    }
    const Vec3 e = box.upper - box.lower;
    return std::min({e.x, e.y, e.z});
}

/// The size of a body, or ten times its thickness if that is less: the size / 330 at which a bar of aspect 1,000 would rest is three
/// times as far as it is thick. It would stand on forces far beside its long axis, about which it hardly has inertia, and a heap of
/// such bars has dozens of contacts for each where few can be told apart. What has no thickness but that of rounding keeps its size.
double extent_of(const Shape& shape) {
    constexpr double kMostAspect = 10, kRounding = 1e-12;
    const double size = 2 * shape.sphere.radius;
    if (!shape.mass) return size;
    const double thickness =
        std::min(least_extent(shape.mesh, {}), least_extent(shape.mesh, shape.mass->principal_axes));
    return thickness > kRounding * size ? std::min(size, kMostAspect * thickness) : size;
}

Body make_body(const Scene& scene, const BodyDescription& description) {
    const Shape& shape = scene.shapes[static_cast<std::size_t>(description.shape)];
    Body body;
    body.shape = description.shape;
    body.type = description.type;
    if (body.movable()) {
        body.mass = shape.mass->mass;
        body.inverse_mass = 1 / body.mass;
    }
    body.friction = description.friction;
    body.restitution = description.restitution;
    body.size = 2 * shape.sphere.radius;
    body.extent = extent_of(shape);
    body.keyframes = description.keyframes;
    return body;
}

} // namespace

Model make_model(const Scene& scene) {
    Model model;
    model.gravity = scene.gravity;
    model.settings = scene.settings;
    for (const Shape& shape : scene.shapes) model.shapes.push_back(make_shape(shape));
    for (const BodyDescription& body : scene.bodies) model.bodies.push_back(make_body(scene, body));
    return model;
}

State initial_state(const Scene& scene, const Model& model) {
    State state;
    state.sleep.resize(scene.bodies.size());
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyDescription& body = scene.bodies[i];
        const RigidShape& shape = model.shape_of(i);
        state.pose.push_back(pose_at_origin(shape, body.position, body.rotation));
        if (model.bodies[i].movable())
            state.motion.push_back({body.velocity, turned(shape.inertia, body.rotation) * body.angular_velocity});
        else
            state.motion.push_back({});
        state.script_delay.push_back(0);
        state.lift.push_back(0);
    }
    return state;
}

} // namespace flotilla
