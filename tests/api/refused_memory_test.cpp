// SPDX-License-Identifier: MIT
// Memory that operator new refuses at any moment of a step: the step throws, the World says that it is finished, and a
// snapshot taken before goes on with the right bits. This program replaces operator new.
#include <atomic>
#include <cstdlib>
#include <new>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

#include "parallel/team.hpp"

namespace {
std::atomic<long> allocations{0};
std::atomic<long> refused{-1}; // the number of the one that fails; < 0: none

void* allocate(std::size_t size, std::size_t alignment) {
    if (++allocations == refused) throw std::bad_alloc();
    void* const p = alignment == 0 ? std::malloc(size)
                                   : std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
} // namespace

void* operator new(std::size_t size) { return allocate(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return std::malloc(size); }
void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    const auto unit = static_cast<std::size_t>(alignment);
    return std::aligned_alloc(unit, (size + unit - 1) / unit * unit);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace flotilla {
namespace {

/// Refuses the n-th allocation from now on while it lives.
class Refusal {
  public:
    explicit Refusal(long n) { refused = allocations + n; }
    ~Refusal() { refused = -1; }
    Refusal(const Refusal&) = delete;
    Refusal& operator=(const Refusal&) = delete;
};

SceneDescription scene() {
    SceneDescription s = make_scene("boats-in-bowl", 16, 2);
    s.settings.dynamic_pair_iterations = 1; // clusters too
    s.settings.collision_iterations = 2;
    return s;
}

TEST(RefusedMemory, InAStepFinishesTheWorld) {
    for (const int threads : {1, 3}) {
        World before(scene(), "scene", {threads});
        for (int i = 0; i < 30; ++i) (void)before.step();
        const std::vector<std::byte> snapshot = before.snapshot();
        const long start = allocations;
        const std::uint64_t expected = World(scene(), snapshot, "scene", {threads}).step().state_hash;
        const long count = allocations - start; // those of the construction come first
        int failed = 0;
        for (long n = 1; n < count; n += 1 + count / 120) {
            std::optional<World> world(std::in_place, scene(), snapshot, "scene", WorldOptions{threads});
            try {
                const Refusal refusal(n);
                EXPECT_EQ(world->step().state_hash, expected);
                continue;
            } catch (const std::bad_alloc&) {
                ++failed;
            }
            EXPECT_THROW((void)world->step(), Error);
            EXPECT_THROW((void)world->snapshot(), Error);
            EXPECT_EQ(world->size(), 16u);
            world.emplace(scene(), snapshot, "scene", WorldOptions{threads});
            EXPECT_EQ(world->step().state_hash, expected) << n;
        }
        std::printf("%d threads: %d steps failed\n", threads, failed);
        EXPECT_GE(failed, 10);
    }
}

TEST(RefusedMemory, WhileAWorldIsMadeLeavesNone) {
    const long start = allocations;
    const std::uint64_t expected = World(scene(), "scene", {2}).state_hash();
    const long count = allocations - start;
    int failed = 0;
    for (long n = 1; n < count; n += 1 + count / 120) {
        try {
            const Refusal refusal(n);
            EXPECT_EQ(World(scene(), "scene", {2}).state_hash(), expected);
        } catch (const std::bad_alloc&) {
            ++failed;
        }
    }
    EXPECT_GE(failed, 20);
    EXPECT_EQ(World(scene(), "scene", {2}).state_hash(), expected);
}

// A refusal there would come out of a thread that nobody listens to.
TEST(RefusedMemory, TeamsThatHandOutOrderedTasksAskForNone) {
    constexpr std::size_t kTasks = 1 << 12;
    TaskOrder tree; // every task makes two ready
    tree.start(0);
    tree.resize(kTasks);
    const auto number = [](std::size_t task) { return task < kTasks ? static_cast<std::int32_t>(task) : -1; };
    for (std::size_t i = 0; i < kTasks; ++i) tree.set(i, {number(2 * i + 1), number(2 * i + 2)}, i > 0 ? 1 : 0);
    Team one;
    std::vector<std::size_t> places;
    tree.list_first(one, places);
    for (const int threads : {2, 3, 8}) {
        Team team({.threads = threads, .crowds = true});
        std::atomic<std::size_t> done = 0;
        long before = 0;
        team.region([&] {
            team.run("test", tree, [&](std::size_t i, int) {
                if (i == 0) before = allocations; // the first: all others wait for it
                ++done;
            });
            EXPECT_EQ(allocations, before);
        });
        EXPECT_EQ(done, kTasks);
    }
}

} // namespace
} // namespace flotilla
