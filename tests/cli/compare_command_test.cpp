// SPDX-License-Identifier: MIT
// flotilla compare on runs of the command and on run folders written here.
#include <gtest/gtest.h>

#include <functional>

#include <flotilla/compare.hpp>

#include "run_folder/run_folder.hpp"
#include "run_folder/sample_run.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

struct Recorded {
    SampleFrame frame;
    StepReport row;
};
using Change = std::function<void(Recorded&)>;

/// Three bodies, one frame and row a step from 0 to `last`, after `change` had each.
std::string write_run(const fs::path& folder, std::int64_t last, const Change& change = {},
                      const io::RunInfo& info = sample_info()) {
    constexpr std::size_t kBodies = 3;
    io::RunWriter writer(folder, info, sample_scene(kBodies), io::OpenRun::create);
    for (std::int64_t k = 0; k <= last; ++k) {
        Recorded now{SampleFrame(kBodies, k), {}};
        now.row.step = k;
        now.row.state_hash = static_cast<std::uint64_t>(k);
        now.row.total_ms = static_cast<double>(folder.string().size()); // times differ
        if (change) change(now);
        if (k % info.frame_every == 0) writer.add_frame(now.frame.view);
        if (k > 0) writer.add_step(now.row);
    }
    writer.close("complete");
    return folder.string();
}

bool has(const CommandOutput& output, const std::string& text) { return output.out.find(text) != std::string::npos; }

TEST(CompareCommand, RunsOfTheSameSceneAreEqualAtAnyNumberOfThreads) {
    const TemporaryFolder folder;
    const std::string in = folder.path().string() + "/";
    std::ofstream(in + "scene.json") << run_flotilla("scene stack --bodies 4").out;
    const auto run = [&](const std::string& name, const std::string& options) {
        return run_flotilla("run --quiet --output " + in + name + " " + options + " " + in + "scene.json").exit_code;
    };
    ASSERT_EQ(run("one", "--steps 6 --threads 1"), 0);
    ASSERT_EQ(run("two", "--steps 6 --threads 2"), 0);
    ASSERT_EQ(run("longer", "--steps 8 --frame-every 2"), 0);
    ASSERT_EQ(run("rough", "--steps 6 --set friction=0.5"), 0);

    const CommandOutput same = run_flotilla("compare " + in + "one " + in + "two");
    EXPECT_EQ(same.exit_code, 0) << same.out << same.err;
    EXPECT_TRUE(has(same, "scene and settings:   the same\n")) << same.out;
    EXPECT_TRUE(has(same, "  threads: 1 | 2\n")) << same.out;
    EXPECT_TRUE(has(same, "steps compared:       6, up to step 6\n")) << same.out;
    EXPECT_TRUE(has(same, "frames compared:      7, up to step 6\n")) << same.out;
    EXPECT_TRUE(has(same, "verdict:              the same bits\n")) << same.out;

    const CommandOutput longer = run_flotilla("compare " + in + "one " + in + "longer");
    EXPECT_EQ(longer.exit_code, 0) << longer.out;
    EXPECT_TRUE(has(longer, "up to step 6; B has 2 more\n")) << longer.out;
    EXPECT_TRUE(has(longer, "frames compared:      4, up to step 6; A has 2 more\n")) << longer.out;
    EXPECT_TRUE(has(longer, "the same bits as far as both runs go\n")) << longer.out;

    const CommandOutput rough = run_flotilla("compare " + in + "one " + in + "rough");
    EXPECT_EQ(rough.exit_code, 0) << rough.out;
    EXPECT_TRUE(has(rough, "scene and settings:   different\n")) << rough.out;
    EXPECT_TRUE(has(rough, "  settings/friction: 0.1 | 0.5\n")) << rough.out;
}

TEST(CompareCommand, NamesTheFirstFrameAndBodyThatDifferByOneBit) {
    const TemporaryFolder folder;
    const std::string a = write_run(folder.path() / "a", 5);
    const std::string b = write_run(folder.path() / "b", 5, [](Recorded& now) {
        if (now.row.step >= 3) now.frame.position[1].y = std::nextafter(now.frame.position[1].y, 9);
        if (now.row.step == 4) now.frame.velocity[0].x = -0.0; // was +0: no other value, another bit
    });
    const CommandOutput r = run_flotilla("compare " + a + " " + b);
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_TRUE(
        has(r, "first frame:          3 (step 3, t = 0.12 s), 1 body differs\n"
               "  the first:          body 1 \"body \"1\", plate\" differs by 4.44089e-16 m, 0 rad, 0 m/s, 0 rad/s"))
        << r.out;
    EXPECT_TRUE(has(r, "last common frame:    5")) << r.out;
    EXPECT_TRUE(has(r, "DIFFERENT BITS")) << r.out;
    const CompareReport report = compare_runs(a, b);
    EXPECT_FALSE(report.first_step);
    ASSERT_TRUE(report.first_frame);
    EXPECT_EQ(report.first_frame->first.position, std::nextafter(3.0, 9) - 3);
    EXPECT_TRUE(report.promise_broken());
}

TEST(CompareCommand, ZerosOfOtherSignAndUnequalTurnsAreDifferences) {
    const TemporaryFolder folder;
    const fs::path a = write_run(folder.path() / "a", 2);
    const fs::path b = write_run(folder.path() / "b", 2, [](Recorded& now) {
        if (now.row.step == 1) now.frame.velocity[2].x = -0.0;
    });
    const fs::path c = write_run(folder.path() / "c", 2, [](Recorded& now) {
        if (now.row.step == 2) now.frame.path[1].z += 20;
    });
    const CompareReport sign = compare_runs(a, b), turn = compare_runs(a, c);
    ASSERT_TRUE(sign.first_frame);
    EXPECT_EQ(sign.first_frame->step, 1);
    EXPECT_EQ(sign.first_frame->first.body, 2);
    EXPECT_EQ(sign.first_frame->first.velocity, 0);
    ASSERT_TRUE(turn.first_frame);
    EXPECT_EQ(turn.first_frame->step, 2);
    EXPECT_EQ(turn.first_frame->first.body, 1);
}

TEST(CompareCommand, NamesTheFirstStepAndTheEarliestStageThatShows) {
    const TemporaryFolder folder;
    const std::string a = write_run(folder.path() / "a", 6);
    const std::string b = write_run(folder.path() / "b", 6, [](Recorded& now) {
        if (now.row.step == 3) now.row.iterations = 7;
        if (now.row.step >= 4) now.row.state_hash += 0x100, now.row.contacts = 2, now.row.merges = 1;
    });
    const CommandOutput r = run_flotilla("compare " + b + " " + a);
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_TRUE(has(r, "first step:           3, t = 0 s; columns that differ (A | B):\n  iterations: 7 | 0\n"
                       "earliest sign of it:  stage 3 or 7 (contact solves, counted together): iterations\n"
                       "its state hashes are equal\n"))
        << r.out;
    EXPECT_TRUE(has(r, "first state:          4")) << r.out;
    EXPECT_TRUE(has(r, "  state_hash: 0000000000000104 | 0000000000000004\n")) << r.out;
    EXPECT_TRUE(has(r, "earliest sign of it:  stage 5 (dynamic contact and failsafe): merges\n")) << r.out;

    const std::string c = write_run(folder.path() / "c", 6, [](Recorded& now) {
        if (now.row.step >= 2) now.row.state_hash += 1, now.row.energy = 0.5;
    });
    EXPECT_TRUE(has(run_flotilla("compare " + a + " " + c), "earliest sign of it:  none")) << "only the state differs";
}

TEST(CompareCommand, CountsOfWorkAreToldApartFromBits) {
    const TemporaryFolder folder;
    const std::string a = write_run(folder.path() / "a", 6);
    const auto more = [](Recorded& now) {
        if (now.row.step >= 3) now.row.pairs = 7;
    };
    const std::string b = write_run(folder.path() / "b", 6, more);
    const CompareReport report = compare_runs(a, b);
    EXPECT_TRUE(report.same_bits());
    ASSERT_TRUE(report.first_work);
    EXPECT_EQ(report.first_work->step, 3);
    const CommandOutput r = run_flotilla("compare " + a + " " + b);
    EXPECT_EQ(r.exit_code, 0) << r.out;
    EXPECT_TRUE(has(r, "work:                 differs first in step 3, by what was known of pairs; no bits (A | B):\n"
                       "  pairs: 0 | 7\n"))
        << r.out;
    EXPECT_TRUE(has(r, "verdict:              the same bits\n")) << r.out;

    const std::string c = write_run(folder.path() / "c", 6, [&](Recorded& now) {
        more(now);
        if (now.row.step == 4) now.row.iterations = 9;
    });
    const CompareReport both = compare_runs(a, c);
    EXPECT_FALSE(both.same_bits());
    ASSERT_TRUE(both.first_step);
    EXPECT_EQ(both.first_step->step, 4);
    EXPECT_EQ(both.first_step->columns.size(), 1U);
}

TEST(CompareCommand, OtherInputsOrBodiesAreNoBrokenPromise) {
    const TemporaryFolder folder;
    const auto move = [](Recorded& now) { now.frame.position[0].x = 5, now.row.state_hash += 1; };
    io::RunInfo gravity = sample_info();
    gravity.scene_json = R"({"flotilla_scene": 1, "gravity": [0, 0, -1.6]})";
    const std::string a = write_run(folder.path() / "a", 2);
    const std::string b = write_run(folder.path() / "b", 2, move, gravity);
    const CommandOutput r = run_flotilla("compare " + a + " " + b);
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_TRUE(has(r, "  scene.json gravity: (none) | [0,0,-1.6]\n")) << r.out;
    EXPECT_TRUE(has(r, "different bits from different scenes or settings\n")) << r.out;

    io::RunWriter(folder.path() / "c", sample_info(), sample_scene(2), io::OpenRun::create).close("complete");
    const CommandOutput fewer = run_flotilla("compare " + a + " " + folder.path().string() + "/c");
    EXPECT_EQ(fewer.exit_code, 0) << fewer.out;
    EXPECT_TRUE(has(fewer, "bodies or meshes differ: frames are not compared\n")) << fewer.out;
}

TEST(CompareCommand, ComparesWhatADamagedRunStillHasAndFailsWithFive) {
    const TemporaryFolder folder;
    const std::string a = write_run(folder.path() / "a", 125), b = write_run(folder.path() / "b", 125);
    fs::resize_file(b + "/frames-00000120-00000125.h5", 1000);
    const CommandOutput r = run_flotilla("compare " + a + " " + b);
    EXPECT_EQ(r.exit_code, 5);
    EXPECT_TRUE(has(r, "frames compared:      120, up to step 119\n")) << r.out;
    EXPECT_NE(r.err.find("frames 120 to 125 are lost"), std::string::npos) << r.err;
    EXPECT_EQ(run_flotilla("compare " + a + " " + folder.path().string()).exit_code, 5) << "no run folder";
    EXPECT_EQ(run_flotilla("compare " + a).exit_code, 2);
}

} // namespace
} // namespace flotilla::test
