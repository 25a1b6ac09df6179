// SPDX-License-Identifier: MIT
// Parts of scenes that are built in code. SI units.
#pragma once

#include <string>

#include <flotilla/scene.hpp>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::scenario {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kGravity = 9.8; ///< m/s^2, the default of scenes
inline constexpr double kRoundOff = 0x1p-53;

/// A scene with sleeping off, so that rest and creep are the solver's own doing.
inline SceneDescription empty_scene(const Settings& settings = {}) {
    SceneDescription scene;
    scene.settings = settings;
    scene.settings.sleeping = false;
    return scene;
}

/// A shape of `mass` kg spread over its surface; 0: for static and scripted bodies.
inline std::int32_t add_shape(SceneDescription& scene, TriangleMesh mesh, double mass = 0) {
    ShapeDescription shape;
    shape.name = "shape" + std::to_string(scene.shapes.size());
    shape.vertices = std::move(mesh.vertices);
    shape.triangles = std::move(mesh.triangles);
    if (mass > 0) shape.mass_kind = MassKind::mass, shape.mass_value = mass;
    scene.shapes.push_back(std::move(shape));
    return static_cast<std::int32_t>(scene.shapes.size()) - 1;
}

inline BodyDescription& add_body(SceneDescription& scene, std::int32_t shape, BodyType type, const Vec3& position,
                                 double friction = 0.1, double restitution = 0.1) {
    BodyDescription body;
    body.name = "body" + std::to_string(scene.bodies.size());
    body.shape = shape;
    body.type = type;
    body.position = position;
    body.friction = friction;
    body.restitution = restitution;
    scene.bodies.push_back(std::move(body));
    return scene.bodies.back();
}

/// A body with corners on the axes at distance r: it stands on a single point straight below its centre of mass.
inline TriangleMesh make_octahedron(double r) {
    return {{{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

} // namespace flotilla::scenario
