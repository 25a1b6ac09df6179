// SPDX-License-Identifier: MIT
// A host that steps worlds on threads of its own.
#include <thread>

#include "embedding/host.hpp"

namespace flotilla::host {
namespace {

void step_on_threads(const WorldOptions& options, std::vector<std::uint64_t> (&hashes)[2]) {
    std::thread first([&] { hashes[0] = run(0, options); }), second([&] { hashes[1] = run(1, options); });
    first.join();
    second.join();
}

TEST(HostWithThreads, OneThreadMeansTheCallersOwn) {
    WorldOptions one;
    one.threads = 1;
    EXPECT_EQ(most_threads(step_on_threads, one), 2);
}

TEST(HostWithThreads, WorldsTakeWhatTheyAreGranted) {
    WorldOptions three;
    three.threads = 3;
    const int most = most_threads(step_on_threads, three);
    EXPECT_GE(most, 2 + 2); // helpers of one, or of both at a time
    EXPECT_LE(most, 2 * 3);
}

TEST(HostWithThreads, WithoutANumberTheyShareTheCores) { (void)most_threads(step_on_threads, {}); }

} // namespace
} // namespace flotilla::host
