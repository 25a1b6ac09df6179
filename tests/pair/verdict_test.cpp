// SPDX-License-Identifier: MIT
// What is recorded of a pair, and for how long it counts.
#include <gtest/gtest.h>

#include "pair/pair_table.hpp"

namespace flotilla {
namespace {

constexpr Verdict kAll[] = {Verdict::open, Verdict::settled, Verdict::apart};

TEST(Verdict, IsOfTheEndStatesThatItWasFoundAt) {
    VersionedVerdict verdict;
    EXPECT_EQ(verdict.at(3, 5), Verdict::open);
    verdict.commit(Verdict::apart, 3, 5);
    EXPECT_EQ(verdict.at(3, 5), Verdict::apart);
    EXPECT_EQ(verdict.at(4, 5), Verdict::open) << "the first body moved";
    EXPECT_EQ(verdict.at(3, 6), Verdict::open) << "the second body moved";
    EXPECT_EQ(verdict.at(5, 3), Verdict::open);
}

TEST(Verdict, TheGreaterOneOfTheSameEndStatesStays) {
    for (const Verdict first : kAll)
        for (const Verdict second : kAll) {
            VersionedVerdict verdict;
            verdict.commit(first, 3, 5);
            verdict.commit(second, 3, 5);
            EXPECT_EQ(verdict.at(3, 5), std::max(first, second));
            verdict.commit(second, 3, 6);
            EXPECT_EQ(verdict.at(3, 6), second) << "nothing of what was found before";
            EXPECT_EQ(verdict.at(3, 5), Verdict::open);
        }
}

TEST(Processed, IsWithdrawnOnlyWhereItWasExpected) {
    Processed never, expected, found, confirmed, again;
    expected.expect();
    found.set();
    confirmed.expect(), confirmed.confirm();
    again.set(), again.expect();
    EXPECT_FALSE(never);
    for (const Processed* p : {&expected, &found, &confirmed, &again}) EXPECT_TRUE(*p);
    for (Processed* p : {&never, &expected, &found, &confirmed, &again}) p->withdraw();
    EXPECT_FALSE(never);
    EXPECT_FALSE(expected);
    for (const Processed* p : {&found, &confirmed, &again}) EXPECT_TRUE(*p);
    never.confirm();
    EXPECT_FALSE(never) << "nothing was expected";
}

} // namespace
} // namespace flotilla
