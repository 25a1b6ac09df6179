// SPDX-License-Identifier: MIT
// What pairs are due that are asked in vain for their rest distance.
#include "static_contact/squeezed_pairs.hpp"

#include <gtest/gtest.h>

namespace flotilla {
namespace {

constexpr double kRest = 0.01; // m
const ContactTuning kTuning{};

struct Found {
    std::int32_t a, b;
    double distance; // m
    bool ahead = false;
};

ContactSet contacts(const std::vector<Found>& found) {
    ContactSet set;
    for (const Found& f : found) {
        Contact c;
        c.a = f.a, c.b = f.b, c.distance = f.distance;
        set.add(c, kRest, false, f.ahead);
    }
    return set;
}

struct SqueezedPairsOf : testing::Test {
    Team team{TeamOptions{.threads = 2}};
    SqueezedPairs pairs;
    std::vector<SqueezedPair> squeezed;
    std::int32_t spent = -1;  // the pairs of this body are not asked
    std::int32_t asleep = -1; // the pairs of this body rest

    void step(const std::vector<Found>& found) {
        const auto rests = [&](std::int32_t a, std::int32_t b) { return a == asleep || b == asleep; };
        const auto asked = [&](std::int32_t a, std::int32_t b) { return a != spent && b != spent; };
        pairs.update(team, contacts(found), kTuning, rests, asked, squeezed);
    }
    [[nodiscard]] double due(std::int32_t a, std::int32_t b) const { return due_distance(squeezed, a, b, kRest); }
};

TEST_F(SqueezedPairsOf, APairIsDueItsRestDistanceUntilItWasAskedInVainForLongEnough) {
    for (int n = 1; n < kTuning.steps_in_vain; ++n) {
        step({{0, 1, 0.9 * kRest}, {0, 2, 0.7 * kRest}, {0, 2, 0.8 * kRest}, {1, 3, 1.2 * kRest}});
        EXPECT_EQ(due(0, 1), kRest);
        EXPECT_EQ(due(0, 2), kRest);
    }
    step({{0, 1, kRest}, {0, 2, 0.8 * kRest}, {0, 2, 0.6 * kRest}, {1, 3, 1.2 * kRest}});
    EXPECT_EQ(due(0, 1), kRest) << "reached it in time";
    EXPECT_EQ(due(0, 2), 0.6 * kRest) << "the nearest contact counts";
    EXPECT_EQ(due(1, 3), kRest);
    EXPECT_EQ(squeezed.size(), 1u);
}

TEST_F(SqueezedPairsOf, ItIsAskedAgainAndWaitsTwiceAsLongEachTime) {
    for (int wait = kTuning.steps_in_vain; wait <= 16 * kTuning.steps_in_vain; wait *= 2) {
        for (int n = 0; n < kTuning.steps_in_vain; ++n) {
            EXPECT_EQ(due(0, 1), kRest);
            step({{0, 1, 0.5 * kRest}});
        }
        for (int n = 0; n < wait; ++n) {
            EXPECT_EQ(due(0, 1), 0.5 * kRest) << "step " << n << " of " << wait;
            step({{0, 1, 0.5 * kRest}});
        }
    }
}

TEST_F(SqueezedPairsOf, WhatItGainsWhileItWaitsIsDueFromThenOnAndAtItsRestDistanceItIsForgotten) {
    for (int n = 0; n < kTuning.steps_in_vain; ++n) step({{0, 1, 0.5 * kRest}});
    step({{0, 1, 0.7 * kRest}});
    EXPECT_EQ(due(0, 1), 0.7 * kRest);
    step({{0, 1, 0.6 * kRest}}); // pressed in again
    EXPECT_EQ(due(0, 1), 0.7 * kRest);
    step({{0, 1, kRest}});
    EXPECT_TRUE(squeezed.empty());
    EXPECT_EQ(due(0, 1), kRest);
}

TEST_F(SqueezedPairsOf, WhatADeadBandHidesIsNotAskedFor) {
    for (int n = 0; n < 2 * kTuning.steps_in_vain; ++n) step({{0, 1, (1 - 0.5 * kTuning.most_of_rest) * kRest}});
    EXPECT_TRUE(squeezed.empty());
}

TEST_F(SqueezedPairsOf, PairsThatWereNotAskedAreForgotten) {
    spent = 1;
    for (int n = 0; n < kTuning.steps_in_vain; ++n) step({{0, 1, 0.6 * kRest}, {0, 2, 0.6 * kRest}});
    EXPECT_EQ(due(0, 1), kRest);
    EXPECT_EQ(due(0, 2), 0.6 * kRest);
    spent = 2;
    step({{0, 2, 0.6 * kRest}});
    EXPECT_TRUE(squeezed.empty());
}

TEST_F(SqueezedPairsOf, ContactsAheadSayNothing) {
    for (int n = 0; n < kTuning.steps_in_vain; ++n)
        step({{0, 1, 0.5 * kRest, true}, {0, 2, 0.8 * kRest}, {0, 2, 0.1 * kRest, true}});
    EXPECT_EQ(due(0, 1), kRest);
    EXPECT_EQ(due(0, 2), 0.8 * kRest);
}

TEST_F(SqueezedPairsOf, PairsThatRestAreKeptAndOthersWithoutContactsAreNot) {
    for (int n = 0; n < kTuning.steps_in_vain; ++n)
        step({{0, 1, 0.5 * kRest}, {1, 2, 0.6 * kRest}, {2, 3, 0.7 * kRest}, {4, 5, 0.8 * kRest}});
    EXPECT_EQ(squeezed.size(), 4u);
    asleep = 2;
    step({{0, 1, 0.5 * kRest}});
    EXPECT_EQ(due(0, 1), 0.5 * kRest);
    EXPECT_EQ(due(1, 2), 0.6 * kRest);
    EXPECT_EQ(due(2, 3), 0.7 * kRest);
    EXPECT_EQ(due(4, 5), kRest);
    EXPECT_EQ(squeezed.size(), 3u);
}

} // namespace
} // namespace flotilla
