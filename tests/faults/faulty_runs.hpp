// SPDX-License-Identifier: MIT
// A run that something may stop, and what it must leave: a folder that can be read, and that goes on with the bits of a
// run that nothing stopped.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/step_hashes.hpp"
#include "support/command.hpp"

namespace flotilla::test {

inline constexpr bool kAllFaults = FLOTILLA_ALL_FAULTS != 0; ///< else a slice of them

class FaultyRuns : public testing::Test {
  protected:
    static constexpr int kSteps = 40;

    FaultyRuns() {
        scene_ = folder_.write("boats.json", run_flotilla("scene boats-in-bowl --bodies 14 --seed 3").out);
        EXPECT_EQ(run_flotilla(run_in("whole") + " --threads 1").exit_code, 0);
        expected_ = step_hashes(path("whole"));
        EXPECT_EQ(expected_.size(), static_cast<std::size_t>(kSteps));
    }

    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
    [[nodiscard]] std::string run_in(const std::string& name) const {
        return "run " + scene_ + " --quiet --checkpoint-every 5 --steps " + std::to_string(kSteps) + " --output " +
               path(name).string();
    }

    /// What is there can be read, and the run goes on to its end with the right bits. Removes the folder.
    void expect_goes_on(const std::string& name) {
        if (std::filesystem::exists(path(name) / "run.json")) {
            const CommandOutput info = run_flotilla("info " + path(name).string());
            EXPECT_EQ(info.exit_code, 0) << info.err;
            const CommandOutput verified = run_flotilla("verify --quiet " + path(name).string());
            EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
        }
        const CommandOutput resumed = run_flotilla(run_in(name) + " --resume --threads 2");
        EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
        EXPECT_TRUE(step_hashes(path(name)) == expected_);
        std::filesystem::remove_all(path(name));
    }

    TemporaryFolder folder_;
    std::string scene_;
    std::vector<std::string> expected_; ///< hashes of the steps of a run that nothing stopped
};

} // namespace flotilla::test
