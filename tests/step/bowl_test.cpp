// SPDX-License-Identifier: MIT
#include "step/bowl_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(Bowl, TwentyBoatsComeToRest) { expect_boats_come_to_rest(22, 1, 500); }

/// Also what contacts are let off that carry much in a pile at rest.
TEST(Bowl, WhatEndsAboveTheToleranceOfContactsIsAWarning) {
    const SceneDescription scene = make_scene("boats-in-bowl", 80, 1);
    World world(scene);
    const double tolerance = kGravity * scene.settings.time_step / 4096;
    int let_off = 0, limited = 0;
    while (world.steps() < 90) {
        const StepReport r = world.step();
        const bool above = (r.warnings & (kStaticLimit | kStaticLetOff)) != 0;
        EXPECT_TRUE(above || r.residual <= tolerance) << "step " << r.step << ": " << r.residual << " m/s";
        EXPECT_TRUE((r.warnings & kStaticLetOff) == 0 || r.residual > tolerance) << "step " << r.step;
        let_off += (r.warnings & kStaticLetOff) != 0 ? 1 : 0;
        limited += (r.warnings & kStaticLimit) != 0 ? 1 : 0;
    }
    EXPECT_GT(let_off, 0);
    EXPECT_GT(limited, 0);
}

} // namespace
} // namespace flotilla::scenario
