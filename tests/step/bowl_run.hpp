// SPDX-License-Identifier: MIT
// Boats that fell into a bowl, 10 s later.
#pragma once

#include "scene/scene.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {

/// The wall of the scene's bowl, a cap of a sphere that touches z = 0 at the origin.
struct BowlWall {
    double sphere = 0, rim = 0; ///< m, radii

    explicit BowlWall(const SceneDescription& scene) {
        double top = 0;
        for (const Vec3& v : scene.shapes[1].vertices) {
            rim = std::max(rim, std::hypot(v.x, v.y));
            top = std::max(top, v.z);
        }
        sphere = (rim * rim + top * top) / (2 * top);
    }
    [[nodiscard]] bool contains(const Vec3& p) const {
        const double r = std::hypot(p.x, p.y);
        return r < rim && p.z > sphere - std::sqrt(sphere * sphere - r * r);
    }
};

/// Runs boats-in-bowl for 10 s and expects a pile at rest inside the bowl, free of intersections.
inline void expect_boats_come_to_rest(int bodies, std::uint64_t seed, std::int64_t least_collisions) {
    constexpr int kSteps = 240, kQuiet = 190, kLastSecond = 216;
    SceneDescription scene = make_scene("boats-in-bowl", bodies, seed);
    scene.settings.sleeping = false;
    World world(scene);
    const auto boats = static_cast<std::size_t>(bodies - 2);
    RunTotals totals;
    std::vector<Vec3> place(boats);
    double fastest = 0, drift = 0;
    StepReport last;
    for (int n = 0; n < kSteps; ++n) {
        last = world.step();
        totals.add(last);
        expect_ladder_bounds(last, world.size());
        for (std::size_t i = 0; i < boats; ++i) {
            const BodyState s = world.body(i);
            if (last.step > kQuiet) fastest = std::max(fastest, length(s.velocity));
            if (last.step == kLastSecond) place[i] = s.position;
            if (last.step > kLastSecond) drift = std::max(drift, length(s.position - place[i]));
        }
    }
    std::printf("%zu boats: %lld collisions, %lld merges; after step %d fastest %.3g m/s; in the last second drift "
                "%.3g m; at the "
                "end kinetic energy %.3g J a boat, %lld contacts\n",
                boats, static_cast<long long>(totals.collisions), static_cast<long long>(totals.merges), kQuiet,
                fastest, drift, last.kinetic_energy / static_cast<double>(boats),
                static_cast<long long>(last.contacts));
    EXPECT_GE(totals.collisions, least_collisions);
    EXPECT_LT(fastest, 0.05);
    EXPECT_LT(drift, 1e-3);
    const double fall = shape_mass_properties(scene.shapes[0])->mass * kGravity * 1.0; // J, of a boat that falls 1 m
    EXPECT_LT(last.kinetic_energy / static_cast<double>(boats), 1e-4 * fall);

    std::vector<int> touches(world.size(), 0);
    for (const ContactState& c : world.contacts()) // nearer than d_proximity
        ++touches[static_cast<std::size_t>(c.body_a)], ++touches[static_cast<std::size_t>(c.body_b)];
    const BowlWall wall(scene);
    for (std::size_t i = 0; i < boats; ++i) {
        EXPECT_GE(touches[i], 1) << "boat " << i;
        EXPECT_TRUE(wall.contains(world.body(i).center_of_mass)) << "boat " << i;
    }
    EXPECT_EQ(count_intersections(scene, world), 0);
}

} // namespace flotilla::scenario
