// SPDX-License-Identifier: MIT
// A hundred thousand edits.
#include "api/edited_runs.hpp"

namespace flotilla::test {
namespace {

TEST(EditedRunsSlow, KeepEveryPromiseThroughAHundredThousandEdits) {
    EditedRunCounts all;
    for (std::uint64_t seed = 100; seed < 120 && !HasFailure(); ++seed) {
        const EditedRunCounts counts = run_edited(seed, 5000, 1 + static_cast<int>(seed % 5));
        all.made += counts.made;
        all.refused += counts.refused;
    }
    EXPECT_GE(all.made + all.refused, 100000);
    std::printf("edits: %d made, %d refused\n", all.made, all.refused);
}

} // namespace
} // namespace flotilla::test
