// SPDX-License-Identifier: MIT
// Signals at any moment of a run: from its start over steps and writes to its end and its audit.
#include <csignal>

#include <chrono>
#include <random>
#include <thread>

#include "faults/faulty_runs.hpp"

namespace flotilla::test {
namespace {

using Clock = std::chrono::steady_clock;

class Signals : public FaultyRuns {
  protected:
    [[nodiscard]] std::string options(const std::string& name) const { return run_in(name) + " --threads 2 --audit "; }
    static void sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }
};

// A stop is asked for, so the run leaves with a checkpoint; before it listens and when all is written the process just
// ends.
TEST_F(Signals, AtAnyMomentLeaveARunThatGoesOn) {
    const Clock::time_point start = Clock::now();
    EXPECT_EQ(run_flotilla(options("timed")).exit_code, 0);
    const double whole = std::chrono::duration<double>(Clock::now() - start).count();
    std::mt19937 random(1);
    int asked = 0;
    for (int k = 0; k < (kAllFaults ? 120 : 3); ++k)
        for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
            RunningFlotilla run(options("run"));
            sleep(whole * std::uniform_real_distribution(0.0, 1.05)(random));
            run.send(signal);
            const int code = run.wait();
            SCOPED_TRACE(testing::Message() << "signal " << signal << ": " << code << ", " << run.output());
            EXPECT_TRUE(code == 0 || code == 6 || code == -signal);
            EXPECT_FALSE(signal == SIGUSR1 && code == 6);
            if (code == 6) {
                ++asked;
                EXPECT_NE(run.output().find("--resume goes on"), std::string::npos);
            }
            expect_goes_on("run");
        }
    EXPECT_GE(asked, kAllFaults ? 40 : 1);
}

// As nohup asks for it.
TEST_F(Signals, ThatTheProcessIgnoresStaySo) {
    RunningFlotilla run("run " + scene_ + " --quiet --threads 1 --checkpoint-every 5 --steps 100000000 --output " +
                            path("run").string(),
                        "trap '' HUP");
    const auto wait_for = [&](const char* file) {
        for (int i = 0; i < 12000 && !std::filesystem::exists(path("run") / file); ++i) sleep(0.005);
        return std::filesystem::exists(path("run") / file);
    };
    ASSERT_TRUE(wait_for("frames-00000000-00000005.h5"));
    run.send(SIGHUP);
    EXPECT_TRUE(wait_for("frames-00000036-00000040.h5")) << "it goes on";
    run.send(SIGTERM);
    EXPECT_EQ(run.wait(), 6) << run.output();
    EXPECT_NE(run.output().find("(SIGTERM)"), std::string::npos) << run.output();
}

} // namespace
} // namespace flotilla::test
