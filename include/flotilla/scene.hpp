// SPDX-License-Identifier: MIT
// A scene in memory: what a scene file says, after validation. SI units throughout.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <flotilla/settings.hpp>
#include <flotilla/types.hpp>

namespace flotilla {

/// How a shape's mass is given.
enum class MassKind : std::uint8_t {
    none,            ///< only for shapes of static or kinematic bodies
    surface_density, ///< kg/m^2, thin shell
    density,         ///< kg/m^3, closed mesh
    mass,            ///< kg, spread over the surface; over the segments where there is no area, or the points
    line_density,    ///< kg/m, segments alone
};

/// One mesh, shared by all its bodies. Segments and points may be among its triangles, or all there is
/// (segment_element(), point_element()): nets, rods, clouds. They hold other bodies off as any other edge or vertex
/// does; two points, or a point and a segment, never meet but by chance, and may pass each other at less than the rest
/// distance unnoticed. Vertices are in the mesh's own coordinates, already multiplied by `scale`.
struct ShapeDescription {
    std::string name;
    std::string mesh_path; ///< as written in the scene file; empty for an inline mesh
    double scale = 1;
    std::vector<Vec3> vertices;
    std::vector<Triangle> triangles;
    MassKind mass_kind = MassKind::none;
    double mass_value = 0;
    std::optional<Mat3> inertia;        ///< kg m^2 about the centre of mass, mesh axes; overrides the computed one
    std::optional<Vec3> center_of_mass; ///< mesh coordinates; overrides the computed one
};

enum class BodyType : std::uint8_t { dynamic, fixed, kinematic }; ///< "dynamic", "static", "kinematic" in files

struct Keyframe {
    double time = 0; ///< s
    Vec3 position;   ///< of the mesh's origin
    Quat rotation;
};

/// world vertex = rotation * (scale * v) * rotation^-1 + position.
struct BodyDescription {
    std::string name;
    std::int32_t shape = 0; ///< index into SceneDescription::shapes
    BodyType type = BodyType::dynamic;
    Vec3 position;         ///< of the mesh's origin
    Quat rotation;         ///< unit
    Vec3 velocity;         ///< of the centre of mass, m/s
    Vec3 angular_velocity; ///< rad/s, world axes
    double friction = 0.1;
    double restitution = 0.1;
    std::vector<Keyframe> keyframes; ///< kinematic bodies, times strictly increasing
    /// Dynamic bodies: world axes x, y, z along which the centre of mass never moves, and about which the body never
    /// turns. Whatever pushes that way is carried by the world. The velocities at the start have no part there.
    std::array<bool, 3> locked_translation{};
    std::array<bool, 3> locked_rotation{};
    Vec3 force;        ///< N, constant, at the centre of mass of a dynamic body, world axes
    Vec3 torque;       ///< N m, likewise
    std::string group; ///< for SceneDescription::ignored_groups; empty: none
};

/// Two names: of groups, the same one maybe, or of bodies.
struct NamedPair {
    std::string a, b;
    friend bool operator==(const NamedPair&, const NamedPair&) = default;
};

struct SceneDescription {
    Vec3 gravity{0, 0, -9.8}; ///< m/s^2
    Settings settings;
    std::vector<ShapeDescription> shapes;
    std::vector<BodyDescription> bodies;
    /// What may pass through each other, and intersect at the start: bodies of two groups, or of one where both names
    /// are the same; and pairs of bodies. Nothing is promised of them.
    std::vector<NamedPair> ignored_groups, ignored_bodies;
};

} // namespace flotilla
