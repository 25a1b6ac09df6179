// SPDX-License-Identifier: MIT
// A slice of the matrix of extremes: every value alone, and every 40th of the pairs.
#include <gtest/gtest.h>

#include <map>

#include "extremes/check.hpp"

namespace flotilla::extremes {
namespace {

TEST(Extremes, EveryPromiseIsKeptOrTheSceneIsRefused) {
    std::map<Verdict, int> count;
    std::size_t n = 0;
    for (const Cell& cell : all_cells()) {
        if (cell.extremes.size() > 1 && n++ % 40 != 0) continue;
        const Outcome out = run_cell(cell, 4);
        ++count[out.verdict];
        EXPECT_NE(out.verdict, Verdict::broken) << cell.name() << ": " << out.message;
        EXPECT_EQ(out.verdict == Verdict::refused, !out.message.empty()) << cell.name();
        EXPECT_LT(out.slowest_step, 2) << cell.name();
    }
    EXPECT_GT(count[Verdict::pass], 100);
    EXPECT_GT(count[Verdict::refused], 1);
}

/// Momentum of a body that nothing touches changes by what the gravity of each step adds, and is asked for every time.
TEST(Extremes, BodiesFeelTheGravityOfEveryStep) {
    const Extreme one{"crowd", "one body", [](Knobs& k) { k.crowd = Knobs::Crowd::one; }};
    SceneDescription scene = Cell{Situation::clash, {one}, {}}.scene();
    scene.gravity = {0, 0, -9.8};
    for (const Extreme& e : changing_gravity()) {
        const GravityOfStep gravity = Cell{Situation::pile, {e}, {}}.gravity_of_step();
        EXPECT_NE(gravity(scene.gravity, 2), gravity(scene.gravity, 1)) << e.value;
        const Outcome out = run_scene(scene, {.steps = 6, .gravity = gravity});
        EXPECT_EQ(out.verdict, Verdict::pass) << e.value << ": " << out.message;
        EXPECT_EQ(out.steps, 6);
    }
}

TEST(Extremes, TheMatrixHasTwoThousandCells) { EXPECT_GE(all_cells().size(), 2000u); }

} // namespace
} // namespace flotilla::extremes
