// SPDX-License-Identifier: MIT
// flotilla run with threads, executors and instruction sets: the same steps.csv, hashes and all but times.
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/step_hashes.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

class RunThreads : public testing::Test {
  protected:
    RunThreads() {
        std::ofstream scene(folder_.path() / "boats.json");
        scene << run_flotilla("scene boats-in-bowl --bodies 12 --seed 3").out;
    }

    /// Runs with the options and returns the hashes of its steps.
    std::vector<std::string> run(const std::string& options) {
        const std::string output = (folder_.path() / "run").string();
        const CommandOutput r = run_flotilla("run " + (folder_.path() / "boats.json").string() +
                                             " --steps 30 --overwrite --output " + output + " " + options);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        last_ = r.out;
        return step_hashes(output);
    }

    TemporaryFolder folder_;
    std::string last_;
};

TEST_F(RunThreads, ChangeNoBit) {
    const auto expected = run("--executor serial");
    ASSERT_EQ(expected.size(), 30u);
    EXPECT_EQ(last_.find("waiting"), std::string::npos);
    for (const char* options : {"--threads 1", "--threads 2", "--threads 5", "--executor serial --threads 2"})
        EXPECT_EQ(run(options), expected) << options;
    EXPECT_EQ(run("--threads 3"), expected);
    EXPECT_NE(last_.find("waiting, ms"), std::string::npos) << last_;
}

TEST_F(RunThreads, OpenMPSetsTheirNumberAndBindsThem) {
    const auto expected = run("--executor serial");
    setenv("OMP_NUM_THREADS", "3", 1);
    setenv("OMP_PROC_BIND", "true", 1);
    EXPECT_EQ(run(""), expected);
    unsetenv("OMP_NUM_THREADS");
    unsetenv("OMP_PROC_BIND");
    EXPECT_NE(last_.find("\n     2 "), std::string::npos) << last_;
    EXPECT_EQ(last_.find("\n     3 "), std::string::npos) << last_;
    const CommandOutput pinned = run_flotilla("run none.json --pin");
    EXPECT_EQ(pinned.exit_code, 2);
    EXPECT_NE(pinned.err.find("OMP_PROC_BIND"), std::string::npos) << pinned.err;
}

TEST_F(RunThreads, PeakMemoryIsOfTheRunAlone) {
    const std::vector<char> ours(std::size_t{400} << 20, 1); // what a child inherits counts in getrusage()
    run("");
    const std::string key = "peak memory: ";
    const std::size_t at = last_.find(key);
    ASSERT_NE(at, std::string::npos) << last_;
    const double mib = std::stod(last_.substr(at + key.size()));
    EXPECT_GT(mib, 5);
    EXPECT_LT(mib, 200) << ours.size();
}

TEST_F(RunThreads, InstructionSetsChangeNoBit) {
    const auto expected = run("--threads 2");
    for (const char* name : {"scalar", "avx2", ""}) {
        setenv("FLOTILLA_SIMD", name, 1);
        EXPECT_EQ(run("--threads 2"), expected) << name;
        unsetenv("FLOTILLA_SIMD");
    }
}

TEST_F(RunThreads, TheEnvironmentSetsTheirNumber) {
    setenv("FLOTILLA_NUM_THREADS", "3", 1);
    run("");
    unsetenv("FLOTILLA_NUM_THREADS");
    EXPECT_NE(last_.find("\n     2 "), std::string::npos) << last_;
    EXPECT_EQ(last_.find("\n     3 "), std::string::npos) << last_;
}

TEST_F(RunThreads, AnEnvironmentThatAsksForNothingKnownIsRefused) {
    const std::string command = "run " + (folder_.path() / "boats.json").string() + " --steps 1 --quiet";
    const auto refusal = [&](const std::string& setting) {
        const CommandOutput r = run_flotilla(command, "export " + setting);
        EXPECT_EQ(r.exit_code, 2) << setting;
        return r.err;
    };
    for (const char* count : {"abc", "0", "-3", "2x", "1025", "99999999999"})
        EXPECT_EQ(refusal("FLOTILLA_NUM_THREADS=" + std::string(count)),
                  "flotilla: environment: FLOTILLA_NUM_THREADS: must be a whole number of 1 to 1024, got \"" +
                      std::string(count) + "\"\n");
    EXPECT_EQ(refusal("FLOTILLA_SIMD=foo"),
              "flotilla: environment: FLOTILLA_SIMD: must be scalar, avx2 or avx512, got \"foo\"\n");
    EXPECT_EQ(run_flotilla(command, "export FLOTILLA_NUM_THREADS= FLOTILLA_SIMD=").exit_code, 0);
    EXPECT_EQ(run_flotilla("--version", "export FLOTILLA_SIMD=foo").exit_code, 0);
}

TEST_F(RunThreads, TooManyAreRefused) {
    const CommandOutput r =
        run_flotilla("run " + (folder_.path() / "boats.json").string() + " --steps 1 --threads 100000");
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.err.find("100000 threads: at most 1024"), std::string::npos) << r.err;
}

TEST_F(RunThreads, AnUnknownExecutorIsRefused) {
    const CommandOutput r =
        run_flotilla("run " + (folder_.path() / "boats.json").string() + " --steps 1 --executor fast");
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.err.find("executor"), std::string::npos) << r.err;
}

} // namespace
} // namespace flotilla::test
