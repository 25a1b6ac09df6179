// SPDX-License-Identifier: MIT
// What a callback throws comes out of run_scene and verify as it is, and leaves what was written as a crash would:
// whole, to be resumed.
#include <gtest/gtest.h>

#include <flotilla/run.hpp>
#include <flotilla/scene_library.hpp>
#include <flotilla/verify.hpp>

#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

/// The host's own; no Error of the library, nor any standard one.
struct HostFault {
    int number;
};

class Callbacks : public testing::TestWithParam<int> {
  protected:
    [[nodiscard]] RunOptions options(const std::string& name, std::int64_t steps = 30) const {
        RunOptions run;
        run.output = folder_.path() / name;
        run.steps = steps;
        run.checkpoint_every = 5;
        run.world.threads = GetParam();
        return run;
    }
    [[nodiscard]] static SceneDescription scene() { return make_scene("boats-in-bowl", 14, 3); }
    static std::uint64_t hash_of(const RunOptions& run) { return run_scene(scene(), "scene", run).last.state_hash; }

    test::TemporaryFolder folder_;
};

INSTANTIATE_TEST_SUITE_P(Threads, Callbacks, testing::Values(1, 3));

TEST_P(Callbacks, ThatThrowAfterAStepLeaveARunThatGoesOn) {
    const std::uint64_t expected = hash_of(options("whole"));
    for (const int number : {1, 5, 12, 29}) {
        RunOptions run = options("run");
        run.after_step = [&](const StepReport& r) {
            if (r.step == number) throw HostFault{number};
            return true;
        };
        try {
            (void)run_scene(scene(), "scene", run);
            ADD_FAILURE() << "nothing was thrown";
        } catch (const HostFault& fault) {
            EXPECT_EQ(fault.number, number);
        }
        EXPECT_TRUE(verify_run(run.output).proved()) << number;
        run = options("run");
        run.resume = true;
        EXPECT_EQ(hash_of(run), expected) << number;
        std::filesystem::remove_all(run.output);
    }
}

TEST_P(Callbacks, ThatThrowWhenTheyAreToldLeaveTheFolderFree) {
    RunOptions run = options("run");
    run.resume = true; // there is nothing to resume, which is noted
    run.note = [](const std::string&) { throw HostFault{1}; };
    EXPECT_THROW((void)run_scene(scene(), "scene", run), HostFault);
    EXPECT_FALSE(std::filesystem::exists(run.output));
    run.note = {};
    EXPECT_NO_THROW((void)run_scene(scene(), "scene", run));
}

TEST_P(Callbacks, ThatThrowWhileFramesAreVerifiedComeOut) {
    (void)run_scene(scene(), "scene", options("run"));
    VerifyOptions verify;
    verify.threads = GetParam();
    verify.progress = [](double part) {
        if (part > 0.5) throw HostFault{2};
    };
    EXPECT_THROW((void)verify_run(folder_.path() / "run", verify), HostFault);
    EXPECT_TRUE(verify_run(folder_.path() / "run").proved());
}

} // namespace
} // namespace flotilla
