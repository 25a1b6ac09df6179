// SPDX-License-Identifier: MIT
// What a World answers about its bodies where they are. To rounding, where nothing else is said.
#pragma once

#include <cstdint>
#include <vector>

#include <flotilla/edit.hpp>
#include <flotilla/report.hpp>

namespace flotilla {

struct RayHit {
    BodyId body;
    std::int32_t triangle = -1; ///< of its shape
    double distance = 0;        ///< m, from the ray's origin
    Vec3 point;                 ///< m
    Vec3 normal;                ///< unit, of the triangle, against the ray
};

struct ClosestPoints {
    double distance = 0;                           ///< m
    Vec3 point_a, point_b;                         ///< m, one of the nearest pairs
    std::int32_t triangle_a = -1, triangle_b = -1; ///< they are on
};

/// What touches a body, by the last step.
struct BodyContacts {
    std::vector<ContactState> contacts; ///< those that the body is part of, as World::contacts() has them
    Vec3 force;                         ///< N, of all of them on the body
    Vec3 torque;                        ///< N m, about its centre of mass
};

struct MemoryUse {
    std::size_t shapes = 0;   ///< bytes, meshes and their hierarchies
    std::size_t bodies = 0;   ///< world vertices and boxes, at both ends of a step; sleeping bodies have
                              ///< them only where somebody asks
    std::size_t contacts = 0; ///< and the impulses kept for the next step
    std::size_t pairs = 0;    ///< what is known of pairs
    [[nodiscard]] std::size_t total() const { return shapes + bodies + contacts + pairs; }
};

} // namespace flotilla
