// SPDX-License-Identifier: MIT
// The failsafe alone: stage 1 and dynamic contact get no sweeps, or one.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// Figure 9: a ball hits a stack of blocks.
SceneDescription ball_and_stack(Rigidification kind, int iterations) {
    SceneDescription scene = make_scene("stack", 9);
    scene.settings.sleeping = false;
    scene.settings.rigidification = kind;
    scene.settings.collision_iterations = iterations;
    scene.settings.dynamic_iterations = iterations;
    const auto ball = add_shape(scene, make_sphere(0.6, 1), 800);
    add_body(scene, ball, BodyType::dynamic, {-3, 0.1, 3.2}).velocity = {12, 0, 0};
    return scene;
}

struct Outcome {
    RunTotals totals;
    double spread = 0; ///< m, by how much the blocks' horizontal displacements differ
};

Outcome run_stack(Rigidification kind, int iterations, int steps) {
    const SceneDescription scene = ball_and_stack(kind, iterations);
    World world(scene);
    Outcome out;
    for (int n = 0; n < steps; ++n) {
        const StepReport r = world.step();
        out.totals.add(r);
        expect_ladder_bounds(r, world.size());
        EXPECT_EQ(count_intersections(scene, world), 0) << "step " << n;
    }
    double least = 1e300, most = -1e300;
    for (std::size_t i = 0; i < 8; ++i) {
        const double x = world.body(i).center_of_mass.x;
        least = std::min(least, x);
        most = std::max(most, x);
    }
    out.spread = most - least;
    return out;
}

TEST(ForcedFailsafe, KinematicLetsAStackBreakUpAndRigidFreezesIt) {
    for (const int iterations : {0, 1}) {
        const Outcome kinematic = run_stack(Rigidification::kinematic, iterations, 36);
        const Outcome rigid = run_stack(Rigidification::rigid, iterations, 36);
        std::printf(
            "figure 9, limit %d: spread %.3f m kinematic (%lld merges, %lld rung changes), %.3f m rigid (%lld, %lld)\n",
            iterations, kinematic.spread, static_cast<long long>(kinematic.totals.merges),
            static_cast<long long>(kinematic.totals.rung_changes), rigid.spread,
            static_cast<long long>(rigid.totals.merges), static_cast<long long>(rigid.totals.rung_changes));
        EXPECT_GE(kinematic.totals.merges, 10);
        EXPECT_GE(rigid.totals.merges, 5);
        EXPECT_GT(kinematic.spread, 0.5);
        EXPECT_LT(rigid.spread, 0.5 * kinematic.spread);
    }
}

TEST(ForcedFailsafe, EnergyOfFiftyBoatsDoesNotGrow) {
    SceneDescription scene = make_scene("boats-in-bowl", 52, 1);
    scene.settings.sleeping = false;
    scene.settings.collision_iterations = 0;
    scene.settings.dynamic_iterations = 0;
    World world(scene);
    RunTotals totals;
    double last = 1e300, start = 0, growth = 0, total_growth = 0;
    for (int n = 0; n < 100; ++n) {
        const StepReport r = world.step();
        totals.add(r);
        expect_ladder_bounds(r, world.size());
        if (n == 0) start = r.energy;
        if (n > 0) growth = std::max(growth, r.energy - last), total_growth += std::max(0.0, r.energy - last);
        last = r.energy;
        if (n % 10 == 9) {
            ASSERT_EQ(count_intersections(scene, world), 0) << "step " << n;
        }
    }
    std::printf("50 boats, failsafe in %lld of 100 steps: energy %.6g J to %.6g J, largest growth in a step %.3g J "
                "(sum %.3g J)\n",
                static_cast<long long>(totals.failsafe_steps), start, last, growth, total_growth);
    EXPECT_GE(totals.failsafe_steps, 50);
    EXPECT_LT(growth, 1e-9 * start);
}

} // namespace
} // namespace flotilla::scenario
