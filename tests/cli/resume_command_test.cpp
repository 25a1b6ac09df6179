// SPDX-License-Identifier: MIT
// flotilla run --resume, signals, --time-limit, and what happens when files cannot be written or read.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <utility>

#include "cli/killed_runs.hpp"
#include "run_folder/damage.hpp"
#include "run_folder/file_stream.hpp"
#include "support/small_disk.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

TEST(KilledRuns, ResumeToTheSameBits) {
    const KilledRuns r = kill_and_resume(22, 70, 6);
    EXPECT_EQ(r.kills, 6);
    EXPECT_EQ(r.different, 0);
    EXPECT_EQ(r.failed, 0);
}

class Resume : public testing::Test {
  protected:
    Resume() { scene_ = folder_.write("boats.json", run_flotilla("scene boats-in-bowl --bodies 12 --seed 3").out); }
    [[nodiscard]] std::string options(int steps) const {
        return "run " + scene_ + " --threads 1 --checkpoint-every 5 --output " + run().string() + " --steps " +
               std::to_string(steps) + " ";
    }
    [[nodiscard]] fs::path run() const { return folder_.path() / "run"; }
    [[nodiscard]] fs::path file(const std::string& name) const { return run() / name; }
    /// Waits until the run has written some checkpoint; a run keeps only its last ones. False if there is none after a
    /// minute.
    [[nodiscard]] bool wait_for_checkpoint() const {
        const auto is_checkpoint = [](const fs::directory_entry& entry) {
            const std::string name = entry.path().filename().string();
            return name.starts_with("checkpoint-") && name.ends_with(".h5");
        };
        for (int i = 0; i < 60000 / 5; ++i) {
            std::error_code missing; // the folder itself may not be there yet
            const fs::directory_iterator files(run(), missing);
            if (!missing && std::any_of(begin(files), end(files), is_checkpoint)) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return false;
    }

    /// The verdict of compare on the folder and on a run that was never interrupted; `set` are options of both.
    [[nodiscard]] std::string compared_with_a_run_at_once(int steps, const std::string& set = "") const {
        const std::string whole = (folder_.path() / "whole").string();
        const CommandOutput r = run_flotilla("run " + scene_ + " --threads 1 --output " + whole + " --steps " +
                                             std::to_string(steps) + " " + set);
        if (r.exit_code != 0) return r.err;
        const std::string verdict = run_flotilla("compare " + run().string() + " " + whole).out;
        const std::string key = "verdict:              ";
        const auto at = verdict.find(key);
        if (at == std::string::npos) return verdict;
        return verdict.substr(at + key.size(), verdict.find('\n', at) - at - key.size());
    }

    TemporaryFolder folder_;
    std::string scene_;
};

TEST_F(Resume, AFinishedRunCanBeExtended) {
    ASSERT_EQ(run_flotilla(options(12)).exit_code, 0);
    const CommandOutput more = run_flotilla(options(20) + "--resume --audit");
    EXPECT_EQ(more.exit_code, 0) << more.err;
    EXPECT_NE(more.out.find("12 bodies, 8 steps after the 12 that were there"), std::string::npos) << more.out;
    EXPECT_NE(more.out.find("frames checked:       21"), std::string::npos) << more.out;
    const auto resumed = step_hashes(run());
    ASSERT_EQ(run_flotilla(options(20) + "--overwrite").exit_code, 0);
    EXPECT_EQ(step_hashes(run()), resumed);
    const CommandOutput nothing = run_flotilla(options(20) + "--resume");
    EXPECT_EQ(nothing.exit_code, 0) << nothing.err;
    EXPECT_EQ(step_hashes(run()), resumed);
}

TEST_F(Resume, ARunOfNoStepsHasItsInitialStateOnce) {
    ASSERT_EQ(run_flotilla(options(0)).exit_code, 0);
    ASSERT_EQ(run_flotilla(options(0) + "--resume").exit_code, 0);
    ASSERT_EQ(run_flotilla(options(3) + "--resume").exit_code, 0);
    EXPECT_EQ(compared_with_a_run_at_once(3), "the same bits");
}

TEST_F(Resume, StartsFromTheBeginningWhereThereIsNothing) {
    const CommandOutput r = run_flotilla(options(3) + "--resume");
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_NE(r.err.find("no run to resume: starting from the beginning"), std::string::npos) << r.err;
    for (const char* name : {"checkpoint-00000003.h5"}) fs::remove(file(name));
    const CommandOutput again = run_flotilla(options(4) + "--resume");
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_NE(again.err.find("no checkpoint to resume from: starting from the beginning"), std::string::npos);
    EXPECT_EQ(step_hashes(run()).size(), 4u);
}

TEST_F(Resume, AnotherSceneOrOtherSettingsAreRefused) {
    ASSERT_EQ(run_flotilla(options(6)).exit_code, 0);
    const auto before = step_hashes(run());
    const CommandOutput settings = run_flotilla(options(9) + "--resume --set friction=0.4");
    EXPECT_EQ(settings.exit_code, 2);
    EXPECT_NE(settings.err.find("another scene or other settings"), std::string::npos) << settings.err;
    EXPECT_EQ(run_flotilla(options(9) + "--resume --frame-every 2").exit_code, 2);
    fs::remove(file("checkpoint-00000005.h5"));
    fs::remove(file("checkpoint-00000006.h5"));
    EXPECT_EQ(run_flotilla(options(9) + "--resume --set friction=0.4").exit_code, 2);
    EXPECT_EQ(run_flotilla("run " + scene_ + " --steps 1 --resume").exit_code, 2);
    EXPECT_EQ(step_hashes(run()), before);
    folder_.write("run/notes.txt", "mine");
    EXPECT_EQ(run_flotilla(options(9)).exit_code, 2);
}

/// What a folder's files hold, by name.
std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        std::ifstream in(entry.path(), std::ios::binary);
        files[entry.path().filename().string()] = {std::istreambuf_iterator<char>(in), {}};
    }
    return files;
}

TEST_F(Resume, StepsWithOtherColumnsAreRefusedAndTheFolderStaysAsItIs) {
    ASSERT_EQ(run_flotilla(options(12)).exit_code, 0);
    const auto hashes = step_hashes(run());
    fs::remove(file("checkpoint-00000012.h5")); // the frames after step 10 would go
    const std::string steps = contents(run())["steps.csv"];
    const std::string header = steps.substr(0, steps.find('\n'));
    std::string renamed = header;
    renamed.replace(renamed.find(",pairs,"), 7, ",couples,");
    const std::pair<std::string, const char*> others[] = {
        {header.substr(0, header.rfind(',')), R"(it has no column "sleeping_contacts")"},
        {header + ",weight", R"(column "weight" is not known)"},
        {renamed, R"(it has column "couples" where "pairs" is expected)"},
    };
    for (const auto& [other, reason] : others) {
        SCOPED_TRACE(other);
        folder_.write("run/steps.csv", other + steps.substr(header.size()));
        const auto before = contents(run());
        const CommandOutput r = run_flotilla(options(14) + "--resume");
        EXPECT_EQ(r.exit_code, 5);
        EXPECT_NE(r.err.find(file("steps.csv").string() + ": "), std::string::npos) << r.err;
        EXPECT_NE(r.err.find(reason), std::string::npos) << r.err;
        EXPECT_TRUE(contents(run()) == before);
    }
    folder_.write("run/steps.csv", steps);
    EXPECT_EQ(run_flotilla(options(12) + "--resume").exit_code, 0);
    EXPECT_EQ(step_hashes(run()), hashes);
}

TEST_F(Resume, WhereAFileIsMissingTheOthersStayAsTheyAre) {
    for (const char* missing : {"steps.csv", "frames-00000006-00000010.h5"}) {
        SCOPED_TRACE(missing);
        ASSERT_EQ(run_flotilla(options(12) + "--overwrite").exit_code, 0);
        fs::remove(file("checkpoint-00000012.h5"));
        ASSERT_TRUE(fs::remove(file(missing)));
        const auto before = contents(run());
        const CommandOutput r = run_flotilla(options(14) + "--resume");
        EXPECT_EQ(r.exit_code, 5) << r.err;
        EXPECT_TRUE(contents(run()) == before);
    }
}

TEST_F(Resume, AMissingMeshIsNamed) {
    folder_.write("plate.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scene_ = folder_.write("plate.json", R"({"flotilla_scene": 1,
        "shapes": [{"name": "plate", "mesh": "plate.obj", "mass": 1}], "bodies": [{"name": "p", "shape": "plate"}]})");
    ASSERT_EQ(run_flotilla(options(3)).exit_code, 0);
    fs::remove(folder_.path() / "plate.obj");
    const CommandOutput r = run_flotilla(options(6) + "--resume");
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_NE(r.err.find("plate.obj"), std::string::npos) << r.err;
    EXPECT_EQ(run_flotilla("verify --quiet " + run().string()).exit_code, 0);
}

TEST_F(Resume, ADamagedCheckpointCostsOneInterval) {
    ASSERT_EQ(run_flotilla(options(12)).exit_code, 0);
    const auto expected = step_hashes(run());
    flip_bit(file("checkpoint-00000012.h5"),
             static_cast<std::streamoff>(fs::file_size(file("checkpoint-00000012.h5")) / 2));
    const CommandOutput r = run_flotilla(options(12) + "--resume");
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.err.find("checkpoint-00000012.h5"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("using an older checkpoint"), std::string::npos) << r.err;
    EXPECT_NE(r.out.find("2 steps after the 10 that were there"), std::string::npos) << r.out;
    EXPECT_EQ(step_hashes(run()), expected);
    for (const char* name : {"checkpoint-00000010.h5", "checkpoint-00000012.h5"}) fs::resize_file(file(name), 100);
    const CommandOutput none = run_flotilla(options(12) + "--resume");
    EXPECT_EQ(none.exit_code, 5);
    EXPECT_NE(none.err.find("no checkpoint is readable"), std::string::npos) << none.err;
    EXPECT_EQ(run_flotilla("verify --quiet " + run().string()).exit_code, 0) << "the frames are still there";
}

/// Of a file of contacts and that of the totals, compressed or not.
std::string contacts_in(const fs::path& folder, const std::string& name, const std::string& extension) {
    std::string text;
    for (const std::string& part : {name, name + "-bodies"}) {
        io::InputStream in(folder / (part + extension));
        text.append(std::istreambuf_iterator<char>(in.stream()), {});
    }
    return text;
}

TEST_F(Resume, ContactsGoOnAsIfTheRunHadNotStopped) {
    scene_ = folder_.write("stack.json", run_flotilla("scene stack --bodies 4").out);
    const std::string to = " --contacts " + folder_.path().string() + "/";
    for (const std::string extension : {".csv", ".csv.gz"}) {
        ASSERT_EQ(run_flotilla(options(30) + "--overwrite" + to + "whole" + extension).exit_code, 0);
        ASSERT_EQ(run_flotilla(options(12) + "--overwrite" + to + "parts" + extension).exit_code, 0);
        // Steps from 11 on are made again.
        fs::remove(file("checkpoint-00000012.h5"));
        const CommandOutput on = run_flotilla(options(30) + "--resume" + to + "parts" + extension);
        EXPECT_EQ(on.exit_code, 0) << on.err;
        EXPECT_EQ(on.err.find("begins with"), std::string::npos) << on.err;
        EXPECT_TRUE(contacts_in(folder_.path(), "parts", extension) == contacts_in(folder_.path(), "whole", extension));
    }
}

TEST_F(Resume, ContactsOfAKilledRunAreThere) {
    scene_ = folder_.write("stack.json", run_flotilla("scene stack --bodies 4").out);
    const std::string to = " --contacts " + folder_.path().string() + "/";
    for (const std::string extension : {".csv", ".csv.gz"}) {
        RunningFlotilla killed(options(1000000) + to + "parts" + extension);
        ASSERT_TRUE(wait_for_checkpoint());
        killed.send(SIGKILL);
        ASSERT_EQ(killed.wait(), -SIGKILL) << killed.output();
        const int steps = static_cast<int>(step_hashes(run()).size()) + 5;
        const CommandOutput on = run_flotilla(options(steps) + "--resume" + to + "parts" + extension);
        EXPECT_EQ(on.exit_code, 0) << on.err;
        EXPECT_EQ(on.err.find("begins with"), std::string::npos) << on.err;
        ASSERT_EQ(run_flotilla(options(steps) + "--overwrite" + to + "whole" + extension).exit_code, 0);
        EXPECT_TRUE(contacts_in(folder_.path(), "parts", extension) == contacts_in(folder_.path(), "whole", extension));
        EXPECT_FALSE(fs::exists(folder_.path() / ("parts" + extension + ".tmp")));
        fs::remove_all(run());
    }
}

TEST_F(Resume, OtherContactsAreNotWrittenOver) {
    scene_ = folder_.write("stack.json", run_flotilla("scene stack --bodies 4").out);
    const std::string contacts = (folder_.path() / "c.csv").string();
    ASSERT_EQ(run_flotilla(options(10) + "--contacts " + contacts).exit_code, 0);
    ASSERT_EQ(run_flotilla(options(12) + "--resume").exit_code, 0);
    const std::string before = contacts_in(folder_.path(), "c", ".csv");
    const auto hashes = step_hashes(run());
    const auto refused = [&](const std::string& file, const std::string& what) {
        const CommandOutput r = run_flotilla(options(20) + "--resume --contacts " + file);
        EXPECT_EQ(r.exit_code, 2) << r.err;
        EXPECT_NE(r.err.find(what), std::string::npos) << r.err;
        EXPECT_EQ(step_hashes(run()), hashes);
    };
    refused(contacts, "c.csv: is not what the run wrote of its contacts up to step 12");
    EXPECT_EQ(contacts_in(folder_.path(), "c", ".csv"), before);
    refused(folder_.write("other.csv", "a,b\n1,2\n"), "other.csv: is not what");
    const std::string later = (folder_.path() / "later.csv").string();
    const CommandOutput begun = run_flotilla(options(15) + "--resume --contacts " + later);
    EXPECT_EQ(begun.exit_code, 0) << begun.err;
    EXPECT_NE(begun.err.find("later.csv: begins with the contacts of step 13: nothing there"), std::string::npos)
        << begun.err;
    const CommandOutput on = run_flotilla(options(18) + "--resume --contacts " + later);
    EXPECT_EQ(on.exit_code, 0) << on.err;
    EXPECT_NE(on.err.find("later.csv: begins with the contacts of step 13: "), std::string::npos) << on.err;
    const std::string all = contacts_in(folder_.path(), "later", ".csv");
    for (const char* row : {"\n13,", "\n15,", "\n16,", "\n18,"}) EXPECT_NE(all.find(row), std::string::npos) << row;
    fs::remove(folder_.path() / "later-bodies.csv");
    const CommandOutput half = run_flotilla(options(20) + "--resume --contacts " + later);
    EXPECT_EQ(half.exit_code, 2);
    EXPECT_NE(half.err.find("later-bodies.csv: is missing"), std::string::npos) << half.err;
}

TEST_F(Resume, ADamagedSegmentIsNamedAndTheOthersStay) {
    ASSERT_EQ(run_flotilla(options(12)).exit_code, 0);
    fs::resize_file(file("frames-00000006-00000010.h5"), 500);
    const CommandOutput r = run_flotilla(options(14) + "--resume");
    EXPECT_EQ(r.exit_code, 0) << "it lies before the checkpoint: " << r.err;
    const CommandOutput verified = run_flotilla("verify --quiet " + run().string());
    EXPECT_EQ(verified.exit_code, 5);
    EXPECT_NE(verified.err.find("frames 6 to 10 are lost"), std::string::npos) << verified.err;
    EXPECT_NE(verified.out.find("frames checked:       10 "), std::string::npos) << verified.out;
    for (const auto& entry : fs::directory_iterator(run()))
        if (entry.path().filename().string().starts_with("frames-0000001")) fs::remove(entry.path());
    const CommandOutput missing = run_flotilla(options(16) + "--resume");
    EXPECT_EQ(missing.exit_code, 5);
    EXPECT_NE(missing.err.find("are missing, which come before the checkpoint"), std::string::npos) << missing.err;
}

TEST_F(Resume, TwoRunsCannotWriteIntoOneFolder) {
    constexpr int kForEver = 1000000;
    RunningFlotilla first(options(kForEver));
    ASSERT_TRUE(wait_for_checkpoint());
    for (const char* how : {"--resume", "--overwrite"}) {
        const CommandOutput second = run_flotilla(options(kForEver) + how);
        EXPECT_EQ(second.exit_code, 5);
        EXPECT_NE(second.err.find("another run is writing into this folder"), std::string::npos) << second.err;
    }
    first.send(SIGTERM);
    EXPECT_EQ(first.wait(), 6) << first.output();
    EXPECT_NE(first.output().find("(SIGTERM); --resume goes on"), std::string::npos) << first.output();
    const std::size_t steps = step_hashes(run()).size();
    const CommandOutput on = run_flotilla(options(static_cast<int>(steps) + 2) + "--resume");
    EXPECT_EQ(on.exit_code, 0) << on.err;
    EXPECT_NE(on.out.find(" 2 steps after the " + std::to_string(steps)), std::string::npos) << on.out;
}

TEST_F(Resume, AFullDiskLosesNothingOlder) {
    const fs::path disk = folder_.path() / "disk";
    const SmallDisk small(disk, "300k");
    if (!small.mounted()) GTEST_SKIP() << "cannot mount a small file system here: the test of a full disk is left out";
    const std::string to_disk =
        "run " + scene_ + " --quiet --threads 1 --checkpoint-every 5 --steps 400 --output " + (disk / "run").string();
    const CommandOutput r = run_flotilla(to_disk);
    EXPECT_EQ(r.exit_code, 5);
    EXPECT_NE(r.err.find("No space left on device"), std::string::npos) << r.err;
    const CommandOutput verified = run_flotilla("verify --quiet " + (disk / "run").string());
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
    EXPECT_EQ(verified.out.find("frames checked:       0"), std::string::npos) << verified.out;

    // On a larger disk it goes on, with the bits of a run that never stopped.
    fs::copy(disk / "run", run(), fs::copy_options::recursive);
    const std::size_t there = step_hashes(run()).size();
    const int steps = static_cast<int>(there) + 10;
    EXPECT_EQ(run_flotilla(options(steps) + "--resume").exit_code, 0);
    const auto resumed = step_hashes(run());
    ASSERT_EQ(run_flotilla(options(steps) + "--overwrite").exit_code, 0);
    EXPECT_EQ(resumed, step_hashes(run()));
}

TEST_F(Resume, AReadOnlyFolderIsNamed) {
    const fs::path disk = folder_.path() / "disk";
    const SmallDisk small(disk, "1m");
    if (small.mounted())
        small.make_read_only();
    else
        fs::permissions(disk, fs::perms::owner_read | fs::perms::owner_exec);
    const CommandOutput r = run_flotilla("run " + scene_ + " --steps 1 --quiet --output " + (disk / "run").string());
    EXPECT_EQ(r.exit_code, 5);
    EXPECT_NE(r.err.find((disk / "run").string() + ": cannot create the folder"), std::string::npos) << r.err;
}

TEST_F(Resume, ATimeLimitLeavesACheckpoint) {
    const CommandOutput r = run_flotilla(options(100000) + "--audit --time-limit 0:0:1");
    EXPECT_EQ(r.exit_code, 6);
    EXPECT_NE(r.err.find("not audited"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("(time limit); --resume goes on"), std::string::npos) << r.err;
    const CommandOutput info = run_flotilla("info " + run().string());
    EXPECT_NE(info.out.find("stopped"), std::string::npos) << info.out;
    for (const char* bad : {"1:60:00", "1:2:3:4", "soon", "1:", "-5"})
        EXPECT_EQ(run_flotilla(options(1) + "--overwrite --time-limit " + bad).exit_code, 2) << bad;
}

/// A press that comes down on a box.
constexpr const char* kPressScene = R"({"flotilla_scene": 1, "settings": {"unsatisfiable_script": "error"},
    "shapes": [{"name": "box", "density": 500,
                "vertices": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1]],
                "triangles": [[0,2,1],[0,3,2],[4,5,6],[4,6,7],[0,1,5],[0,5,4],
                              [1,2,6],[1,6,5],[2,3,7],[2,7,6],[3,0,4],[3,4,7]]},
               {"name": "plate", "vertices": [[-3,-3,0],[4,-3,0],[4,4,0],[-3,4,0]], "triangles": [[0,1,2],[0,2,3]]}],
    "bodies": [{"name": "crate", "shape": "box", "position": [0, 0, 0.02]},
               {"name": "floor", "shape": "plate", "type": "static"},
               {"name": "press", "shape": "plate", "type": "kinematic",
                "keyframes": [{"time": 0, "position": [0, 0, 2]}, {"time": 1, "position": [0, 0, 0.5]}]}]})";

TEST_F(Resume, AScriptThatCannotGoOnStopsTheRunWithWhatItHas) {
    scene_ = folder_.write("press.json", kPressScene);
    const CommandOutput stopped = run_flotilla(options(30) + "--audit");
    EXPECT_EQ(stopped.exit_code, 7);
    const auto hashes = step_hashes(run());
    const std::string steps = std::to_string(hashes.size());
    EXPECT_NE(stopped.out.find("3 bodies, " + steps + " steps, "), std::string::npos) << "no summary: " << stopped.out;
    EXPECT_NE(stopped.out.find("verdict:              free of intersections"), std::string::npos) << stopped.out;
    const CommandOutput not_kept = run_flotilla("run --steps 30 " + scene_);
    EXPECT_EQ(not_kept.exit_code, 7);
    EXPECT_EQ(not_kept.err.find("--resume"), std::string::npos) << "nothing was kept: " << not_kept.err;
    EXPECT_GT(hashes.size(), 10u);
    EXPECT_LT(hashes.size(), 24u);
    EXPECT_NE(stopped.err.find("step " + std::to_string(hashes.size() + 1) +
                               ": the script of body \"press\" cannot go on: it would crush body \"crate\""),
              std::string::npos)
        << stopped.err;
    EXPECT_NE(stopped.err.find("--resume --set unsatisfiable_script=hold"), std::string::npos) << stopped.err;
    EXPECT_EQ(run_flotilla("verify --quiet " + run().string()).exit_code, 0);
    EXPECT_EQ(run_flotilla(options(30) + "--resume").exit_code, 7);
    EXPECT_EQ(step_hashes(run()), hashes);
    EXPECT_EQ(run_flotilla(options(30) + "--resume --set unsatisfiable_script=follow").exit_code, 2);
    const CommandOutput held = run_flotilla(options(30) + "--resume --set unsatisfiable_script=hold");
    EXPECT_EQ(held.exit_code, 0) << held.err;
    const auto resumed = step_hashes(run());
    ASSERT_EQ(resumed.size(), 30u);
    ASSERT_EQ(run_flotilla(options(30) + "--overwrite --set unsatisfiable_script=hold").exit_code, 0);
    EXPECT_EQ(step_hashes(run()), resumed);
    EXPECT_EQ(run_flotilla(options(30) + "--overwrite --set unsatisfiable_script=follow --audit").exit_code, 0);
}

TEST_F(Resume, AScriptThatCannotGoOnFromTheStartLeavesTheInitialStateOnce) {
    std::string scene = kPressScene;
    const auto replace = [&](const std::string& what, const char* by) {
        scene.replace(scene.find(what), what.size(), by);
    };
    replace(R"("position": [0, 0, 2])", R"("position": [0, 0, 1.03])");
    replace(R"("time": 1,)", R"("time": 0.1,)");
    scene_ = folder_.write("press.json", scene);
    const CommandOutput stopped = run_flotilla(options(20) + "--audit");
    EXPECT_EQ(stopped.exit_code, 7);
    EXPECT_NE(stopped.out.find("3 bodies, 0 steps\n"), std::string::npos) << stopped.out;
    EXPECT_NE(stopped.out.find("frames checked:       1 "), std::string::npos) << stopped.out;
    EXPECT_EQ(step_hashes(run()).size(), 0u);
    const std::string hold = "--set unsatisfiable_script=hold";
    const CommandOutput held = run_flotilla(options(20) + "--resume --audit " + hold);
    EXPECT_EQ(held.exit_code, 0) << held.err;
    EXPECT_NE(held.out.find("frames checked:       21"), std::string::npos) << held.out;
    EXPECT_EQ(held.out.find("as states"), std::string::npos) << held.out;
    EXPECT_EQ(compared_with_a_run_at_once(20, hold), "the same bits");
}

} // namespace
} // namespace flotilla::test
