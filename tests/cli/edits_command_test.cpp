// SPDX-License-Identifier: MIT
// flotilla run --edits: the run, its folder, and that it resumes.
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <flotilla/edit_file.hpp>
#include <flotilla/scene_file.hpp>

#include "run/edited_runs.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class EditsCommand : public testing::Test {
  protected:
    EditsCommand() {
        std::ostringstream scene;
        write_scene(scene, tub());
        scene_ = folder_.write("tub.json", scene.str());
    }
    [[nodiscard]] std::string path(const char* name) const { return (folder_.path() / name).string(); }
    /// Random edits of so many steps, that all are possible.
    [[nodiscard]] std::string recorded(std::uint64_t seed, int steps) const {
        World world(read_scene(scene_), "scene", {1});
        world.record_edits(true);
        RandomEdits edits(seed, 2.4, 4, 24);
        Ignored ignored;
        for (int k = 0; k < steps; ++k) {
            for (int i = 0; i < 2; ++i) edit_once(world, edits, ignored, nullptr);
            (void)world.step();
        }
        std::ostringstream text;
        write_edits(text, world.recorded_edits(), read_scene(scene_));
        return text.str();
    }
    [[nodiscard]] std::string run(const std::string& edits, const char* folder, const std::string& more) const {
        return "run " + scene_ + " --quiet --edits " + edits + " --output " + path(folder) + " " + more;
    }

    TemporaryFolder folder_;
    std::string scene_;
};

TEST_F(EditsCommand, RunsAreProvedAndResumeToTheSameBits) {
    const std::string edits = folder_.write("edits.json", recorded(31, 40));
    const CommandOutput whole = run_flotilla(run(edits, "whole", "--steps 40 --threads 2 --audit"));
    ASSERT_EQ(whole.exit_code, 0) << whole.out << whole.err;
    EXPECT_THAT(whole.out, HasSubstr("free of intersections"));
    EXPECT_THAT(whole.out, HasSubstr("pairs not proved:     0"));
    ASSERT_EQ(run_flotilla(run(edits, "parts", "--steps 13 --threads 1")).exit_code, 0);
    ASSERT_EQ(run_flotilla(run(edits, "parts", "--steps 29 --threads 3 --resume")).exit_code, 0);
    ASSERT_EQ(run_flotilla(run(edits, "parts", "--steps 40 --threads 1 --resume")).exit_code, 0);
    const CommandOutput compared = run_flotilla("compare " + path("whole") + " " + path("parts"));
    EXPECT_EQ(compared.exit_code, 0) << compared.out;
    // A record of what was edited is part of the run.
    const std::string other = folder_.write("other.json", recorded(32, 40));
    const CommandOutput refused = run_flotilla(run(other, "parts", "--steps 60 --resume"));
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("other edits"));
    EXPECT_EQ(run_flotilla("picture " + path("whole") + " --output " + path("p.png")).exit_code, 0);
    EXPECT_EQ(run_flotilla("export " + path("whole") + " --format obj --output " + path("obj")).exit_code, 0);
}

TEST_F(EditsCommand, AMovedBodyIsNotAFaultAndAHiddenMoveIs) {
    const std::string edits = folder_.write(
        "edits.json", "{\"flotilla_edits\": 1, \"edits\": [{\"step\": 3, \"set_pose\": {\"body\": \"body5\", "
                      "\"position\": [0, 0, 9]}}, {\"step\": 5, \"remove_body\": \"body6\"}]}");
    ASSERT_EQ(run_flotilla(run(edits, "run", "--steps 8")).exit_code, 0);
    EXPECT_EQ(run_flotilla("verify --quiet " + path("run")).exit_code, 0);
    // Without its record the jump is what it looks like, through whatever was between.
    std::filesystem::remove(folder_.path() / "run" / "edits.json");
    EXPECT_NE(run_flotilla("verify --quiet " + path("run")).exit_code, 0);
}

TEST_F(EditsCommand, RefusedEditsEndARunThatCanBeRead) {
    const std::string edits =
        folder_.write("edits.json", "{\"flotilla_edits\": 1, \"edits\": [{\"step\": 6, \"wake\": \"body5\"}, "
                                    "{\"step\": 4, \"add_body\": {\"name\": \"late\", \"shape\": "
                                    "\"shape1\", \"position\": [0, 0, -3]}}]}");
    const CommandOutput r = run_flotilla(run(edits, "run", "--steps 8"));
    EXPECT_EQ(r.exit_code, 4) << r.err;
    EXPECT_THAT(r.err,
                HasSubstr("edits.json: /edits/1: edit after step 4: body \"late\" would intersect body \"floor\""));
    const CommandOutput verified = run_flotilla("verify " + path("run"));
    EXPECT_EQ(verified.exit_code, 0) << verified.out << verified.err;
    const std::string wrong = folder_.write("wrong.json", "{\"flotilla_edits\": 1, \"edits\": [{\"step\": 1}]}");
    EXPECT_EQ(run_flotilla(run(wrong, "other", "--steps 2")).exit_code, 2);
    EXPECT_EQ(run_flotilla(run(path("none.json"), "other", "--steps 2")).exit_code, 5);
}

TEST_F(EditsCommand, FaultyShapesAndEditsAfterTheEndAreNamed) {
    const auto file = [&](const char* name, const char* second_edge) {
        return folder_.write(name, std::string(R"({"flotilla_edits": 1, "edits": [
  {"step": 9, "wake": "body5"}, {"step": 8, "wake": "body5"},
  {"step": 2, "add_shape": {"name": "flat", "mass": 1, "triangles": [[0, 1, 2]],
                            "vertices": [[0, 0, 0], [1, 0, 0], )") +
                                       second_edge + "]}}]}");
    };
    const CommandOutput degenerate = run_flotilla(run(file("degenerate.json", "[2, 0, 0]"), "none", "--steps 8"));
    EXPECT_EQ(degenerate.exit_code, 2);
    EXPECT_THAT(degenerate.err, HasSubstr("degenerate.json: /edits/2: edit after step 2: "));
    EXPECT_THAT(degenerate.err, HasSubstr("shape 'flat': its surface area is zero"));
    const std::string sound = file("sound.json", "[0, 1, 0]");
    const CommandOutput short_run = run_flotilla(run(sound, "run", "--steps 8"));
    EXPECT_EQ(short_run.exit_code, 0) << short_run.err;
    EXPECT_THAT(short_run.err, HasSubstr("sound.json: /edits/1: edit after step 8 and 1 more: not made, the run ends "
                                         "after step 8"));
    const CommandOutput longer = run_flotilla(run(sound, "run", "--steps 10 --resume"));
    EXPECT_EQ(longer.exit_code, 0) << longer.err;
    EXPECT_THAT(longer.err, Not(HasSubstr("not made")));
}

TEST_F(EditsCommand, ScenesThatIgnorePairsAreVerifiedButForThem) {
    const std::string scene = folder_.write("ghosts.json", R"({"flotilla_scene": 1,
  "shapes": [{"name": "s", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}],
  "bodies": [{"name": "a", "shape": "s", "group": "g"}, {"name": "b", "shape": "s", "group": "g",
              "rotation": [0.8, 0.6, 0, 0], "velocity": [1, 0, 0]}, {"name": "c", "shape": "s", "position": [0, 0, 5]}],
  "ignore": {"groups": [["g", "g"]]}})");
    const CommandOutput checked = run_flotilla("check " + scene);
    ASSERT_EQ(checked.exit_code, 0);
    EXPECT_THAT(checked.out + checked.err, HasSubstr("1 pair of bodies may pass through each other"));
    const CommandOutput r = run_flotilla("run " + scene + " --steps 20 --quiet --audit --output " + path("run"));
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr("may pass through each other"));
    const std::string without = folder_.write("solid.json", R"({"flotilla_scene": 1,
  "shapes": [{"name": "s", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}],
  "bodies": [{"name": "a", "shape": "s"}, {"name": "b", "shape": "s", "rotation": [0.8, 0.6, 0, 0]}]})");
    EXPECT_EQ(run_flotilla("check " + without).exit_code, 4);
    const std::string unknown = folder_.write("unknown.json", R"({"flotilla_scene": 1,
  "shapes": [{"name": "s", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}],
  "bodies": [{"name": "a", "shape": "s"}], "ignore": {"groups": [["g", "g"]], "bodies": [["a", "a"], ["a", "x"]]}})");
    const CommandOutput refused = run_flotilla("check " + unknown);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("/ignore/groups/0: no body has the group \"g\""));
    EXPECT_THAT(refused.err, HasSubstr("/ignore/bodies/0: a body cannot meet itself"));
    EXPECT_THAT(refused.err, HasSubstr("/ignore/bodies/1: no body has the name \"x\""));
}

} // namespace
} // namespace flotilla::test
