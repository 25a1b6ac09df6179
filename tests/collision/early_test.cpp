// SPDX-License-Identifier: MIT
// What stage 1 finds of a pair, ahead of its turn and in it: finding records nothing, and closing a pair early does
// what its turn would do.
#include <gtest/gtest.h>

#include "collision/pair_hits.hpp"
#include "collision/stage.hpp"

namespace flotilla {
namespace {

using scenario::add_body;
using test::StageWorld;

constexpr double kRadius = 0.5;

struct Way {
    const char* name;
    double gap, velocity; ///< m, m/s
    bool calls;           ///< for an impulse
    bool processed;
};
const Way kWays[] = {
    {"hits", 0.02, -10, true, true},
    {"ends near, too fast", 0.002, -0.05, true, true},
    {"ends near, slow", 0.002, -0.01, false, true},
    {"parts", 0.002, 0.02, false, true},
    {"is far", 0.1, -0.05, false, false},
};

/// A corner over a plate, with gravity.
SceneDescription corner_over_plate(const Way& way, CcdMethod ccd) {
    SceneDescription s = test::weightless_scene();
    s.settings.ccd = ccd;
    s.gravity = {0, 0, -9.8};
    add_body(s, test::add_octahedron(s, 2), BodyType::dynamic, {0.3, 0.1, kRadius + way.gap}, 0, 1).velocity = {
        0, 0, way.velocity};
    add_body(s, scenario::add_shape(s, make_plate(4, 4)), BodyType::fixed, {}, 0, 1);
    return s;
}

struct OnePair : StageWorld {
    OnePair(const Way& way, CcdMethod ccd) : StageWorld(corner_over_plate(way, ccd)) {}
    PairRecord& record() { return pairs().get(model(), state(), 0, 1); }
    [[nodiscard]] Verdict verdict_now() { return verdict(trajectories(), record()); }
};

class EarlyCollisions : public testing::TestWithParam<CcdMethod> {};

TEST_P(EarlyCollisions, FindingRecordsNothing) {
    for (const Way& way : kWays) {
        SCOPED_TRACE(way.name);
        OnePair world(way, GetParam());
        const StepView view = world.view();
        Worker& worker = world.workers()[0];
        PairRecord& pair = world.record();
        const CollisionFinding found = find_collision(view, worker, pair, pair.cache);
        EXPECT_EQ(found.urgent.has_value(), way.calls);
        EXPECT_EQ(found.processed, way.processed);
        EXPECT_EQ(world.verdict_now(), Verdict::open);
        EXPECT_FALSE(pair.processed);
        const CollisionFinding again = find_collision(view, worker, pair, pair.cache);
        EXPECT_EQ(again.urgent.has_value(), way.calls);
        EXPECT_EQ(again.hit.toi, found.hit.toi);
        EXPECT_EQ(again.verdict, found.verdict);
    }
}

TEST_P(EarlyCollisions, ClosingEarlyDoesWhatTheTurnWouldDo) {
    const Verdict no_hit = GetParam() == CcdMethod::conservative ? Verdict::apart : Verdict::settled;
    for (const Way& way : kWays) {
        SCOPED_TRACE(way.name);
        OnePair early(way, GetParam()), in_turn(way, GetParam());
        EXPECT_EQ(look_at(early.view(), early.workers()[0], early.record()).urgent.has_value(), way.calls);
        EXPECT_EQ(find_hits(in_turn.view(), in_turn.workers()[0], in_turn.record()), way.calls);
        EXPECT_EQ(in_turn.record().processed, way.processed);
        if (way.calls) {
            EXPECT_EQ(early.verdict_now(), Verdict::open) << "its turn comes as ever";
            EXPECT_FALSE(early.record().processed);
        } else {
            EXPECT_EQ(early.verdict_now(), no_hit);
            EXPECT_EQ(in_turn.verdict_now(), no_hit);
            EXPECT_EQ(early.record().processed, way.processed);
        }
    }
}

// An operation before the pair's turn moves the body: the turn finds the pair open, and what was expected is void.
TEST_P(EarlyCollisions, WhatWasExpectedIsVoidWhereABodyMovesBeforeTheTurn) {
    OnePair world(kWays[2], GetParam());
    const StepView view = world.view();
    Worker& worker = world.workers()[0];
    PairRecord& pair = world.record();
    ASSERT_FALSE(look_at(view, worker, pair).urgent);
    ASSERT_TRUE(pair.processed);
    world.movers().trajectories().set_end(0, make_pose(world.model().shape_of(0), {0.3, 0.1, 2}, {}), {});
    EXPECT_EQ(world.verdict_now(), Verdict::open);
    pair.processed.withdraw();
    EXPECT_FALSE(find_hits(view, worker, pair));
    EXPECT_FALSE(pair.processed) << "where it is now it is near nothing";
}

INSTANTIATE_TEST_SUITE_P(Ccd, EarlyCollisions, testing::Values(CcdMethod::conservative, CcdMethod::cubic),
                         [](const testing::TestParamInfo<CcdMethod>& method) {
                             return method.param == CcdMethod::conservative ? "conservative" : "cubic";
                         });

} // namespace
} // namespace flotilla
