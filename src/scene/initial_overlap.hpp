// SPDX-License-Identifier: MIT
// Which bodies intersect where they start? Exact on the doubles that the first step uses. Continuous collision
// detection cannot see an intersection that is there from the beginning, so this is asked once, before the first step.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace flotilla {

struct BodyOverlap {
    std::int32_t a = 0, b = 0;                          ///< bodies, a < b
    std::vector<std::array<std::int32_t, 2>> triangles; ///< intersecting pairs: triangle of a, triangle of b; sorted
    Vec3 place; ///< m, world: the middle of where the bounds of the first pair meet
};

struct InitialOverlaps {
    std::vector<BodyOverlap> movable; ///< at least one body can move: the scene cannot start; sorted by (a, b)
    std::vector<BodyOverlap> fixed;   ///< both are static or scripted: allowed, worth a warning; sorted by (a, b)
};

/// Two triangles overlap where they have a common point, touching included, or come nearer than 16 times the rounding
/// bound of continuous collision detection, below which no motion could be certified.
[[nodiscard]] InitialOverlaps find_initial_overlaps(const Scene& scene);

/// m: the least gap of two triangles within these boxes that a motion can be certified from (`ccd_floor` of their joint
/// extent).
[[nodiscard]] double least_certified_distance(const Box& a, const Box& b);
/// Whether two triangles intersect, touch, or are nearer than that.
[[nodiscard]] bool triangles_overlap(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// The vertices of a body in the world, as the first step sees them.
[[nodiscard]] std::vector<Vec3> initial_vertices(const Scene& scene, std::size_t body);

} // namespace flotilla
