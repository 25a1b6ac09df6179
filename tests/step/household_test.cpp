// SPDX-License-Identifier: MIT
// Mugs, stools and their like: handles and legs reach into each other.
#include "step/audited_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(Household, ThingsFallIntoTheBowlAndComeToRest) {
    constexpr int kSteps = 72;
    const SceneDescription scene = make_scene("household", 18, 1);
    AuditedRun run(scene);
    StepReport last;
    for (int n = 0; n < kSteps; ++n) {
        last = run.step();
        expect_ladder_bounds(last, scene.bodies.size());
    }
    EXPECT_EQ(run.findings, 0U);
    EXPECT_GT(run.audited_pairs, 0);
    EXPECT_GT(run.totals.collisions, 50);
    EXPECT_LT(last.kinetic_energy, 1e-4);
    const double bottom = scene.bodies.back().position.z;
    for (const Pose& pose : run.stepper().state().pose) EXPECT_GT(pose.origin.z, bottom - 1e-9);
}

} // namespace
} // namespace flotilla::scenario
