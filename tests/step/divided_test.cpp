// SPDX-License-Identifier: MIT
// Steps divided among ranks have the bits of one process, on every rank. The ranks are threads here; tests/mpi has
// processes.
#include <gtest/gtest.h>

#include "api/world_access.hpp"
#include "parallel/division.hpp"
#include "step/thread_scenes.hpp"
#include "support/thread_ranks.hpp"

namespace flotilla::test {
namespace {

using Hashes = std::vector<std::uint64_t>;

Hashes hashes_of(World& world, int steps) {
    Hashes hashes;
    for (int k = 0; k < steps; ++k) hashes.push_back(world.step().state_hash);
    return hashes;
}

void expect_same_on(const SceneDescription& scene, int steps, std::initializer_list<int> numbers) {
    World alone(scene, "scene", {1, Executor::serial});
    const Hashes expected = hashes_of(alone, steps);
    for (const int size : numbers) {
        std::vector<Hashes> found(static_cast<std::size_t>(size));
        on_ranks(size, [&](Ranks& ranks) {
            World world(scene, "scene", {1, Executor::serial});
            Division division(ranks);
            WorldAccess::team(world).divide(&division);
            found[static_cast<std::size_t>(ranks.rank())] = hashes_of(world, steps);
        });
        for (const Hashes& hashes : found) EXPECT_EQ(hashes, expected) << size << " ranks";
    }
}

TEST(DividedStep, OfAPileHasTheBitsOfOneProcess) { expect_same_on(scenario::one_pile(false), 40, {1, 2, 5}); }

TEST(DividedStep, OfIslandsThatMergeAndSplitHasTheBitsOfOneProcess) {
    expect_same_on(scenario::changing_islands(false), 20, {3});
}

TEST(DividedStep, WithTheFailsafeHasTheBitsOfOneProcess) { expect_same_on(scenario::forced_stack(false), 40, {2, 3}); }

TEST(DividedStep, WithOtherSettingsHasTheBitsOfOneProcess) {
    SceneDescription scene = scenario::piles_of_boxes(2);
    for (const char* name : {"accurate", "preview", "paper"}) {
        scene.settings = preset(name);
        expect_same_on(scene, 12, {2});
    }
}

} // namespace
} // namespace flotilla::test
