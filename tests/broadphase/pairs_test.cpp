// SPDX-License-Identifier: MIT
// Candidate pairs from the grid, and brought up to date after some bodies moved: those of a loop over all pairs.
#include "broadphase/pairs.hpp"

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

TEST(Broadphase, FindsThePairsOfALoopOverAll) {
    for (const int threads : {1, 3})
        for (unsigned seed = 0; seed < 20; ++seed) {
            Team team({threads, false});
            const auto bodies = RandomBodies(seed).bodies(seed == 0 ? 0 : 50 * seed);
            Broadphase broadphase;
            EXPECT_EQ(broadphase.find(team, bodies), by_all_pairs(bodies)) << seed;
        }
}

TEST(Broadphase, AnUpdateGivesWhatANewSearchWould) {
    for (const int threads : {1, 3}) {
        Team team({threads, false});
        RandomBodies random(7);
        auto bodies = random.bodies(600);
        Broadphase broadphase;
        broadphase.find(team, bodies);
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
            ASSERT_EQ(broadphase.update(team, bodies, changed), expected) << n;
            if (expected != before) ++pairs_changed;
            before = expected;
        }
        EXPECT_GE(pairs_changed, 50u);
        EXPECT_GE(before.size(), 500u);
        EXPECT_EQ(broadphase.find(team, bodies), before); // nothing of the updates stays
    }
}

} // namespace
} // namespace flotilla
