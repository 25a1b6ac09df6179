// SPDX-License-Identifier: MIT
// The hashes of every step of boats that fall and that settle, and of 64 piles, on up to 4 ranks.
#include "mpi/scene_over_ranks.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::test {
namespace {

TEST(OneSceneOverRanksSlow, Boats252HaveTheHashesOfOneProcess) {
    const OneScene pile(make_scene("boats-in-bowl", 252, 1), 80);
    for (int ranks = 1; ranks <= 4; ++ranks) pile.expect_same_on(ranks);
}

// Until they sleep: what still moves when an island is solved is swept further (settle() in sweep_island.cpp), a small
// island's by the rank that has it.
TEST(OneSceneOverRanksSlow, Boats102ThatSettleHaveTheHashesOfOneProcess) {
    OneScene(make_scene("boats-in-bowl", 102, 3), 220).expect_same_on(3);
}

TEST(OneSceneOverRanksSlow, Piles64HaveTheHashesOfOneProcess) {
    const OneScene piles(scenario::piles_of_boxes(64), 80);
    for (int ranks = 1; ranks <= 4; ++ranks) piles.expect_same_on(ranks);
}

} // namespace
} // namespace flotilla::test
