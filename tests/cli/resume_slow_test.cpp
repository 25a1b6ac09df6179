// SPDX-License-Identifier: MIT
// kill -9 at 50 random moments of a run of 252 bodies (G3 across interruptions).
#include <cstdio>

#include "cli/killed_runs.hpp"

namespace flotilla::test {
namespace {

TEST(KilledRunsSlow, ResumeToTheSameBits) {
    const KilledRuns r = kill_and_resume(252, 70, 50);
    std::printf("%d kills: %d resumed runs differ, %d failed\n", r.kills, r.different, r.failed);
    EXPECT_EQ(r.kills, 50);
    EXPECT_EQ(r.different, 0);
    EXPECT_EQ(r.failed, 0);
}

} // namespace
} // namespace flotilla::test
