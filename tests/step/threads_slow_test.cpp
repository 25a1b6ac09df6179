// SPDX-License-Identifier: MIT
// The same bits at any thread count, step by step, run after run (G3): the whole scenes.
#include <cstdio>

#include "step/scenario.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::scenario {
namespace {

class AllThreads : public testing::TestWithParam<ThreadScene> {};

TEST_P(AllThreads, GiveTheSameBitsInEveryStepFiveTimes) {
    const SceneDescription scene = GetParam().make(true);
    const int steps = GetParam().slow_steps;
    const auto expected = hashes_of_run(scene, steps, {1, Executor::serial});
    int runs = 0, different = 0;
    for (int repetition = 0; repetition < 5; ++repetition)
        for (const int threads : {0, 1, 2, 3, 4, 8, 16}) {
            const WorldOptions options{std::max(threads, 1), threads == 0 ? Executor::serial : Executor::parallel};
            const bool same = hashes_of_run(scene, steps, options) == expected;
            EXPECT_TRUE(same) << threads << " threads, repetition " << repetition;
            different += same ? 0 : 1;
            ++runs;
        }
    std::printf("%s, %zu bodies, %d steps: %d runs, %d different from the serial one, last hash %016llx\n",
                GetParam().name, scene.bodies.size(), steps, runs, different,
                static_cast<unsigned long long>(expected.back()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, AllThreads, testing::ValuesIn(thread_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

} // namespace
} // namespace flotilla::scenario
