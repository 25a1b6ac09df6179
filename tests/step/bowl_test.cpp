// SPDX-License-Identifier: MIT
#include "step/bowl_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(Bowl, TwentyBoatsComeToRest) { expect_boats_come_to_rest(22, 1, 500); }

TEST(Bowl, WhatEndsAboveTheToleranceOfContactsIsAWarning) {
    const SceneDescription scene = make_scene("boats-in-bowl", 80, 1);
    World world(scene);
    const double tolerance = kGravity * scene.settings.time_step / 4096;
    int limited = 0;
    while (world.steps() < 90) {
        const StepReport r = world.step();
        const bool above = (r.warnings & kStaticLimit) != 0;
        EXPECT_TRUE(above || r.residual <= tolerance) << "step " << r.step << ": " << r.residual << " m/s";
        limited += above ? 1 : 0;
    }
    EXPECT_GT(limited, 0);
}

} // namespace
} // namespace flotilla::scenario
