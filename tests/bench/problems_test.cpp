// SPDX-License-Identifier: MIT
// The list of regular problems: every one can be run, and a motion that does nothing is no answer where something is to
// move.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include <flotilla/world.hpp>

#include "physics/problems/problems.hpp"
#include "physics/problems/tops.hpp"

namespace flotilla::physics {
namespace {

/// Of balanced at 1/24 s.
Settings balanced() { return physics::Run{}.settings(); }

/// The start for all of its time.
History stands_still(const Problem& problem, const SceneDescription& scene) {
    const World world(scene, problem.name, {1, Executor::serial});
    History history(scene.settings.time_step);
    for (double time = 0; time < problem.time + 0.5 * scene.settings.time_step; time += scene.settings.time_step) {
        Instant now{time, {}};
        for (std::size_t i = 0; i < world.size(); ++i) now.bodies.push_back(world.body(i));
        history.add(std::move(now));
    }
    return history;
}

TEST(Problems, HaveNamesOfTheirOwnAndScenesThatCanBeRun) {
    std::set<std::string> names;
    for (const Problem& problem : problems()) {
        EXPECT_TRUE(names.insert(problem.name).second) << problem.name;
        EXPECT_EQ(find_problem(problem.name), &problem);
        const SceneDescription scene = problem.scene(balanced());
        World world(scene, problem.name, {1, Executor::serial});
        EXPECT_NO_THROW((void)world.step()) << problem.name;
    }
    EXPECT_EQ(find_problem("no such problem"), nullptr);
}

TEST(Problems, WhatStandsStillIsRightWhereNothingIsToMove) {
    const std::set<std::string> at_rest{"hold", "stack-10", "stack-50",   "heavy-on-light",
                                        "arch", "cards",    "card-house", "pinched-block"};
    for (const Problem& problem : problems()) {
        if (problem.name == "roll") continue; // judged by its speed, which is due to stay
        const double error = problem.error_of(stands_still(problem, problem.scene(balanced())));
        if (at_rest.count(problem.name) > 0)
            EXPECT_EQ(error, 0) << problem.name;
        else
            EXPECT_FALSE(error <= problem.bound) << problem.name;
    }
}

// By so little that nothing springs apart.
TEST(Problems, OthersBeginInContact) {
    const SceneDescription scene = find_problem("stack-10")->scene({balanced(), false});
    for (std::size_t i = 0; i < 10; ++i) {
        const double below = 0.5 + static_cast<double>(i) - scene.bodies[i].position.z;
        EXPECT_GT(below, 0);
        EXPECT_LT(below, 1e-7);
    }
}

TEST(Crossings, TimesAreOnStraightLines) {
    Crossings crossings(1);
    EXPECT_FALSE(crossings.add(1, 0.5, 1));
    EXPECT_TRUE(crossings.add(2, -0.5, 1));
    EXPECT_TRUE(crossings.add(3, 1.5, 1));
    EXPECT_DOUBLE_EQ(crossings.time(0), 1.5);
    EXPECT_DOUBLE_EQ(crossings.time(1), 2.25);
    EXPECT_DOUBLE_EQ(crossings.period(), 1.5);
}

} // namespace
} // namespace flotilla::physics
