// SPDX-License-Identifier: MIT
// What the host programs have in common: two worlds, their hashes when stepped alone, and a count of the process's
// threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

namespace flotilla::host {

inline constexpr int kSteps = 40;

/// Boats that meet on their way into the bowl; 0 and 1 are different scenes.
inline SceneDescription scene(int which) {
    return make_scene("boats-in-bowl", 22, static_cast<std::uint64_t>(1 + which));
}

/// The state hashes of all steps.
inline std::vector<std::uint64_t> run(int which, const WorldOptions& options) {
    World world(scene(which), "scene", options);
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < kSteps; ++i) hashes.push_back(world.step().state_hash);
    return hashes;
}

/// Of both worlds, one after the other in plain loops.
inline const std::vector<std::uint64_t>& expected(int which) {
    static const std::vector<std::uint64_t> all[] = {run(0, {1, Executor::serial}), run(1, {1, Executor::serial})};
    return all[which];
}

/// The threads that the process has now.
inline int num_threads() {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

/// Looks again and again how many threads the process has, until most() is asked. The threads that were there at first
/// and its own do not count.
class ThreadWatch {
  public:
    ThreadWatch()
        : before_(num_threads() + 1), watch_([this] {
              while (!done_) {
                  most_ = std::max(most_, num_threads());
                  std::this_thread::sleep_for(std::chrono::microseconds(200));
              }
          }) {}

    /// The most threads that there were beside those.
    [[nodiscard]] int most() {
        done_ = true;
        watch_.join();
        return most_ - before_;
    }

  private:
    int before_, most_ = 0;
    std::atomic<bool> done_ = false;
    std::thread watch_;
};

/// The work of a host that steps both worlds side by side with these options.
using HostRun = std::function<void(const WorldOptions&, std::vector<std::uint64_t> (&hashes)[2])>;

/// Checks the bits; returns the most threads that the process had beside those before.
inline int most_threads(const HostRun& host, const WorldOptions& options) {
    for (const int which : {0, 1}) (void)expected(which); // what is made on the way there, is there
    std::vector<std::uint64_t> hashes[2];
    ThreadWatch watch;
    host(options, hashes);
    const int most = watch.most();
    for (const int which : {0, 1}) EXPECT_EQ(hashes[which], expected(which)) << which;
    return most;
}

} // namespace flotilla::host
