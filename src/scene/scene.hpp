// SPDX-License-Identifier: MIT
// A validated scene with everything derived from its meshes: what the solver starts from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>

#include "mesh/bvh.hpp"
#include "mesh/mass_properties.hpp"
#include "mesh/topology.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// The default rest distance of a pair is the smaller bounding-sphere diameter of its movable bodies divided by this: 1 cm
/// for the paper's boat of 3.3 m.
inline constexpr double kSizePerRestDistance = 330;

/// One surface, shared by all bodies that have it. Everything is in mesh coordinates, metres.
struct Shape {
    std::string name;
    TriangleMesh mesh; ///< scaled; world vertex = q v q^-1 + p with the body's pose
    Topology topology;
    Bvh bvh;
    std::optional<MassProperties> mass; ///< empty only for shapes of static and kinematic bodies
    BoundingSphere sphere;              ///< its diameter is the size of the body
    double extent = 0;                  ///< m, which the lengths of its pairs go by: the size, less for thin solids
    Vec3 center;                        ///< of mass, or of `sphere` where there is no mass: what a body turns about
    double radius = 0;                  ///< m, of the sphere around `center`: |angle| * radius bounds what a turn moves
};

struct Scene {
    Vec3 gravity;
    Settings settings;
    std::vector<Shape> shapes;
    std::vector<BodyDescription>
        bodies; ///< rotations of unit length; a kinematic body has the pose of its first keyframe
    std::vector<std::string> warnings; ///< what is legal but probably not meant, one line each
};

/// The world position of what `body` turns about.
[[nodiscard]] Vec3 world_center(const Scene& scene, const BodyDescription& body);

/// Mass, centre of mass and inertia as the description asks; empty where it gives no mass. Throws InputError.
[[nodiscard]] std::optional<MassProperties> shape_mass_properties(const ShapeDescription& shape);

/// Checks `description` and derives the rest. Shapes that describe the same surface and mass bit for bit become one. Throws
/// InputError with every problem, one line each, starting with `source`.
[[nodiscard]] Scene build_scene(SceneDescription description, const std::string& source = "scene");

} // namespace flotilla
