// SPDX-License-Identifier: MIT
// Files that may not grow, disks that are full at one write or another, folders that go away, and runs that want the
// same one.
#include <chrono>
#include <fstream>
#include <thread>

#include "faults/faulty_runs.hpp"
#include "support/small_disk.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

class Files : public FaultyRuns {
  protected:
    /// What cannot be written is named, with the system's reason.
    void expect_named(const CommandOutput& r, const char* reason) const {
        EXPECT_TRUE(r.exit_code == 0 || r.exit_code == 5) << r.exit_code << ": " << r.err;
        if (r.exit_code == 0) return;
        EXPECT_NE(r.err.find(folder_.path().string()), std::string::npos) << r.err;
        EXPECT_NE(r.err.find(reason), std::string::npos) << r.err;
    }
    [[nodiscard]] bool wait_for(const fs::path& file) const {
        for (int i = 0; i < 60000 / 5; ++i) {
            if (fs::exists(file)) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }
    [[nodiscard]] std::string endless(const std::string& name) const {
        return "run " + scene_ + " --quiet --threads 1 --checkpoint-every 5 --steps 100000000 --output " +
               path(name).string();
    }
};

TEST_F(Files, ThatMayNotGrowAreNamedAndCostNothingOlder) {
    int stopped = 0;
    const int step = kAllFaults ? 2 : 24; // blocks of 512 bytes
    for (int blocks = 2; blocks < 200; blocks += step) {
        SCOPED_TRACE(blocks);
        const CommandOutput r = run_flotilla(run_in("run") + " --threads 1", "ulimit -f " + std::to_string(blocks));
        expect_named(r, "File too large");
        stopped += r.exit_code == 5 ? 1 : 0;
        expect_goes_on("run");
    }
    EXPECT_GE(stopped, 3);
}

TEST_F(Files, OfTracesAndContactsThatMayNotGrowAreNamed) {
    const std::string with = " --trace " + path("t.json").string() + " --contacts " + path("c.csv").string();
    const CommandOutput r = run_flotilla(run_in("run") + " --threads 1" + with, "ulimit -f 40");
    EXPECT_EQ(r.exit_code, 5);
    expect_named(r, "File too large");
    EXPECT_FALSE(fs::exists(path("t.json"))) << "half a trace is none";
    EXPECT_FALSE(fs::exists(path("c.csv")));
    expect_goes_on("run");
}

TEST_F(Files, OnADiskThatIsFullAtAnyWriteCostNothingOlder) {
    int stopped = 0;
    const int step = kAllFaults ? 4 : 60; // kB
    for (int kilobytes = 4; kilobytes < 400; kilobytes += step) {
        SCOPED_TRACE(kilobytes);
        const SmallDisk disk(path("disk"), std::to_string(kilobytes) + "k");
        if (!disk.mounted())
            GTEST_SKIP() << "cannot mount a small file system here: the test of full disks is left out";
        const CommandOutput r = run_flotilla(run_in("disk/run") + " --threads 1");
        expect_named(r, "No space left on device");
        stopped += r.exit_code == 5 ? 1 : 0;
        fs::remove_all(path("run"));
        fs::create_directory(path("run"));
        if (fs::exists(path("disk/run"))) fs::copy(path("disk/run"), path("run"), fs::copy_options::recursive);
        expect_goes_on("run");
    }
    EXPECT_GE(stopped, 3);
}

TEST_F(Files, OfAFolderThatIsRemovedUnderARunEndIt) {
    RunningFlotilla run(endless("run"));
    ASSERT_TRUE(wait_for(path("run/frames-00000000-00000005.h5"))); // checkpoints come and go, frames stay
    std::error_code raced;                                          // with what the run writes meanwhile
    while (fs::exists(path("run"))) fs::remove_all(path("run"), raced);
    EXPECT_EQ(run.wait(), 5) << run.output();
    EXPECT_NE(run.output().find(path("run").string()), std::string::npos) << run.output();
    EXPECT_NE(run.output().find("No such file or directory"), std::string::npos) << run.output();
}

TEST_F(Files, OfAFolderThatIsMovedAwayStayWhole) {
    RunningFlotilla run(endless("moved"));
    ASSERT_TRUE(wait_for(path("moved/frames-00000000-00000005.h5")));
    fs::rename(path("moved"), path("elsewhere"));
    EXPECT_EQ(run.wait(), 5) << run.output();
    EXPECT_EQ(run_flotilla("verify --quiet " + path("elsewhere").string()).exit_code, 0);
    EXPECT_GE(step_hashes(path("elsewhere")).size(), 5u);
}

TEST_F(Files, OfARunUnderWayCanBeRead) {
    RunningFlotilla run(endless("run"));
    ASSERT_TRUE(wait_for(path("run/frames-00000000-00000005.h5")));
    for (int k = 0; k < (kAllFaults ? 40 : 4); ++k) {
        const CommandOutput verified = run_flotilla("verify --quiet " + path("run").string());
        EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
        EXPECT_EQ(run_flotilla("info " + path("run").string()).exit_code, 0);
    }
    run.send(SIGTERM);
    EXPECT_EQ(run.wait(), 6);
}

// Whoever comes second is told so, at whatever moment, and the first one's run is right.
TEST_F(Files, OfTwoRunsThatBeginAtOnceAreOneRuns) {
    for (int k = 0; k < (kAllFaults ? 40 : 4); ++k) {
        RunningFlotilla first(run_in("run") + " --threads 1"), second(run_in("run") + " --threads 2");
        const int a = first.wait(), b = second.wait();
        EXPECT_TRUE(a == 0 || b == 0) << first.output() << second.output();
        const int other = a == 0 ? b : a;
        EXPECT_TRUE(other == 5 || other == 2) << other << ": " << first.output() << second.output();
        EXPECT_TRUE(step_hashes(path("run")) == expected_);
        EXPECT_EQ(run_flotilla("verify --quiet " + path("run").string()).exit_code, 0);
        fs::remove_all(path("run"));
    }
}

} // namespace
} // namespace flotilla::test
