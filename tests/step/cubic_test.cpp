// SPDX-License-Identifier: MIT
// Stage 1 by the paper's cubic: it may overlook hits, the end of a step may not.
#include "step/audited_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(Cubic, ChoosesOtherHitsAndLetsNothingThrough) {
    SceneDescription scene = make_scene("boats-in-bowl", 14, 3);
    scene.settings.sleeping = false;
    AuditedRun proved(scene);
    scene.settings.ccd = CcdMethod::cubic;
    AuditedRun cubic(scene);
    int different = 0;
    for (int n = 0; n < 70; ++n) {
        const StepReport r = cubic.step();
        expect_ladder_bounds(r, scene.bodies.size());
        if (different == 0 && r.state_hash != proved.step().state_hash) different = n + 1;
    }
    EXPECT_EQ(cubic.findings, 0u);
    EXPECT_GE(cubic.totals.collisions, 100);
    EXPECT_GE(cubic.audited_pairs, 1000);
    EXPECT_GE(different, 1) << "the setting changed nothing";
    std::printf("cubic: %lld collisions, %lld merges, first differs in step %d\n",
                static_cast<long long>(cubic.totals.collisions), static_cast<long long>(cubic.totals.merges),
                different);
}

/// A plate that falls edge first on an edge in its own plane: the cubic vanishes, so only stage 5 sees the hit.
TEST(Cubic, WhatItOverlooksIsFoundInTheSameStep) {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    scene.settings.ccd = CcdMethod::cubic;
    const TriangleMesh plate{{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    const std::int32_t falling = add_shape(scene, plate, 5), ground = add_shape(scene, plate);
    add_body(scene, falling, BodyType::dynamic, {0.3, 0, 2.5}).velocity = {0, 0, -120}; // 5 m in a step
    add_body(scene, ground, BodyType::fixed, {});
    AuditedRun run(scene);
    EXPECT_EQ(run.step().collisions, 0);
    // Stage 5 stops it at the rest distance above the other plate, so boxes show already that nothing passed.
    const double rest = std::sqrt(8.0) / 330;
    for (int n = 0; n < 6; ++n) {
        EXPECT_NEAR(run.stepper().state().pose[0].com.z, 2 + rest, 1e-4) << "step " << n;
        run.step();
    }
    EXPECT_EQ(run.findings, 0u);

    scene.settings.ccd = CcdMethod::conservative;
    AuditedRun proved(scene);
    EXPECT_GE(proved.step().collisions, 1);
    EXPECT_EQ(proved.findings, 0u);
}

} // namespace
} // namespace flotilla::scenario
