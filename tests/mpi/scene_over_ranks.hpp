// SPDX-License-Identifier: MIT
// One scene on one process and over ranks, side by side.
#pragma once

#include <sstream>

#include <gtest/gtest.h>

#include <flotilla/scene_file.hpp>

#include "cli/step_hashes.hpp"
#include "mpi/ranks.hpp"

namespace flotilla::test {

/// A scene run by one process, to which runs over ranks are compared.
class OneScene {
  public:
    OneScene(const SceneDescription& scene, int steps) : steps_(" --quiet --steps " + std::to_string(steps)) {
        std::ostringstream text;
        write_scene(text, scene);
        file_ = folder_.write("scene.json", text.str());
        const CommandOutput run = run_flotilla("run " + file_ + steps_ + to("one"));
        EXPECT_EQ(run.exit_code, 0) << run.err;
        hashes_ = step_hashes(folder_.path() / "one");
        EXPECT_EQ(std::to_string(hashes_.size()), std::to_string(steps));
    }

    /// Runs it over so many ranks and expects the hash of every step. `options`: of the command.
    void expect_same_on(int ranks, const std::string& options = "") const {
        const std::string name = "ranks" + std::to_string(ranks);
        const CommandOutput run = run_ranks(ranks, "run " + file_ + steps_ + to(name) + ' ' + options);
        EXPECT_EQ(run.exit_code, 0) << run.err;
        EXPECT_EQ(step_hashes(folder_.path() / name), hashes_) << ranks << " ranks";
    }

    [[nodiscard]] std::string to(const std::string& name) const {
        return " --output " + (folder_.path() / name).string();
    }
    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }
    [[nodiscard]] const std::vector<std::string>& hashes() const { return hashes_; }

  private:
    TemporaryFolder folder_;
    std::string steps_, file_;
    std::vector<std::string> hashes_;
};

} // namespace flotilla::test
