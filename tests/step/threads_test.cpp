// SPDX-License-Identifier: MIT
// The same bits at any thread count, step by step (G3).
#include "state/build_model.hpp"
#include "step/scenario.hpp"
#include "step/stepper.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::scenario {
namespace {

class Threads : public testing::TestWithParam<ThreadScene> {};

TEST_P(Threads, GiveTheSameBitsInEveryStep) {
    const SceneDescription scene = GetParam().make(false);
    const int steps = GetParam().fast_steps;
    const auto expected = hashes_of_run(scene, steps, {1, Executor::serial});
    for (const int threads : {1, 2, 3, 8}) EXPECT_EQ(hashes_of_run(scene, steps, {threads}), expected) << threads;
}

/// More threads at a time than there are cores, which meet in more ways; regions that come and go with few of them.
TEST_P(Threads, ThatCrowdGiveTheSameBits) {
    const SceneDescription description = GetParam().make(false);
    const int steps = GetParam().fast_steps / 2;
    const auto expected = hashes_of_run(description, steps, {1, Executor::serial});
    const Scene scene = build_scene(description);
    const Model model = make_model(scene);
    Stepper stepper(model, initial_state(scene, model), {.team = {.threads = 5, .crowds = true}});
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < steps; ++i) hashes.push_back(stepper.step().state_hash);
    EXPECT_EQ(hashes, expected);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Threads, testing::ValuesIn(thread_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

TEST(ThreadScenes, IslandsMergeAndSplit) {
    const SceneDescription scene = changing_islands(false);
    World world(scene);
    int more = 0, fewer = 0;
    std::size_t before = 0;
    for (int n = 0; n < 40; ++n) {
        world.step();
        const std::size_t islands = count_islands(scene, world);
        more += islands > before ? 1 : 0;
        fewer += islands < before ? 1 : 0;
        before = islands;
    }
    EXPECT_GE(more, 5);
    EXPECT_GE(fewer, 5);
}

} // namespace
} // namespace flotilla::scenario
