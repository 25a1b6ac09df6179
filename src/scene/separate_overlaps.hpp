// SPDX-License-Identifier: MIT
// Repairs a start in which bodies intersect, by moving some of them, without turning, as little as frees them.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.hpp"

namespace flotilla {

/// One body that was moved.
struct InitialMove {
    std::int32_t body = 0;
    Vec3 by; ///< m
};

struct SeparatedStart {
    std::vector<InitialMove> moves;      ///< in the order in which they were made; each body at most once
    std::vector<std::int32_t> not_freed; ///< bodies that no move frees of at most their own size and that of those
                                         ///< caught with them; the start is refused then
};

/// Moves bodies of `scene` until no movable body intersects another. The body whose move is the shortest goes first,
/// and goes to where it is clear of every other body by their rest distance, so that nothing that was free gets caught.
/// The shortest move is searched in a fixed set of directions, among them the normals of the triangles that intersect,
/// and then around the best. A body that intersects several others is freed from all of them at once, and on the side
/// of static and scripted surfaces on which its centre is, where it can be. Only positions change; a pure function of
/// the scene.
[[nodiscard]] SeparatedStart separate_overlaps(Scene& scene);

} // namespace flotilla
