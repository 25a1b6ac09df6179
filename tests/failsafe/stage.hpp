// SPDX-License-Identifier: MIT
// The failsafe alone, and what it must leave behind.
#pragma once

#include <gtest/gtest.h>

#include "failsafe/failsafe.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "support/stage_world.hpp"

namespace flotilla::test {

inline FailsafeStats run_failsafe_of(StageWorld& world) {
    return run_failsafe(world.view(), world.movers(), world.book(), world.workers());
}

/// Pairs of triangles of different bodies, one of them movable, that meet at the end poses. Exact.
inline int count_intersections(const StageWorld& world) {
    int count = 0;
    const auto triangles_of = [&](std::size_t body) {
        const BodyMotion motion = world.trajectories().at_end(body);
        std::vector<std::array<Vec3, 3>> out;
        for (const Triangle& t : motion.shape->mesh.triangles) {
            const auto x = [&](std::int32_t v) { return motion.at1.x[static_cast<std::size_t>(v)]; };
            out.push_back({x(t[0]), x(t[1]), x(t[2])});
        }
        return out;
    };
    const std::vector<Body>& bodies = world.model().bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        for (std::size_t j = i + 1; j < bodies.size(); ++j) {
            if (!bodies[i].movable() && !bodies[j].movable()) continue;
            for (const auto& a : triangles_of(i))
                for (const auto& b : triangles_of(j)) count += exact::triangles_intersect(a, b) ? 1 : 0;
        }
    return count;
}

/// The bounds of the ladder and what it is for.
inline void expect_resolved(StageWorld& world, const FailsafeStats& stats) {
    const auto n = static_cast<std::int64_t>(world.model().size());
    EXPECT_LE(stats.merges, n - 1);
    EXPECT_LE(stats.rung_changes, 3 * n);
    EXPECT_TRUE(proved_apart(world));
    EXPECT_EQ(count_intersections(world), 0);
}

} // namespace flotilla::test
