// SPDX-License-Identifier: MIT
// flotilla scene, check and plan --settings: what they print and how they exit.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include <flotilla/scene_file.hpp>
#include <flotilla/scene_library.hpp>
#include <flotilla/settings.hpp>

#include "support/bad_scenes.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

const std::string kCrossing = R"({"flotilla_scene": 1,
  "shapes": [{"name": "t", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}],
  "bodies": [{"name": "left one", "shape": "t"}, {"name": "right", "shape": "t", "position": [0.1, 0.1, -0.2], "rotation": [0.6, 0.8, 0, 0]},
             {"name": "wall", "shape": "t", "type": "static", "position": [5, 0, 0]},
             {"name": "wall2", "shape": "t", "type": "static", "position": [5, 0, 0]}]})";

TEST(SceneCommand, PrintsWhatCheckAccepts) {
    const TemporaryFolder folder;
    for (const LibraryScene& info : list_scenes()) {
        const CommandOutput made = run_flotilla("scene " + std::string(info.name));
        EXPECT_EQ(made.exit_code, 0) << made.err;
        const CommandOutput check = run_flotilla("check " + folder.write("scene.json", made.out));
        EXPECT_EQ(check.exit_code, 0) << check.err;
        EXPECT_TRUE(check.out.starts_with("ok: " + std::to_string(info.default_bodies) + " bodies (")) << check.out;
    }
}

TEST(SceneCommand, RoundTripsThroughReaderAndWriter) {
    const CommandOutput made = run_flotilla("scene boats-in-bowl --bodies 20 --seed 8");
    std::ostringstream again;
    write_scene(again, parse_scene(made.out, "scene", "."));
    EXPECT_EQ(again.str(), made.out);
}

TEST(SceneCommand, SameSeedSameBytes) {
    const std::string line = "scene boats-in-bowl --bodies 12 --seed 3";
    const CommandOutput first = run_flotilla(line);
    EXPECT_EQ(first.exit_code, 0);
    EXPECT_EQ(first.out, run_flotilla(line).out);
    EXPECT_NE(first.out, run_flotilla("scene boats-in-bowl --bodies 12 --seed 4").out);
}

TEST(SceneCommand, ListsScenesAndRefusesOthers) {
    const CommandOutput list = run_flotilla("scene --list");
    EXPECT_EQ(list.exit_code, 0);
    for (const LibraryScene& info : list_scenes())
        EXPECT_NE(list.out.find(std::string(info.name) + " "), std::string::npos);
    const CommandOutput unknown = run_flotilla("scene boats");
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_EQ(unknown.out, "");
    EXPECT_NE(unknown.err.find("unknown scene \"boats\""), std::string::npos) << unknown.err;
    EXPECT_EQ(run_flotilla("scene").exit_code, 2);
    EXPECT_EQ(run_flotilla("scene stack --bodies 1").exit_code, 2);
}

TEST(CheckCommand, SummarisesAGoodScene) {
    const TemporaryFolder folder;
    const std::string file = folder.write("s.json", R"({"flotilla_scene": 1, "shapes": [{"name": "t", "mass": 2,
      "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}], "bodies": [{"name": "b", "shape": "t"}]})");
    const CommandOutput r = run_flotilla("check " + file);
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_EQ(r.out, "ok: 1 body (1 dynamic, 0 static, 0 kinematic), 1 shape, 1 triangle, mass 2 kg\n");
    EXPECT_EQ(r.err, "");
}

TEST(CheckCommand, InvalidScenesExitWithTwoAndAllProblems) {
    const TemporaryFolder folder;
    const std::string file =
        folder.write("s.json", R"({"flotilla_scene": 1, "gravty": [0,0,0], "shapes": [{"name": "line", "mass": 2,
      "vertices": [[0,0,0],[1,0,0],[2,0,0]], "triangles": [[0,1,2]]}], "bodies": [{"name": "b", "shape": "line", "friction": -1}]})");
    const CommandOutput r = run_flotilla("check " + file);
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_EQ(r.out, "");
    EXPECT_NE(r.err.find(file + ": /gravty: unknown key \"gravty\"; did you mean \"gravity\"?\n"), std::string::npos)
        << r.err;
    EXPECT_NE(r.err.find(file + ": /shapes/0: shape 'line': "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find(file + ": /bodies/0/friction: must be in 0 .. 1000, got -1\n"), std::string::npos) << r.err;
}

TEST(CheckCommand, EveryKindOfBadSceneExitsWithTwoAndItsMessages) {
    const TemporaryFolder folder;
    for (const BadScene& scene : bad_scenes()) {
        const std::string file = folder.write("bad.json", scene.text);
        std::string expected = "flotilla: ";
        for (const std::string& problem : scene.problems) (expected += file) += ": " + problem + "\n";
        const CommandOutput r = run_flotilla("check " + file);
        EXPECT_EQ(r.exit_code, 2) << scene.kind;
        EXPECT_EQ(r.err, expected) << scene.kind;
        EXPECT_EQ(r.out, "") << scene.kind;
    }
}

TEST(CheckCommand, AnOverlapCanBeRepaired) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("s.json", kCrossing), option = " --set initial_overlap=separate";
    const CommandOutput check = run_flotilla("check " + scene + option);
    EXPECT_EQ(check.exit_code, 0) << check.err;
    EXPECT_NE(check.err.find("intersects another at t = 0 and will be moved by "), std::string::npos) << check.err;
    const std::string run = "run " + scene + " --output " + (folder.path() / "run").string();
    EXPECT_EQ(run_flotilla(run + " --steps 2").exit_code, 4);
    const CommandOutput repaired = run_flotilla(run + " --audit --steps 3" + option);
    EXPECT_EQ(repaired.exit_code, 0) << repaired.err;
    EXPECT_NE(repaired.err.find("intersected another at the start and was moved by "), std::string::npos);
    EXPECT_NE(repaired.out.find("frames checked:       4 "), std::string::npos) << repaired.out;
    const CommandOutput on = run_flotilla(run + " --resume --steps 5" + option);
    EXPECT_EQ(on.exit_code, 0) << on.err;
    EXPECT_NE(on.out.find("2 steps after the 3"), std::string::npos) << on.out;
}

TEST(CheckCommand, IntersectingBodiesExitWithFourAndAreWritten) {
    const TemporaryFolder folder;
    const CommandOutput r = run_flotilla("check " + folder.write("s.json", kCrossing));
    EXPECT_EQ(r.exit_code, 4);
    EXPECT_NE(r.err.find("error: bodies \"left one\" and \"right\" intersect at t = 0: 1 triangle pair, near ("),
              std::string::npos)
        << r.err;
    EXPECT_NE(r.err.find("warning: bodies \"wall\" and \"wall2\" intersect"), std::string::npos) << r.err;
    std::ifstream obj(folder.path() / "s.overlap.obj");
    const std::string text{std::istreambuf_iterator<char>(obj), {}};
    EXPECT_NE(text.find("g pair0_left_one\nv 0 0 0\n"), std::string::npos) << text;
    EXPECT_NE(text.find("f 4 5 6\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("wall"), std::string::npos);
}

TEST(CheckCommand, WritesIntersectionsWhereAsked) {
    const TemporaryFolder folder;
    const std::string file = folder.write("s.json", kCrossing), out = (folder.path() / "x.obj").string();
    EXPECT_EQ(run_flotilla("check " + file + " --output " + out).exit_code, 4);
    EXPECT_TRUE(std::filesystem::exists(out));
    const CommandOutput nowhere = run_flotilla("check " + file + " --output " + (folder.path() / "no/x.obj").string());
    EXPECT_EQ(nowhere.exit_code, 4) << "the verdict matters more than the file";
    EXPECT_NE(nowhere.err.find("warning: "), std::string::npos) << nowhere.err;
}

TEST(CheckCommand, UnreadableFilesExitWithFive) { EXPECT_EQ(run_flotilla("check /no/such/scene.json").exit_code, 5); }

TEST(CheckCommand, SettingsFromTheCommandLineAreChecked) {
    const TemporaryFolder folder;
    const std::string file = folder.write("s.json", run_flotilla("scene stack").out);
    EXPECT_EQ(run_flotilla("check " + file + " --preset accurate --set friction=0.5 --set seed=3").exit_code, 0);
    EXPECT_EQ(run_flotilla("check --set friction=0.5 " + file).exit_code, 0);
    const CommandOutput unknown = run_flotilla("check " + file + " --set frction=0.5");
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.err.find("did you mean \"friction\"?"), std::string::npos) << unknown.err;
    EXPECT_EQ(run_flotilla("check " + file + " --set friction").exit_code, 2);
    EXPECT_EQ(run_flotilla("check " + file + " --preset best").exit_code, 2);
}

// A cube that lies above a plate, y up, for four steps.
const std::string kForeign =
    R"({"timestep": 0.01, "max_time": 0.04, "rigid_body_problem": {"gravity": [0, -9.8, 0], "rigid_bodies": [
  {"vertices": [[0,0,0],[1,0,0],[1,0,1],[0,0,1]], "faces": [[0,1,2],[0,2,3]], "edges": [[0,1],[1,2],[2,0],[2,3],[3,0]], "scale": 9, "type": "static"},
  {"vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "faces": [[0,2,1],[0,1,3],[0,3,2],[1,2,3]], "position": [3, 0.5, 3], "unkown": 1}]}})";

TEST(ImportCommand, WritesWhatOtherCommandsReadDirectly) {
    const TemporaryFolder folder;
    const std::string file = folder.write("foreign.json", kForeign), own = (folder.path() / "own.json").string();
    const CommandOutput made = run_flotilla("import " + file + " --output " + own);
    EXPECT_EQ(made.exit_code, 0) << made.err;
    EXPECT_EQ(made.out, "");
    EXPECT_EQ(made.err.find("warning: " + file + ": /rigid_body_problem/rigid_bodies/1/unkown: unknown key"), 0U)
        << made.err;
    EXPECT_NE(
        made.err.find("a scene of Rigid-IPC with 2 bodies, turned so that z points up; it wants to be run for 0.04 s"),
        std::string::npos)
        << made.err;
    EXPECT_EQ(run_flotilla("import " + file).out,
              std::string(std::istreambuf_iterator<char>(std::ifstream(own).rdbuf()), {}));
    EXPECT_EQ(run_flotilla("check " + file).out, run_flotilla("check " + own).out);
    EXPECT_EQ(run_flotilla("plan " + file).exit_code, 0);
    const std::string picture = (folder.path() / "p.png").string();
    EXPECT_EQ(run_flotilla("picture " + file + " --output " + picture + " --width 32 --height 24").exit_code, 0);
    const auto hash = [&](const std::string& scene, const std::string& options) {
        const CommandOutput r = run_flotilla("run " + scene + options);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        const std::size_t at = r.out.find("state hash");
        return at == std::string::npos ? r.out : r.out.substr(at, r.out.find('\n', at) - at);
    };
    EXPECT_EQ(hash(file, ""), hash(own, " --steps 4")) << "the file says how long";
    EXPECT_EQ(hash(file, " --duration 0.02"), hash(own, " --steps 2"));
    const std::string run = (folder.path() / "run").string();
    EXPECT_EQ(hash(file, " --audit --output " + run), hash(own, " --steps 4"));
    EXPECT_EQ(run_flotilla("run " + file + " --output " + run + " --resume --steps 6").exit_code, 0);
    EXPECT_EQ(run_flotilla("check " + run + "/scene.json").exit_code, 0)
        << "the run folder holds the scene as one of ours";
}

TEST(ImportCommand, RefusesWhatItCannotKeepAndWhatIsNone) {
    const TemporaryFolder folder;
    const std::string points =
        folder.write("points.json", R"({"rigid_body_problem": {"rigid_bodies": [{"vertices": [[0,0,0]]}]}})");
    const CommandOutput refused = run_flotilla("import " + points);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(refused.out, "");
    EXPECT_EQ(
        refused.err,
        "flotilla: " + points +
            ": /rigid_body_problem/rigid_bodies/0: shape 'body-0': all its points lie at one place: it has no size\n");
    EXPECT_EQ(run_flotilla("import " + folder.write("own.json", run_flotilla("scene stack").out)).exit_code, 2);
    EXPECT_EQ(run_flotilla("import " + (folder.path() / "none.json").string()).exit_code, 5);
    const std::string file = folder.write("foreign.json", kForeign);
    EXPECT_EQ(run_flotilla("import " + file + " --output " + (folder.path() / "no/x.json").string()).exit_code, 5);
}

TEST(PlanCommand, ListsEverySettingAndPreset) {
    const CommandOutput r = run_flotilla("plan --settings");
    EXPECT_EQ(r.exit_code, 0);
    for (const SettingInfo& info : list_settings())
        EXPECT_NE(r.out.find(std::string(info.key) + " = " + info.default_value), std::string::npos) << info.key;
    for (const std::string_view name : preset_names())
        EXPECT_NE(r.out.find("  " + std::string(name) + ":"), std::string::npos);
    EXPECT_EQ(run_flotilla("plan").exit_code, 2);
}

TEST(PlanCommand, SaysWhatWillBeModelledOfAScene) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("s.json", run_flotilla("scene boats-in-bowl --bodies 12").out);
    const CommandOutput r = run_flotilla("plan " + scene + " --set sleeping=false --set restitution=0");
    EXPECT_EQ(r.exit_code, 0) << r.err;
    for (const char* text :
         {"bodies:       10 dynamic, 2 static, 0 kinematic\n", "shapes:       3 meshes with ", "rest distance 0.00",
          "gravity adds 0.4083 m/s in a step", "friction:     0.1 (geometric mean", "no body sleeps",
          "settings:     restitution = 0, sleeping = false\n", "a frame takes 1308 bytes"})
        EXPECT_NE(r.out.find(text), std::string::npos) << text << '\n' << r.out;
    const std::string bad = folder.write("bad.json", R"({"flotilla_scene": 1, "shapes": [], "bodies": 3})");
    EXPECT_EQ(run_flotilla("plan " + bad).exit_code, 2);
    EXPECT_EQ(run_flotilla("plan --settings " + scene).exit_code, 2);
}

TEST(PlanCommand, SaysWhatTheSceneDoesNotNeed) {
    const TemporaryFolder folder;
    const auto saved = [&](const std::string& scene, const std::string& options) {
        const std::string file = folder.write("s.json", run_flotilla("scene " + scene).out);
        const CommandOutput r = run_flotilla("plan " + file + options);
        EXPECT_EQ(r.exit_code, 0) << r.err;
        return r.out;
    };
    const std::string boats = saved("boats-in-bowl --bodies 12", "");
    for (const char* text :
         {"saved:        12 bodies on 3 meshes: ", "straight paths", "islands of up to 10 bodies",
          "no collision pass in ", "ballistic: ", "not rasterized: 2 of 2 static meshes, 2498 triangles",
          "2 solves of contacts", "no scripts"})
        EXPECT_NE(boats.find(text), std::string::npos) << text << '\n' << boats;
    EXPECT_EQ(boats.find("no friction"), std::string::npos) << boats;
    EXPECT_NE(saved("stack", " --set friction=0").find("1 row in place of 3, 96 bytes in place of 208"),
              std::string::npos);
    const std::string walls = saved("closing-walls", " --set sleeping=false --set trajectory=rigid");
    for (const char* text : {"no scripts", "straight paths", "islands of up to"})
        EXPECT_EQ(walls.find(text), std::string::npos) << text << walls;
}

// A body falls from rest: in step k, of 1/24 s, by g dt^2 (k - 1/2).
TEST(PlanCommand, SaysHowFarBodiesMoveBeforeTheyTouch) {
    const TemporaryFolder folder;
    const auto first_contact = [&](double height) {
        const CommandOutput r = run_flotilla(
            "plan " + folder.write("s.json", R"({"flotilla_scene": 1,
          "shapes": [{"name": "t", "mass": 1, "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]]}],
          "bodies": [{"name": "a", "shape": "t", "position": [0, 0, )" +
                                                 std::to_string(height) +
                                                 R"(]}, {"name": "b", "shape": "t", "type": "static"}]})"));
        EXPECT_EQ(r.exit_code, 0) << r.err;
        const std::size_t at = r.out.find("impact: ");
        return at == std::string::npos ? r.out : r.out.substr(at, r.out.find('\n', at) - at);
    };
    const double fall = 9.8 / (24 * 24); // m, g dt^2
    char expected[80];
    std::snprintf(expected, sizeof expected, "move by up to %.4g m in step 9, the last before they touch", fall * 8.5);
    EXPECT_NE(first_contact(0.5 * fall * 9.5 * 9.5).find(expected), std::string::npos)
        << first_contact(0.5 * fall * 9.5 * 9.5);
    std::snprintf(expected, sizeof expected, "touch in the first step, in which they are to move by up to %.4g m",
                  fall / 2);
    EXPECT_NE(first_contact(0.25 * fall).find(expected), std::string::npos) << first_contact(0.25 * fall);
    EXPECT_NE(first_contact(-1).find("touch nothing in 240 steps"), std::string::npos) << first_contact(-1);
    const CommandOutput crossing = run_flotilla("plan " + folder.write("x.json", kCrossing));
    EXPECT_EQ(crossing.exit_code, 0) << crossing.err;
    EXPECT_NE(crossing.out.find("some intersect at t = 0"), std::string::npos) << crossing.out;
}

TEST(RunCommand, SaysWhatTheSceneOverridesOfThePreset) {
    const TemporaryFolder folder;
    const std::string scene = (folder.path() / "scene.json").string(), to = (folder.path() / "run").string();
    std::ofstream(scene) << R"({"flotilla_scene": 1, "settings": {"static_tolerance": 0.5},
        "shapes": [{"name": "s", "surface_density": 1, "vertices": [[0,0,0], [1,0,0], [0,1,0]], "triangles": [[0,1,2]]}],
        "bodies": [{"name": "b", "shape": "s", "type": "dynamic", "position": [0,0,0]}]})";
    const std::string run = "run " + scene + " --steps 1 --overwrite --output " + to;
    const CommandOutput r = run_flotilla(run + " --preset accurate");
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE((r.out + r.err).find("the scene sets static_tolerance to 0.5, the preset accurate asks for -1"),
              std::string::npos)
        << r.out << r.err; // and so leaves nothing to the preset's tolerance_share
    const CommandOutput balanced = run_flotilla(run);
    EXPECT_EQ((balanced.out + balanced.err).find("the scene sets"), std::string::npos) << balanced.err;
}

} // namespace
} // namespace flotilla::test
