// SPDX-License-Identifier: MIT
// Candidate lists that outlive queries and steps change no bit.
#include <tuple>

#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>

#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

/// How bodies move, and in how many inner steps.
class CandidateListsOf : public testing::TestWithParam<std::pair<Trajectory, int>> {};

TEST_P(CandidateListsOf, LeaveEveryStateAsItIs) {
    constexpr int kSteps = 260, kRests = 240; // a boat alone slides for up to 210
    SceneDescription description = make_scene("boats-in-bowl", 14, 3);
    description.settings.sleeping = false;
    std::tie(description.settings.trajectory, description.settings.substeps) = GetParam();
    const Scene scene = build_scene(description);
    const Model model = make_model(scene);
    Stepper with(model, initial_state(scene, model));
    Stepper without(model, initial_state(scene, model), {.keep_candidates = false});
    std::int64_t collisions = 0, contacts = 0, pairs = 0;
    const auto queries_of = [](const Stepper& s) { return s.query_counters().pair_queries; };
    std::int64_t queries_with = 0;
    for (int n = 0; n < kSteps; ++n) {
        if (n == kRests) queries_with = queries_of(with);
        const StepReport r = with.step();
        ASSERT_EQ(r.state_hash, without.step().state_hash) << "step " << n + 1;
        collisions += r.collisions;
        contacts = r.contacts;
        if (n >= kRests) pairs += r.pairs;
    }
    EXPECT_GE(collisions, 100);
    EXPECT_GE(contacts, 20);
    // At rest bounds say of all pairs what queries would: that they stay apart.
    EXPECT_GE(pairs, (kSteps - kRests) * contacts / 8);
    EXPECT_EQ(queries_of(with), queries_with);
    // Without lists they are queried for as long as they move at all: with inner steps they no longer do then.
    EXPECT_GE(queries_of(without), queries_of(with) + (kSteps - kRests) * contacts / 8);
}

INSTANTIATE_TEST_SUITE_P(Motions, CandidateListsOf,
                         testing::Values(std::pair{Trajectory::linear, 1}, std::pair{Trajectory::rigid, 1},
                                         std::pair{Trajectory::linear, 4}, std::pair{Trajectory::rigid, 4}));

// Planes between convex bodies that touch prove them apart in place of queries.
TEST(CandidateLists, OfConvexBodiesLeaveEveryStateAsItIs) {
    SceneDescription description = make_scene("rocks", 33, 2);
    description.settings.sleeping = false;
    const Scene scene = build_scene(description);
    const Model model = make_model(scene);
    Stepper with(model, initial_state(scene, model));
    Stepper without(model, initial_state(scene, model), {.keep_candidates = false});
    std::int64_t contacts = 0;
    for (int n = 0; n < 250; ++n) {
        const StepReport r = with.step();
        ASSERT_EQ(r.state_hash, without.step().state_hash) << "step " << n + 1;
        contacts = r.contacts;
    }
    EXPECT_GE(contacts, 60);
    EXPECT_GE(without.query_counters().pair_queries, 3 * with.query_counters().pair_queries);
}

// What is known of pairs must not decide whether the limit of sweeps was met, on which stage 7 depends.
TEST(CandidateLists, LeaveEveryStateAsItIsAtTheLimitOfSweeps) {
    std::int64_t limits = 0;
    for (const auto& [sweeps, impulses] : {std::pair{1, 4}, {2, 4}, {3, 0}}) {
        SceneDescription description = make_scene("boats-in-bowl", 14, 3);
        description.settings.sleeping = false;
        description.settings.collision_iterations = sweeps;
        description.settings.collision_pair_iterations = impulses;
        const Scene scene = build_scene(description);
        const Model model = make_model(scene);
        Stepper with(model, initial_state(scene, model));
        Stepper without(model, initial_state(scene, model), {.keep_candidates = false});
        for (int n = 0; n < 200; ++n) {
            const StepReport r = with.step(), s = without.step();
            ASSERT_EQ(r.state_hash, s.state_hash) << sweeps << ' ' << impulses << ", step " << n + 1;
            ASSERT_EQ(r.warnings, s.warnings) << sweeps << ' ' << impulses << ", step " << n + 1;
            limits += (r.warnings & kCollisionLimit) != 0 ? 1 : 0;
        }
    }
    EXPECT_GE(limits, 100);
}

} // namespace
} // namespace flotilla
