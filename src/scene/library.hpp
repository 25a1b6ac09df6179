// SPDX-License-Identifier: MIT
// Parts that the scenes of the library share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>

#include "mesh/topology.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla::library {

/// What distinguishes random numbers of one scene from those of another with the same seed.
enum class Purpose : std::uint64_t { orientation = 1, jitter = 2 };

/// A rotation, uniform over all of them.
[[nodiscard]] Quat random_rotation(std::uint64_t seed, std::size_t id);
/// A vector, uniform in the ball of `radius`.
[[nodiscard]] Vec3 random_in_ball(std::uint64_t seed, std::size_t id, double radius);

/// Places for `count` spheres of `radius` in a vertical cylinder: a hexagonal close packing with some air, jittered, so
/// that no two spheres touch whatever the seed. Centres lie within `column_radius` of the z axis, from `bottom` up, the
/// lowest layer first. At least one column is used, however narrow the cylinder.
[[nodiscard]] std::vector<Vec3> packed_column(std::size_t count, double radius, double column_radius, double bottom,
                                              std::uint64_t seed);

/// A shape without mass; give it one where it moves.
[[nodiscard]] ShapeDescription shape_of(std::string name, TriangleMesh mesh);
[[nodiscard]] BodyDescription body_of(std::string name, std::int32_t shape, BodyType type, const Vec3& position);

/// A boat hull of 3 m, open, zero thickness, with a transom and two thwarts; bow along +x, keel down.
[[nodiscard]] TriangleMesh boat_mesh();
/// The part of a sphere within `angle` radians of its lowest point, which is at the origin. Open, facing inwards.
[[nodiscard]] TriangleMesh bowl_mesh(double radius, double angle, int rings, int segments);

[[nodiscard]] SceneDescription boats_in_bowl(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription boats_in_bowls(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription household(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription rocks(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription wires(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription triangles_on_pegs(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription stack(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription falling_boats(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription fast_plate(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription closing_walls(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription boats_and_ball(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription catapult(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription sliding_boxes(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription turning_strip(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription particle_and_block(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription ball_on_ground(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription stack_and_ball(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription hanging_rings(int bodies, std::uint64_t seed);
[[nodiscard]] SceneDescription pinched_block(int bodies, std::uint64_t seed);

} // namespace flotilla::library
