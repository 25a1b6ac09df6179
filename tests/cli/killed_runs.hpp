// SPDX-License-Identifier: MIT
// Runs that are killed at a random moment and resumed with another number of threads, against the undisturbed run.
#pragma once

#include <chrono>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "cli/step_hashes.hpp"
#include "support/command.hpp"

namespace flotilla::test {

struct KilledRuns {
    int kills = 0;     ///< that met a run which had not ended by itself
    int different = 0; ///< resumed runs that differ in a step's hash from the undisturbed one
    int failed = 0;    ///< resumptions with another exit code than 0
};

/// The run's scene has `bodies`, 30 of them and more make a pile within 80 steps.
inline KilledRuns kill_and_resume(int bodies, int steps, int kills) {
    using Clock = std::chrono::steady_clock;
    const TemporaryFolder folder;
    const std::string scene =
        folder.write("boats.json", run_flotilla("scene boats-in-bowl --seed 5 --bodies " + std::to_string(bodies)).out);
    const auto options = [&](const std::string& name) {
        return "run " + scene + " --quiet --checkpoint-every 5 --steps " + std::to_string(steps) + " --output " +
               (folder.path() / name).string();
    };
    const Clock::time_point start = Clock::now();
    EXPECT_EQ(run_flotilla(options("whole") + " --threads 2").exit_code, 0);
    const double whole_seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const std::vector<std::string> expected = step_hashes(folder.path() / "whole");
    EXPECT_EQ(expected.size(), static_cast<std::size_t>(steps));

    KilledRuns result;
    std::mt19937 random(1);
    for (int k = 0; result.kills < kills && k < 10 * kills; ++k) {
        const std::string name = "killed-" + std::to_string(k);
        RunningFlotilla run(options(name) + " --threads " + std::to_string(1 + k % 3));
        std::this_thread::sleep_for(
            std::chrono::duration<double>(whole_seconds * std::uniform_real_distribution(0.0, 1.0)(random)));
        run.send(SIGKILL);
        if (run.wait() != -SIGKILL) continue; // too late
        ++result.kills;
        const CommandOutput resumed =
            run_flotilla(options(name) + " --resume --threads " + std::to_string(1 + (k + 1) % 3));
        if (resumed.exit_code != 0) {
            ++result.failed;
            ADD_FAILURE() << "kill " << k << ": " << resumed.err;
        }
        result.different += step_hashes(folder.path() / name) == expected ? 0 : 1;
        std::error_code ignored;
        std::filesystem::remove_all(folder.path() / name, ignored);
    }
    return result;
}

} // namespace flotilla::test
