// SPDX-License-Identifier: MIT
// A hundred thousand edits.
#include "run/edited_runs.hpp"

namespace flotilla::test {
namespace {

TEST(EditedRunsSlow, KeepEveryPromiseThroughAHundredThousandEdits) {
    EditedRunCounts all;
    for (std::uint64_t seed = 100; seed < 120 && !HasFailure(); ++seed) {
        const EditedRunCounts counts = run_edited(seed, 5000, 1 + static_cast<int>(seed % 5));
        all.made += counts.made;
        all.refused += counts.refused;
        all.steps += counts.steps;
        all.balanced += counts.balanced;
    }
    EXPECT_GE(all.made + all.refused, 100000);
    EXPECT_GE(2 * all.balanced, all.steps - 10) << "steps whose energy was bounded";
    std::printf("edits: %d made, %d refused; %d of %d steps balanced\n", all.made, all.refused, all.balanced,
                all.steps);
}

} // namespace
} // namespace flotilla::test
