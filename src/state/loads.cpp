// SPDX-License-Identifier: MIT
#include "state/loads.hpp"

#include <algorithm>
#include <cmath>

#include "state/locked_rotation.hpp"

namespace flotilla {
namespace {

/// m/s^2, of the points farthest from the centre of mass: at most what the torque would do about the axis of least
/// inertia.
double most_of_torque(const Model& model, std::size_t i) {
    const Vec3 torque = turning_torque(model, i);
    if (torque == Vec3{}) return 0;
    const RigidShape& shape = model.shape_of(i);
    const Vec3& inverse = shape.principal.inverse;
    return std::max({inverse.x, inverse.y, inverse.z}) * length(torque) * shape.radius;
}

/// J, by which the energy of a body turning freely under its torque grows in the step beyond torque . turn.
double free_excess(const Model& model, std::size_t i, const Quat& rotation, const Vec3& momentum) {
    const double dt = model.settings.time_step;
    const AxisMask locked = model.bodies[i].locked.rotation;
    const Vec3 torque = turning_torque(model, i), mean = momentum + (0.5 * dt) * torque;
    const WorldInertia start = world_inertia(model.shape_of(i), locked, rotation);
    const RotationStep step = rotate_free(start, locked, mean, dt);
    const Mat3 end = world_inertia(model.shape_of(i), locked, normalized(step.rotation * rotation)).inverse;
    // E = L J L / 2 with L = mean -+ torque dt / 2 at both ends, and mean J mean the same there.
    const double gain = (0.5 * dt) * dot(torque, start.inverse * mean + end * mean) +
                        (0.125 * dt * dt) * (dot(torque, end * torque) - dot(torque, start.inverse * torque));
    return gain - dot(torque, step.vector);
}

} // namespace

Vec3 acceleration(const Model& model, std::size_t i) {
    const Body& body = model.bodies[i];
    if (!body.force_acts() && body.locked.translation == 0) return model.gravity;
    return free_part(body.locked.translation, model.gravity + body.inverse_mass * body.force);
}

Vec3 turning_torque(const Model& model, std::size_t i) {
    return free_part(model.bodies[i].locked.rotation, model.bodies[i].torque);
}

double most_acceleration(const Model& model, std::size_t i) {
    const Body& body = model.bodies[i];
    if (!body.driven()) return length(model.gravity);
    return std::max(length(model.gravity), length(acceleration(model, i)) + most_of_torque(model, i));
}

double most_acceleration(const Model& model, std::int32_t a, std::int32_t b) {
    return std::max(most_acceleration(model, static_cast<std::size_t>(a)),
                    most_acceleration(model, static_cast<std::size_t>(b)));
}

double least_acceleration(const Model& model, std::size_t i) {
    const Body& body = model.bodies[i];
    double least = length(model.gravity);
    if (!body.driven() && !body.locked.any()) return least;
    const AxisMask locked = body.locked.translation;
    for (const double own : {length(free_part(locked, model.gravity)),
                             body.inverse_mass * length(free_part(locked, body.force)), most_of_torque(model, i)})
        if (own > 0) least = std::min(least, own);
    return least;
}

double work_of_loads(const Model& model, std::size_t i, const Quat& rotation, const Motion& motion, const Vec3& way,
                     const Vec3& turn) {
    const Vec3 torque = turning_torque(model, i);
    const double of_force = dot(model.bodies[i].force, way);
    if (torque == Vec3{}) return of_force;
    return of_force + dot(torque, turn) + std::max(0.0, free_excess(model, i, rotation, motion.momentum));
}

} // namespace flotilla
