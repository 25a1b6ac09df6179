// SPDX-License-Identifier: MIT
// Clocks decide nothing but when a checkpoint is written and how long a thread waits before it sleeps.
#include <fstream>
#include <iterator>
#include <set>

#include "faults/faulty_runs.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

using Clocks = FaultyRuns;

TEST_F(Clocks, ThatJumpChangeNoBit) {
    for (const char* threads : {"1", "3"}) {
        const CommandOutput r = run_flotilla(run_in("run") + " --threads " + threads,
                                             "export LD_PRELOAD=" + std::string(FLOTILLA_CLOCK_JUMPER));
        EXPECT_EQ(r.exit_code, 0) << r.err;
        EXPECT_TRUE(step_hashes(path("run")) == expected_);
        EXPECT_EQ(run_flotilla("verify --quiet " + path("run").string()).exit_code, 0);
        fs::remove_all(path("run"));
    }
}

TEST_F(Clocks, AJumpEndsARunWithALimitOfTimeInOrder) {
    const CommandOutput r = run_flotilla(run_in("run") + " --threads 1 --time-limit 12:0:0",
                                         "export LD_PRELOAD=" + std::string(FLOTILLA_CLOCK_JUMPER));
    EXPECT_TRUE(r.exit_code == 0 || r.exit_code == 6) << r.exit_code << r.err;
    expect_goes_on("run");
}

std::string text_of(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
}

// The time of day is written into run.json, once; nothing else reads a clock that can be set.
TEST(Sources, ReadTheTimeOfDayForTheRecordAlone) {
    std::set<std::string> readers;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(FLOTILLA_SOURCE_DIR) / "src")) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
        const std::string text = text_of(entry.path());
        for (const char* clock :
             {"system_clock", "high_resolution_clock", "gettimeofday", "std::time(", "CLOCK_REALTIME"})
            if (text.find(clock) != std::string::npos) readers.insert(entry.path().filename().string() + ": " + clock);
    }
    EXPECT_EQ(readers, std::set<std::string>{"run_files.cpp: system_clock"});
}

} // namespace
} // namespace flotilla::test
