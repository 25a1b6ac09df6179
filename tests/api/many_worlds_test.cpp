// SPDX-License-Identifier: MIT
// Worlds by the thousand, one after another, many at once, and on threads that come and go: neither memory nor threads
// pile up.
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

#include "embedding/host.hpp"
#include "step/scene_parts.hpp"
#include "support/sanitizers.hpp"

namespace flotilla {
namespace {

/// kB that the process has resident.
long resident() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
    return -1;
}

/// Two bodies that meet.
SceneDescription two_bodies() {
    SceneDescription scene = scenario::empty_scene();
    const std::int32_t shape = scenario::add_shape(scene, scenario::make_octahedron(0.5), 1);
    scenario::add_body(scene, shape, BodyType::dynamic, {});
    scenario::add_body(scene, shape, BodyType::dynamic, {0, 0, 1.02}).velocity = {0, 0, -5};
    return scene;
}

TEST(ManyWorlds, OneAfterAnotherLeaveNothingBehind) {
    constexpr int kWorlds = 10000, kFirst = 1000;
    const SceneDescription scene = two_bodies();
    long memory = 0;
    int threads = 0;
    std::uint64_t hash = 0;
    for (int k = 0; k < kWorlds; ++k) {
        World world(scene, "scene", {k % 8 == 0 ? 3 : 1});
        const std::uint64_t now = world.step().state_hash;
        if (k == 0) hash = now;
        ASSERT_EQ(now, hash) << k;
        if (k > kFirst) continue;
        memory = resident();
        threads = std::max(threads, host::num_threads());
    }
    if (!test::kSanitized) {
        EXPECT_LE(resident(), memory + 2048) << "kB, after the first " << kFirst;
    }
    EXPECT_LE(host::num_threads(), threads);
}

TEST(ManyWorlds, AtOnceDoNotDisturbEachOther) {
    constexpr std::size_t kWorlds = 60;
    std::vector<World> worlds;
    for (std::size_t k = 0; k < kWorlds; ++k)
        worlds.emplace_back(host::scene(static_cast<int>(k % 2)), "scene", WorldOptions{1 + static_cast<int>(k % 3)});
    for (std::size_t step = 0; step < 10; ++step)
        for (std::size_t k = 0; k < kWorlds; ++k) {
            const std::size_t w = (7 * k + step) % kWorlds; // in another order each time
            ASSERT_EQ(worlds[w].step().state_hash, host::expected(static_cast<int>(w % 2))[step]);
        }
    std::vector<World> moved = std::move(worlds);
    moved[0] = std::move(moved[1]);
    moved.erase(moved.begin() + 1);
    EXPECT_EQ(moved[0].step().state_hash, host::expected(1)[10]);
}

TEST(ManyWorlds, OnThreadsThatEndTakeTheirHelpersAlong) {
    const SceneDescription scene = two_bodies();
    const auto on_own_thread = [&] {
        std::thread([&] {
            World world(scene, "scene", {3});
            for (int i = 0; i < 3; ++i) (void)world.step();
        }).join();
    };
    for (int k = 0; k < 20; ++k) on_own_thread();
    const int threads = host::num_threads();
    const long memory = resident();
    for (int k = 0; k < 300; ++k) on_own_thread();
    EXPECT_LE(host::num_threads(), threads + 3) << "some may be on their way out";
    if (!test::kSanitized) {
        EXPECT_LE(resident(), memory + 4096);
    }
}

} // namespace
} // namespace flotilla
