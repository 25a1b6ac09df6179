// SPDX-License-Identifier: MIT
// Blocks at rest on each other.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

TEST(Stack, StackOfTwentyBlocksStandsStill) {
    SceneDescription scene = make_scene("stack", 21);
    scene.settings.sleeping = false;
    World world(scene);
    std::vector<Vec3> start;
    for (std::size_t i = 0; i < 20; ++i) start.push_back(world.body(i).position);
    double fastest = 0, drift = 0;
    std::int64_t contacts = 1000000;
    for (int n = 0; n < 240; ++n) {
        const StepReport r = world.step();
        contacts = std::min(contacts, r.contacts);
        if (n >= 216)
            for (std::size_t i = 0; i < 20; ++i) fastest = std::max(fastest, length(world.body(i).velocity));
    }
    for (std::size_t i = 0; i < 20; ++i) drift = std::max(drift, length(world.body(i).position - start[i]));
    std::printf("stack of 20: drift %.3g m in 10 s, fastest %.3g m/s in the last second, at least %lld contacts\n",
                drift, fastest, static_cast<long long>(contacts));
    EXPECT_GE(contacts, 3 * 20);
    EXPECT_LT(drift, 0.005);
    EXPECT_LT(fastest, 0.01);
}

} // namespace
} // namespace flotilla::scenario
