// SPDX-License-Identifier: MIT
// What the library refuses, and what its exceptions say besides their text.
#include <flotilla/error.hpp>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <flotilla/html_report.hpp>
#include <flotilla/run.hpp>
#include <flotilla/verify.hpp>

#include "step/scenario.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla::scenario {
namespace {

/// Boxes of 1 m at the given heights, above ground.
SceneDescription boxes(std::initializer_list<double> heights) {
    SceneDescription scene = empty_scene();
    const auto box = add_shape(scene, make_box(1, 1, 1), 10);
    for (const double z : heights) add_body(scene, box, BodyType::dynamic, {0, 0, z});
    return scene;
}

std::string message(const std::function<void()>& call) {
    try {
        call();
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

TEST(Errors, AllHaveOneBase) {
    SceneDescription bad = boxes({1});
    bad.settings.friction = -1;
    EXPECT_THROW(World{bad}, Error);
    EXPECT_THROW(World(boxes({1, 1.5})), Error);
    EXPECT_THROW((void)verify_run("/no such folder"), Error);
    static_assert(std::is_base_of_v<Error, InputError> && std::is_base_of_v<Error, IoError> &&
                  std::is_base_of_v<Error, OverlapError> && std::is_base_of_v<Error, ScriptError> &&
                  std::is_base_of_v<Error, BrokenPromise>);
}

/// But for memory, where the standard library's own fail as well.
TEST(Errors, NoSourceThrowsAnother) {
    int files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(FLOTILLA_SOURCE_DIR "/src")) {
        if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
        std::ifstream in(entry.path());
        for (std::string line; std::getline(in, line);) {
            const auto at = line.find("throw std::");
            EXPECT_TRUE(at == std::string::npos || line.substr(at).starts_with("throw std::bad_"))
                << entry.path() << ": " << line;
        }
        ++files;
    }
    EXPECT_GT(files, 100);
}

TEST(Errors, OfAnOverlapListThePairs) {
    try {
        World(boxes({1, 1.5, 5, 5.5}));
        FAIL();
    } catch (const OverlapError& e) {
        ASSERT_EQ(e.pairs().size(), 2u);
        EXPECT_EQ(e.pairs()[0].a, 0);
        EXPECT_EQ(e.pairs()[0].b, 1);
        EXPECT_EQ(e.pairs()[1].name_a, "body2");
        EXPECT_EQ(e.pairs()[1].name_b, "body3");
        for (const auto& pair : e.pairs()) EXPECT_GT(pair.triangle_pairs, 0);
    }
    SceneDescription cannot = boxes({0});
    const auto plate = add_shape(cannot, make_plate(8, 8)); // closer together than the box is high, beyond its own size
    for (int i = -8; i <= 8; ++i) add_body(cannot, plate, BodyType::fixed, {0, 0, 0.4 * i});
    cannot.settings.initial_overlap = InitialOverlap::separate;
    try {
        World{cannot};
        FAIL();
    } catch (const OverlapError& e) {
        ASSERT_FALSE(e.pairs().empty());
        for (const auto& pair : e.pairs()) EXPECT_EQ(pair.name_a, "body0");
    }
}

TEST(Errors, OfASceneListItsProblems) {
    SceneDescription scene = boxes({1, 3});
    scene.bodies[1].friction = -1;
    scene.bodies[1].velocity.x = std::numeric_limits<double>::quiet_NaN();
    try {
        World{scene};
        FAIL();
    } catch (const InputError& e) {
        ASSERT_EQ(e.problems().size(), 2u);
        EXPECT_EQ(e.problems()[0].where, "/bodies/1/velocity");
        EXPECT_EQ(e.problems()[0].reason, "must be finite");
        EXPECT_EQ(e.problems()[1].where, "/bodies/1/friction");
    }
}

TEST(Errors, ABodyThatIsNotThereIsNamed) {
    const World world(boxes({1, 3}));
    EXPECT_EQ(message([&] { (void)world.body(1); }), "");
    for (const std::size_t index : {std::size_t{2}, std::size_t{1} << 63}) {
        const std::string expected = "body " + std::to_string(index) + " does not exist: there are 2";
        EXPECT_EQ(message([&] { (void)world.body(index); }), expected);
        EXPECT_EQ(message([&] { (void)world.turn(index); }), expected);
        EXPECT_EQ(message([&] { (void)world.way(index); }), expected);
    }
}

TEST(Errors, OfTheEnvironmentNameTheVariable) {
    const SceneDescription scene = boxes({1});
    setenv("FLOTILLA_NUM_THREADS", "none", 1);
    EXPECT_EQ(message([&] { World{scene}; }),
              "environment: FLOTILLA_NUM_THREADS: must be a whole number of 1 to 1024, got \"none\"");
    unsetenv("FLOTILLA_NUM_THREADS");
    EXPECT_EQ(message([&] { World{scene}; }), "");
}

TEST(Errors, NumbersOfThreadsBelowZeroAreRefused) {
    const SceneDescription scene = boxes({1});
    const std::string expected = "-1 threads: must be one or more, or 0 for the default";
    EXPECT_EQ(message([&] { World(scene, "scene", {-1}); }), expected);
    EXPECT_EQ(message([&] { World(scene, "scene", {-1, Executor::serial}); }), expected);
    EXPECT_EQ(message([&] { World(scene, "scene", {1025}); }), "1025 threads: at most 1024 are supported");
    const test::TemporaryFolder folder;
    RunOptions run;
    run.output = folder.path() / "run";
    run.steps = 1;
    static_cast<void>(run_scene(scene, "scene", run));
    VerifyOptions verify;
    EXPECT_TRUE(verify_run(run.output, verify).proved());
    verify.threads = -1;
    EXPECT_EQ(message([&] { (void)verify_run(run.output, verify); }), expected);
    const HtmlReportOptions page{.verification = verify};
    EXPECT_EQ(message([&] { (void)write_html_report(run.output, folder.path() / "run.html", page); }), expected);
    run.overwrite = true;
    run.frame_every = 0;
    EXPECT_EQ(message([&] { (void)run_scene(scene, "scene", run); }), "frame_every must be at least 1, not 0");
}

} // namespace
} // namespace flotilla::scenario
