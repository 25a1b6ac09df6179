// SPDX-License-Identifier: MIT
// Vertices and boxes of bodies that stand still are forgotten, and made again with the same bits.
#include "state/trajectories.hpp"

#include <latch>
#include <thread>

#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>

#include "scene/scene.hpp"
#include "state/build_model.hpp"

namespace flotilla {
namespace {

/// Boats in a bowl where the scene puts them.
struct Standing {
    Scene scene = build_scene(make_scene("boats-in-bowl", 12, 3));
    Model model = make_model(scene);
    State state = initial_state(scene, model);
    Trajectories trajectories;

    Standing() { trajectories.start(model, state.pose); }
};

struct Features {
    std::vector<Vec3> x;
    std::vector<Box> boxes;
    bool operator==(const Features&) const = default;
};

Features features_at(const BodyPlacement& at) {
    Features out{{at.x.begin(), at.x.end()}, {*at.box}};
    for (const auto list : {at.points, at.nodes})
        for (const CoarseBox& box : list) out.boxes.push_back(to_box(box));
    return out;
}

TEST(Trajectories, ForgottenFeaturesAreMadeAgain) {
    Standing s;
    std::vector<Features> before;
    for (std::size_t i = 0; i < s.model.size(); ++i) before.push_back(features_at(s.trajectories.at_start(i).at0));
    const std::size_t held = s.trajectories.memory();
    std::size_t freed = 0;
    for (std::size_t i = 0; i < s.model.size(); ++i) freed += s.trajectories.forget_features(i);
    EXPECT_EQ(s.trajectories.memory(), held - freed);
    EXPECT_LT(10 * s.trajectories.memory(), held);
    EXPECT_EQ(s.trajectories.forget_features(1), 0u) << "they are gone";
    EXPECT_EQ(s.trajectories.start_box(2).lower, before[2].boxes[0].lower) << "the box of all of them stays";
    EXPECT_EQ(features_at(s.trajectories.motion(3).at0), before[3]);
    EXPECT_TRUE(s.trajectories.motion(3).still());
    for (std::size_t i = 0; i < s.model.size(); ++i)
        EXPECT_EQ(features_at(s.trajectories.at_end(i).at0), before[i]) << i;
    EXPECT_EQ(s.trajectories.memory(), held);
}

TEST(Trajectories, OfABodyThatMovesNothingIsForgotten) {
    Standing s;
    Pose there = s.state.pose[4];
    there.origin.z += 1;
    there.com.z += 1;
    s.trajectories.set_end(4, there, {});
    EXPECT_EQ(s.trajectories.forget_features(4), 0u);
}

TEST(Trajectories, AForgottenBodyThatMovesHasThemAtBothEnds) {
    Standing s, kept;
    (void)s.trajectories.forget_features(4);
    Pose there = s.state.pose[4];
    there.origin.z += 1;
    there.com.z += 1;
    for (Standing* each : {&s, &kept}) each->trajectories.set_end(4, there, {});
    const BodyMotion motion = s.trajectories.motion(4), as_kept = kept.trajectories.motion(4);
    EXPECT_EQ(features_at(motion.at0), features_at(as_kept.at0));
    EXPECT_EQ(features_at(motion.at1), features_at(as_kept.at1));
    (void)s.trajectories.at_start(4);

    // Nobody asks before the step ends.
    (void)s.trajectories.forget_features(5);
    Pose five = s.state.pose[5];
    five.origin.x += 1;
    five.com.x += 1;
    const std::vector<std::int32_t> moved{5};
    for (Standing* each : {&s, &kept}) {
        each->trajectories.set_end(5, five, {});
        each->trajectories.advance(moved);
    }
    EXPECT_EQ(features_at(s.trajectories.at_start(5).at0), features_at(kept.trajectories.at_start(5).at0));
}

TEST(Trajectories, ThreadsMayAskSideBySide) {
    constexpr int kThreads = 4, kRounds = 50;
    Standing s;
    std::vector<Features> before;
    for (std::size_t i = 0; i < s.model.size(); ++i) before.push_back(features_at(s.trajectories.at_start(i).at0));
    for (int round = 0; round < kRounds; ++round) {
        for (std::size_t i = 0; i < s.model.size(); ++i) (void)s.trajectories.forget_features(i);
        std::latch ready(kThreads);
        std::vector<int> same(kThreads);
        std::vector<std::thread> threads;
        for (int t = 0; t < kThreads; ++t)
            threads.emplace_back([&, t] {
                ready.arrive_and_wait();
                for (std::size_t i = 0; i < s.model.size(); ++i)
                    same[static_cast<std::size_t>(t)] +=
                        features_at(s.trajectories.at_start(i).at0) == before[i] ? 1 : 0;
            });
        for (std::thread& t : threads) t.join();
        for (const int n : same) ASSERT_EQ(n, static_cast<int>(s.model.size()));
    }
}

} // namespace
} // namespace flotilla
