// SPDX-License-Identifier: MIT
// A host that steps worlds inside a parallel region of OpenMP.
#include <omp.h>

#include "embedding/host.hpp"

namespace flotilla::host {
namespace {

/// Two threads of a region, each with a world of its own.
void step_in_region(const WorldOptions& options, std::vector<std::uint64_t> (&hashes)[2]) {
#pragma omp parallel for num_threads(2) schedule(static, 1)
    for (int which = 0; which < 2; ++which) hashes[which] = run(which, options);
}

/// The most threads beside those of the host's region.
int helpers_in_region(const WorldOptions& options) {
    std::atomic<int> there = 0;
#pragma omp parallel num_threads(2)
    ++there;
    EXPECT_EQ(there, 2);
    return most_threads(step_in_region, options);
}

TEST(HostWithOpenMP, WorldsInARegionTakeOneThreadEach) { EXPECT_EQ(helpers_in_region({}), 0); }

TEST(HostWithOpenMP, ANumberOfThreadsIsTakenAsFarAsRegionsMayNest) {
    WorldOptions two;
    two.threads = 2;
    omp_set_max_active_levels(1);
    EXPECT_EQ(helpers_in_region(two), 0);
    omp_set_max_active_levels(2);
    const int nested = helpers_in_region(two);
    omp_set_max_active_levels(1);
    EXPECT_GE(nested, 1); // that of one world, or of both at a time
    EXPECT_LE(nested, 4); // and one each that is ending: the runtime makes those of inner regions anew
}

TEST(HostWithOpenMP, OutsideOfARegionWorldsTakeItsThreads) {
    omp_set_num_threads(3);
    const auto one_by_one = [](const WorldOptions& options, std::vector<std::uint64_t>(&hashes)[2]) {
        for (const int which : {0, 1}) hashes[which] = run(which, options);
    };
    const int most = most_threads(one_by_one, {}); // fewer where the runtime kept one of an earlier region
    EXPECT_GE(most, 1);
    EXPECT_LE(most, 2);
}

} // namespace
} // namespace flotilla::host
