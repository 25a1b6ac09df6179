// SPDX-License-Identifier: MIT
// Candidate pairs from the grids and from a list that is kept, and brought up to date after some bodies moved: those of
// a loop over all.
#include "broadphase/kept_pairs.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

class RandomBodies {
  public:
    explicit RandomBodies(unsigned seed) : random_(seed) {}

    /// Mostly of size 1 in a cube of edge 12; some large ones, some that cannot move, some far away.
    SweptBody body() {
        const double kind = uniform(0, 1), size = kind < 0.02 ? 9 : uniform(0.2, 1.5);
        const double far = kind > 0.99 ? 1e7 : 0;
        const Vec3 low{uniform(0, 12) + far, uniform(0, 12), uniform(0, 12)};
        return {{low, low + Vec3{size, size * uniform(0, 1), size}}, uniform(0, 0.1), kind > 0.04};
    }
    std::vector<SweptBody> bodies(std::size_t n) {
        std::vector<SweptBody> out(n);
        for (SweptBody& b : out) b = body();
        return out;
    }
    double uniform(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }

  private:
    std::mt19937_64 random_;
};

std::vector<CandidatePair> by_all_pairs(const std::vector<SweptBody>& bodies) {
    std::vector<CandidatePair> out;
    for (std::size_t a = 0; a < bodies.size(); ++a)
        for (std::size_t b = a + 1; b < bodies.size(); ++b)
            if ((bodies[a].movable || bodies[b].movable) &&
                boxes_overlap(bodies[a].box, bodies[b].box, bodies[a].reach + bodies[b].reach))
                out.push_back({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)});
    return out;
}

template <class Finder>
class Pairs : public ::testing::Test {};
using Finders = ::testing::Types<Broadphase, KeptPairs>;
TYPED_TEST_SUITE(Pairs, Finders);

std::vector<std::int32_t> all_of(const std::vector<SweptBody>& bodies) {
    std::vector<std::int32_t> out(bodies.size());
    std::iota(out.begin(), out.end(), 0);
    return out;
}

TYPED_TEST(Pairs, AreThoseOfALoopOverAll) {
    for (const int threads : {1, 3})
        for (unsigned seed = 0; seed < 20; ++seed) {
            Team team({threads, false});
            const auto bodies = RandomBodies(seed).bodies(seed == 0 ? 0 : 50 * seed);
            TypeParam broadphase;
            EXPECT_EQ(broadphase.find(team, {bodies, all_of(bodies)}), by_all_pairs(bodies)) << seed;
        }
}

/// Of bodies that stand still some sleep: those are movable, with a reach of their own, where the search wakes.
std::vector<CandidatePair> by_all_pairs(const PairSearch& search) {
    std::vector<SweptBody> bodies(search.bodies.begin(), search.bodies.end());
    const auto active = [&](std::int32_t i) {
        return std::binary_search(search.active.begin(), search.active.end(), i);
    };
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (active(static_cast<std::int32_t>(i))) continue;
        bodies[i].movable = search.wakes && bodies[i].waking_reach > 0;
        bodies[i].reach = search.wakes ? bodies[i].waking_reach : 0;
    }
    std::vector<CandidatePair> out = by_all_pairs(bodies);
    std::erase_if(out, [&](const CandidatePair& p) { return !active(p.a) && !active(p.b); });
    return out;
}

TYPED_TEST(Pairs, OfBodiesThatStandStillAreThoseOfALoopOverAll) {
    std::size_t pairs = 0, woken = 0;
    for (const int threads : {1, 3}) {
        Team team({threads, false});
        RandomBodies random(11);
        auto bodies = random.bodies(500);
        std::vector<std::int32_t> active;
        TypeParam broadphase;
        for (std::uint64_t version = 0; version < 12; ++version) { // others stand still, elsewhere
            active.clear();
            for (std::size_t i = 0; i < bodies.size(); ++i) {
                bodies[i].waking_reach = 0;
                if (random.uniform(0, 1) < (version % 4 == 3 ? 0.0 : 0.3)) {
                    active.push_back(static_cast<std::int32_t>(i));
                    continue;
                }
                bodies[i] = random.body();
                const bool sleeps = bodies[i].movable;
                bodies[i].movable = false;
                bodies[i].waking_reach = sleeps ? bodies[i].reach : 0.0;
                bodies[i].reach = 0;
            }
            for (int n = 0; n < 4; ++n) {
                for (const std::int32_t i : active) bodies[static_cast<std::size_t>(i)] = random.body();
                const PairSearch search{bodies, active, version, n % 2 == 1};
                const auto expected = by_all_pairs(search);
                ASSERT_EQ(broadphase.find(team, search), expected) << version << ' ' << n;
                (search.wakes ? woken : pairs) += expected.size();
                if (active.empty()) continue;
                const std::vector<std::int32_t> changed{active[active.size() / 3], active.back()};
                for (const std::int32_t i : changed) bodies[static_cast<std::size_t>(i)] = random.body();
                ASSERT_EQ(broadphase.update(team, search, changed), by_all_pairs(search)) << version << ' ' << n;
            }
        }
    }
    EXPECT_GT(pairs, 1000u);
    EXPECT_GT(woken, pairs); // sleeping bodies pair with scripted ones as well
}

TYPED_TEST(Pairs, OfAnUpdateAreThoseOfANewSearch) {
    for (const int threads : {1, 3}) {
        Team team({threads, false});
        RandomBodies random(7);
        auto bodies = random.bodies(600);
        TypeParam broadphase;
        const std::vector<std::int32_t> all = all_of(bodies);
        broadphase.find(team, {bodies, all});
        std::size_t pairs_changed = 0;
        std::vector<CandidatePair> before = by_all_pairs(bodies);
        for (int n = 0; n < 60; ++n) {
            std::vector<std::int32_t> changed;
            for (std::size_t i = 0; i < bodies.size(); ++i)
                if (random.uniform(0, 1) < (n % 3 == 0 ? 0.3 : 0.01)) {
                    bodies[i] = random.body();
                    changed.push_back(static_cast<std::int32_t>(i));
                }
            const auto expected = by_all_pairs(bodies);
            ASSERT_EQ(broadphase.update(team, {bodies, all}, changed), expected) << n;
            if (expected != before) ++pairs_changed;
            before = expected;
        }
        EXPECT_GE(pairs_changed, 50u);
        EXPECT_GE(before.size(), 500u);
        EXPECT_EQ(broadphase.find(team, {bodies, all}), before); // nothing of the updates stays
    }
}

/// Boxes creep, jump, change size and become movable or not, their reaches change from search to search.
TYPED_TEST(Pairs, OfBodiesThatCreepAreThoseOfALoopOverAll) {
    for (const int threads : {1, 3}) {
        Team team({threads, false});
        RandomBodies random(5);
        auto bodies = random.bodies(400);
        TypeParam broadphase;
        const std::vector<std::int32_t> all = all_of(bodies);
        std::size_t pairs_changed = 0;
        std::vector<CandidatePair> before;
        for (int n = 0; n < 200; ++n) {
            for (SweptBody& b : bodies) {
                const double most = n % 50 == 20 ? 0.3 : 0.004;
                const Vec3 way{random.uniform(-most, most), random.uniform(-most, most), random.uniform(-most, most)};
                b.box = {b.box.lower + way, b.box.upper + 1.2 * way};
                b.reach = random.uniform(0, 0.1);
                if (random.uniform(0, 1) < 0.0005) b = random.body();
                if (random.uniform(0, 1) < 0.0005) b.movable = !b.movable;
            }
            const auto expected = by_all_pairs(bodies);
            ASSERT_EQ(broadphase.find(team, {bodies, all}), expected) << n;
            if (expected != before) ++pairs_changed;
            before = expected;
        }
        EXPECT_GE(pairs_changed, 150u);
    }
}

} // namespace
} // namespace flotilla
