// SPDX-License-Identifier: MIT
// What scenario tests share: scenes built in code, and a look at every frame that shares nothing with the solver's own
// checks but the exact predicates. SI units.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

#include "base/vec3.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "mesh/placement.hpp"
#include "mesh/primitives.hpp"
#include "step/scene_parts.hpp"

namespace flotilla::scenario {

/// Every body's triangles at the present poses, from the one function that places vertices.
inline std::vector<std::vector<std::array<Vec3, 3>>> placed_triangles(const SceneDescription& scene,
                                                                      const World& world) {
    std::vector<std::vector<std::array<Vec3, 3>>> out(world.size());
    for (std::size_t i = 0; i < world.size(); ++i) {
        const ShapeDescription& shape = scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)];
        const BodyState state = world.body(i);
        std::vector<Vec3> x(shape.vertices.size());
        world_vertices(shape.vertices, state.position, state.rotation, x);
        const auto at = [&](std::int32_t v) { return x[static_cast<std::size_t>(v)]; };
        for (const Triangle& t : shape.triangles) out[i].push_back({at(t[0]), at(t[1]), at(t[2])});
    }
    return out;
}

struct Bounds {
    Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

    void add(const std::array<Vec3, 3>& t) {
        for (const Vec3& p : t) low = min(low, p), high = max(high, p);
    }
    [[nodiscard]] bool meets(const Bounds& b) const {
        return !(high.x < b.low.x || b.high.x < low.x || high.y < b.low.y || b.high.y < low.y || high.z < b.low.z ||
                 b.high.z < low.z);
    }
};

inline Bounds bounds_of(const std::array<Vec3, 3>& t) {
    Bounds b;
    b.add(t);
    return b;
}

/// Pairs of triangles of two bodies that intersect, by brute force over overlapping boxes. Exact. Pairs of two bodies
/// without finite mass do not count (G1).
inline std::int64_t count_intersections(const SceneDescription& scene, const World& world) {
    const auto triangles = placed_triangles(scene, world);
    std::vector<Bounds> bounds(world.size());
    for (std::size_t i = 0; i < world.size(); ++i)
        for (const auto& t : triangles[i]) bounds[i].add(t);
    std::int64_t count = 0;
    for (std::size_t i = 0; i < world.size(); ++i)
        for (std::size_t j = i + 1; j < world.size(); ++j) {
            if (scene.bodies[i].type != BodyType::dynamic && scene.bodies[j].type != BodyType::dynamic) continue;
            if (!bounds[i].meets(bounds[j])) continue;
            for (const auto& a : triangles[i])
                if (bounds_of(a).meets(bounds[j]))
                    for (const auto& b : triangles[j]) count += exact::triangles_intersect(a, b) ? 1 : 0;
        }
    return count;
}

/// Sums and extremes of the reports of a run.
struct RunTotals {
    std::int64_t collisions = 0, contacts = 0, merges = 0, rung_changes = 0, held = 0, failsafe_steps = 0;
    std::uint32_t warnings = 0;

    void add(const StepReport& r) {
        collisions += r.collisions;
        contacts += r.contacts;
        merges += r.merges;
        rung_changes += r.rung_changes;
        held += r.held;
        failsafe_steps += r.merges + r.rung_changes > 0 ? 1 : 0;
        warnings |= r.warnings;
    }
};

/// The bounds of G4 on one step.
inline void expect_ladder_bounds(const StepReport& report, std::size_t bodies) {
    const auto n = static_cast<std::int64_t>(bodies);
    EXPECT_LE(report.merges, n - 1) << "step " << report.step;
    EXPECT_LE(report.rung_changes, 3 * n) << "step " << report.step;
}

} // namespace flotilla::scenario
