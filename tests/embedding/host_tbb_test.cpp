// SPDX-License-Identifier: MIT
// A host that steps worlds in tasks of oneTBB.
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "embedding/host.hpp"

namespace flotilla::host {
namespace {

/// Two tasks in an arena of two threads, each with a world.
void step_in_tasks(const WorldOptions& options, std::vector<std::uint64_t> (&hashes)[2]) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
    tbb::task_arena arena(2);
    const auto some = [&](const tbb::blocked_range<int>& range) {
        for (int which = range.begin(); which < range.end(); ++which) hashes[which] = run(which, options);
    };
    arena.execute([&] { tbb::parallel_for(tbb::blocked_range<int>(0, 2, 1), some, tbb::simple_partitioner()); });
}

TEST(HostWithTbb, WorldsInTasksTakeOneThreadEach) {
    EXPECT_LE(most_threads(step_in_tasks, {}), 1) << "beside the caller's: the arena's worker";
}

TEST(HostWithTbb, ANumberOfThreadsIsTakenAsItIs) {
    WorldOptions two;
    two.threads = 2;
    const int most = most_threads(step_in_tasks, two);
    EXPECT_GE(most, 1);     // one task after the other, where the worker came late
    EXPECT_LE(most, 1 + 2); // a helper each
}

} // namespace
} // namespace flotilla::host
