// SPDX-License-Identifier: MIT
// flotilla-mpi run: one scene over ranks, with the bits of one process.
#include "mpi/scene_over_ranks.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::test {
namespace {

TEST(OneSceneOverRanks, APileHasTheHashesOfOneProcess) {
    const OneScene pile(scenario::one_pile(false), 50);
    for (int ranks = 1; ranks <= 4; ++ranks) pile.expect_same_on(ranks);
    pile.expect_same_on(2, "--threads 2 --overwrite");
}

TEST(OneSceneOverRanks, IslandsThatMergeAndSplitHaveTheHashesOfOneProcess) {
    const OneScene heaps(scenario::changing_islands(false), 30);
    heaps.expect_same_on(3);
}

TEST(OneSceneOverRanks, TheFailsafeHasTheHashesOfOneProcess) {
    const OneScene stack(scenario::forced_stack(false), 30);
    stack.expect_same_on(3);
}

TEST(OneSceneOverRanks, OtherSettingsHaveTheHashesOfOneProcess) {
    SceneDescription scene = make_scene("boats-in-bowl", 12, 1);
    scene.settings = preset("accurate");
    scene.settings.sleeping = true;
    OneScene(scene, 20).expect_same_on(2);
    scene.settings = preset("preview");
    OneScene(scene, 30).expect_same_on(2);
    scene.settings = preset("paper");
    OneScene(scene, 20).expect_same_on(2);
}

TEST(OneSceneOverRanks, ARunGoesOnFromItsCheckpointOnAnotherNumberOfRanks) {
    const OneScene pile(scenario::one_pile(false), 40);
    const auto run = [&](int ranks, const std::string& options) {
        return run_ranks(ranks, "run " + pile.file() + " --quiet" + pile.to("parts") + ' ' + options).exit_code;
    };
    EXPECT_EQ(run(3, "--steps 17"), 0);
    EXPECT_EQ(run(2, "--steps 40"), 2) << "the folder is not empty";
    EXPECT_EQ(run(2, "--steps 30 --resume"), 0);
    EXPECT_EQ(run(2, "--steps 30 --resume"), 0) << "there is nothing to do";
    const CommandOutput last = run_flotilla("run " + pile.file() + " --quiet --steps 40 --resume" + pile.to("parts"));
    EXPECT_EQ(last.exit_code, 0) << last.err;
    EXPECT_EQ(step_hashes(pile.folder().path() / "parts"), pile.hashes());
}

TEST(OneSceneOverRanks, ATimeLimitLeavesACheckpoint) {
    const OneScene pile(scenario::one_pile(false), 1);
    const std::string run = "run " + pile.file() + " --steps 30 --time-limit 0:0:0" + pile.to("short");
    const CommandOutput r = run_ranks(2, run);
    EXPECT_EQ(r.exit_code, 6) << r.err;
    EXPECT_NE(r.err.find("--resume goes on"), std::string::npos) << r.err;
}

TEST(OneSceneOverRanks, WhatIsWrongIsSaidOnce) {
    const OneScene pile(scenario::one_pile(false), 1);
    const auto refused = [&](const std::string& arguments, const std::string& word) {
        const CommandOutput r = run_ranks(3, "run " + arguments);
        EXPECT_EQ(r.exit_code, 2) << r.err;
        EXPECT_NE(r.err.find(word), std::string::npos) << r.err;
        EXPECT_EQ(r.err.find(word), r.err.rfind(word)) << "one rank says it\n" << r.err;
    };
    refused(pile.file() + " --set frction=1", "frction");
    refused(pile.file() + " --resume", "need --output");
}

} // namespace
} // namespace flotilla::test
