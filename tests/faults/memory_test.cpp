// SPDX-License-Identifier: MIT
// Memory that is refused, at limits from what the command needs to be loaded to what the run needs.
#include "faults/faulty_runs.hpp"
#include "support/sanitizers.hpp"

namespace flotilla::test {
namespace {

class RefusedMemory : public FaultyRuns {
  protected:
    void SetUp() override {
        if (kSanitized) GTEST_SKIP() << "a sanitizer's shadow needs more address space than any limit";
    }
    static std::string limit(int kilobytes) { return "ulimit -c 0; ulimit -v " + std::to_string(kilobytes); }
    static bool loads(int kilobytes) { return run_flotilla("--version", limit(kilobytes)).exit_code == 0; }
    bool suffices(int kilobytes) {
        const int code = run_flotilla(run_in("tried") + " --overwrite --threads 1", limit(kilobytes)).exit_code;
        return code == 0;
    }
    /// The least that does, to a megabyte, where more always does.
    template <class Enough>
    static int least(int low, Enough&& enough) {
        int high = 1 << 20;
        while (high - low > 1024) {
            const int middle = (low + high) / 2;
            (enough(middle) ? high : low) = middle;
        }
        return high;
    }
    static void expect_clear(const CommandOutput& r) {
        EXPECT_TRUE(r.exit_code == 0 || r.exit_code == 1) << r.exit_code << ": " << r.err;
        if (r.exit_code == 0) return;
        EXPECT_TRUE(r.err.find("not enough memory: the process may have ") != std::string::npos ||
                    r.err.find("pthread_create has failed") != std::string::npos)
            << r.err;
    }
};

TEST_F(RefusedMemory, IsNamedAndLosesNothing) {
    const int loaded = least(1024, loads), enough = least(loaded, [&](int kilobytes) { return suffices(kilobytes); });
    ASSERT_LT(enough, 1 << 19) << "a run of 14 boats needs " << enough << " kB";
    constexpr int kLimits = kAllFaults ? 80 : 8;
    int refused = 0;
    for (int k = 0; k < kLimits; ++k)
        for (const char* threads : {"1", "4"}) {
            const int kilobytes = loaded + (enough + 8192 - loaded) * k / kLimits;
            SCOPED_TRACE(std::to_string(kilobytes) + " kB, threads " + threads);
            const CommandOutput r = run_flotilla(run_in("run") + " --threads " + threads, limit(kilobytes));
            expect_clear(r);
            refused += r.exit_code != 0 ? 1 : 0;
            if (k % 4 == 0) expect_clear(run_flotilla("verify --quiet " + path("whole").string(), limit(kilobytes)));
            expect_goes_on("run");
        }
    EXPECT_GE(refused, kLimits / 2);
}

// The stacks of 200 threads do not fit; the run does without them.
TEST_F(RefusedMemory, ForThreadsCostsThreadsAlone) {
    const int enough = least(1024, [&](int kilobytes) { return suffices(kilobytes); });
    const CommandOutput r = run_flotilla(run_in("run") + " --threads 200", limit(enough + (64 << 10)));
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_TRUE(step_hashes(path("run")) == expected_);
}

} // namespace
} // namespace flotilla::test
