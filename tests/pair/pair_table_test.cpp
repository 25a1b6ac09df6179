// SPDX-License-Identifier: MIT
#include "pair/pair_table.hpp"

#include <atomic>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

using Key = std::pair<std::int32_t, std::int32_t>;

const int kTeams[] = {1, 2, 3, 8};

Model spheres(std::int32_t num) {
    Model model;
    model.bodies.resize(static_cast<std::size_t>(num));
    for (std::size_t i = 0; i < model.bodies.size(); ++i)
        model.bodies[i].size = model.bodies[i].extent = 1.0 + static_cast<double>(i);
    return model;
}

std::vector<Key> all_pairs(std::int32_t num_bodies) {
    std::vector<Key> pairs;
    for (std::int32_t a = 0; a < num_bodies; ++a)
        for (std::int32_t b = a + 1; b < num_bodies; ++b) pairs.emplace_back(a, b);
    return pairs;
}

/// A table of the pairs of `num` bodies.
struct World {
    explicit World(std::int32_t num) : model(spheres(num)) {}
    PairRecord& get(const Key& key) { return table.get(model, state, key.first, key.second); }
    [[nodiscard]] PairRecord* find(const Key& key) { return table.find(key.first, key.second); }
    [[nodiscard]] const PairRecord* find(const Key& key) const { return table.find(key.first, key.second); }

    Model model;
    State state;
    PairTable table;
};

/// The same pairs in a map, every operation in a plain loop.
class Reference {
  public:
    struct Record {
        std::int64_t step = 0;
        bool active = false, processed = false;
        double start_distance = -1, end_distance = -1;
        Verdict verdict = Verdict::open;
        std::uint64_t version = 0; ///< of both bodies
        const PairRecord* place = nullptr;
    };

    void start_step(std::int64_t step) {
        std::erase_if(records_, [&](const auto& entry) { return entry.second.step != step_; });
        for (auto& [key, r] : records_) {
            r.active = r.processed = false;
            r.start_distance = std::exchange(r.end_distance, -1.0);
        }
        step_ = step;
    }
    Record& use(const Key& key) {
        Record& r = records_[key];
        r.step = step_;
        return r;
    }
    [[nodiscard]] const Record* find(const Key& key) const {
        const auto it = records_.find(key);
        return it == records_.end() ? nullptr : &it->second;
    }
    [[nodiscard]] std::size_t size() const { return records_.size(); }

  private:
    std::map<Key, Record> records_;
    std::int64_t step_ = 0;
};

void expect_same(const World& world, const Reference& reference, const std::vector<Key>& keys) {
    for (const Key& key : keys) {
        const PairRecord* r = world.find(key);
        const Reference::Record* wanted = reference.find(key);
        ASSERT_EQ(r != nullptr, wanted != nullptr) << key.first << ", " << key.second;
        if (r == nullptr) continue;
        ASSERT_EQ(r, wanted->place) << "a record stays where it is";
        ASSERT_EQ(Key(r->a, r->b), key);
        ASSERT_EQ(r->active, wanted->active);
        ASSERT_EQ(bool{r->processed}, wanted->processed);
        ASSERT_EQ(r->cache.start_distance, wanted->start_distance);
        ASSERT_EQ(r->cache.end_distance, wanted->end_distance);
        ASSERT_EQ(r->verdict.at(wanted->version, wanted->version), wanted->verdict);
    }
}

/// Records of many pairs at once are those of one after the other.
void expect_found_together(World& world, const std::vector<Key>& keys) {
    std::vector<CandidatePair> pairs;
    for (const Key& key : keys) pairs.push_back({key.first, key.second});
    std::vector<PairRecord*> found(pairs.size(), nullptr);
    world.table.find(pairs, found);
    for (std::size_t i = 0; i < keys.size(); ++i) EXPECT_EQ(found[i], world.find(keys[i]));
}

/// What the stages of a step do with a pair, at random.
void touch(World& world, Reference& reference, const Key& key, std::mt19937_64& rng) {
    PairRecord* found = world.find(key);
    if (found != nullptr && rng() % 2 == 0)
        world.table.use(*found);
    else
        found = &world.get(key);
    Reference::Record& wanted = reference.use(key);
    if (wanted.place == nullptr) {
        EXPECT_EQ(found->verdict.at(0, 0), Verdict::open)
            << "a record of a pair seen first knows nothing of the one before in its place";
        EXPECT_EQ(found->cache.start_distance, -1);
        wanted.place = found;
    }
    if (rng() % 2 == 0) found->active = wanted.active = true;
    if (rng() % 2 == 0) found->processed.set(), wanted.processed = true;
    if (rng() % 2 == 0) found->cache.end_distance = wanted.end_distance = static_cast<double>(rng() % 100);
    if (rng() % 2 == 0) {
        wanted.version = rng();
        wanted.verdict = rng() % 2 == 0 ? Verdict::settled : Verdict::apart;
        found->verdict.commit(wanted.verdict, wanted.version, wanted.version);
    }
}

TEST(PairTable, DoesAsAMapAndAPlainLoop) {
    const std::vector<Key> keys = all_pairs(80); // 3,160 records: several chunks of a parallel loop
    for (const int threads : kTeams) {
        SCOPED_TRACE(threads);
        std::mt19937_64 rng(7);
        Team team({threads});
        World world(80);
        Reference reference;
        // Of 16 pairs so many are used: many and few, all, none, and again.
        const std::uint64_t shares[] = {8, 15, 1, 0, 16, 16, 2, 0, 0, 12, 4, 16};
        std::int64_t step = 0;
        for (const std::uint64_t share : shares) {
            world.table.start_step(team, ++step);
            reference.start_step(step);
            expect_same(world, reference, keys);
            for (const Key& key : keys)
                if (rng() % 16 < share) touch(world, reference, key, rng);
            expect_same(world, reference, keys);
            expect_found_together(world, keys);
        }
        EXPECT_EQ(reference.size(), keys.size());
    }
}

TEST(PairTable, AnEmptyTableFindsNothing) {
    for (const int threads : kTeams) {
        Team team({threads});
        World world(3);
        EXPECT_EQ(world.find({0, 1}), nullptr);
        world.table.start_step(team, 1);
        EXPECT_EQ(world.find({0, 1}), nullptr);
        world.table.clear();
        EXPECT_EQ(world.find({0, 1}), nullptr);
        const PairRecord& made = world.get({0, 1});
        EXPECT_EQ(world.find({0, 1}), &made);
        EXPECT_EQ(world.find({1, 2}), nullptr);
        EXPECT_EQ(world.find({1, 0}), nullptr) << "a pair is (a, b) and nothing else";
    }
}

TEST(PairTable, RecordsStayWhereTheyAreWhileItGrows) {
    const std::vector<Key> keys = all_pairs(400); // 79,800
    World world(400);
    std::vector<PairRecord*> made;
    for (const Key& key : keys) made.push_back(&world.get(key));
    for (const int threads : kTeams) {
        Team team({threads});
        std::atomic<int> wrong = 0;
        team.for_each("test", keys.size(), 512, [&](std::size_t i, int) { wrong += world.find(keys[i]) != made[i]; });
        EXPECT_EQ(wrong, 0) << threads;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) ASSERT_EQ(&world.get(keys[i]), made[i]);
}

TEST(PairTable, AStepForgetsWhatTheLastOneDidNotUse) {
    const std::vector<Key> keys = all_pairs(200); // 19,900
    for (const int threads : kTeams) {
        SCOPED_TRACE(threads);
        Team team({threads});
        World world(200);
        world.table.start_step(team, 1);
        for (const Key& key : keys) world.get(key);
        world.table.start_step(team, 2);
        for (const Key& key : keys) ASSERT_NE(world.find(key), nullptr) << "step 1 used all";
        for (const Key& key : keys)
            if (key.second % 3 == 0) world.table.use(*world.find(key));
        world.table.start_step(team, 3);
        for (const Key& key : keys) ASSERT_EQ(world.find(key) != nullptr, key.second % 3 == 0);
        world.table.start_step(team, 4);
        for (const Key& key : keys) ASSERT_EQ(world.find(key), nullptr) << "to find a pair is not to use it";
    }
}

TEST(PairTable, AForgottenPairIsMadeAnewFromTheStateOfTheDay) {
    Team team({2});
    World world(3);
    const PairLengths before = world.get({0, 2}).lengths;
    EXPECT_GT(before.rest, 0);
    world.get({0, 2}).cache.candidates = std::make_unique<PairCandidates>();
    world.state.rest_distances = {{0, 2, before.rest / 4}};
    EXPECT_EQ(world.get({0, 2}).lengths.rest, before.rest) << "the record of the first use";
    world.table.start_step(team, 1);
    world.table.start_step(team, 2);
    const PairRecord& again = world.get({0, 2});
    EXPECT_EQ(again.lengths.rest, before.rest / 4);
    EXPECT_EQ(again.cache.candidates, nullptr);
    EXPECT_EQ(again.step, 2);
}

TEST(PairTable, ClearingForgetsEverything) {
    const std::vector<Key> keys = all_pairs(100);
    Team team({3});
    World world(100);
    world.table.start_step(team, 1);
    for (const Key& key : keys) world.get(key).active = true;
    world.table.start_step(team, 2);
    world.table.start_step(team, 3); // all places are free now
    for (const Key& key : keys) world.get(key).active = true;
    world.table.clear();
    for (const Key& key : keys) ASSERT_EQ(world.find(key), nullptr);
    for (const Key& key : keys) ASSERT_FALSE(world.get(key).active);
    for (const Key& key : keys) ASSERT_NE(world.find(key), nullptr);
}

} // namespace
} // namespace flotilla
