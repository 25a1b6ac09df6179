// SPDX-License-Identifier: MIT
// A validated scene with everything derived from its meshes: what the solver starts from.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <flotilla/scene.hpp>

#include "mesh/bvh.hpp"
#include "mesh/mass_properties.hpp"
#include "mesh/topology.hpp"
#include "mesh/triangle_mesh.hpp"
#include "scene/pair_lengths.hpp"

namespace flotilla {

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
    double longest_edge = 0;            ///< m, of a triangle
};

/// Pairs of bodies that may pass through each other. Each list is sorted, the first of a pair is not above the second.
struct PairFilter {
    std::vector<std::pair<std::int32_t, std::int32_t>> groups, bodies;

    [[nodiscard]] bool empty() const { return groups.empty() && bodies.empty(); }
    friend bool operator==(const PairFilter&, const PairFilter&) = default;
    /// Of two bodies and their groups, -1 where they have none.
    [[nodiscard]] bool ignores(std::int32_t a, std::int32_t group_a, std::int32_t b, std::int32_t group_b) const;
};

/// A filter with the groups of the bodies, by number.
struct FilteredBodies {
    PairFilter filter;
    std::vector<std::int32_t> group; ///< by body; -1: none
    [[nodiscard]] bool ignores(std::size_t a, std::size_t b) const {
        return !filter.empty() &&
               filter.ignores(static_cast<std::int32_t>(a), group[a], static_cast<std::int32_t>(b), group[b]);
    }
};
/// By the names of groups and bodies; pairs with a name that no body has are left out.
[[nodiscard]] FilteredBodies make_filter(std::span<const BodyDescription> bodies,
                                         std::span<const NamedPair> ignored_groups,
                                         std::span<const NamedPair> ignored_bodies);

struct Scene {
    Vec3 gravity;
    Settings settings;
    std::vector<Shape> shapes;
    std::vector<BodyDescription>
        bodies; ///< rotations of unit length; a kinematic body has the pose of its first keyframe
    std::vector<std::int32_t> shape_of; ///< by shape of the description: in `shapes`
    FilteredBodies filtered;
    std::vector<std::string> warnings; ///< what is legal but probably not meant, one line each
};

/// The world position of what `body` turns about.
[[nodiscard]] Vec3 world_center(const Scene& scene, const BodyDescription& body);

/// Mass, centre of mass and inertia as the description asks; empty where it gives no mass. Throws InputError.
[[nodiscard]] std::optional<MassProperties> shape_mass_properties(const ShapeDescription& shape);

/// Checks `description` and derives the rest. Shapes that describe the same surface and mass bit for bit become one.
/// Throws InputError with every problem, one line each, starting with `source`.
[[nodiscard]] Scene build_scene(SceneDescription description, const std::string& source = "scene");

} // namespace flotilla
