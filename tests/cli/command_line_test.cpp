// SPDX-License-Identifier: MIT
// What the command prints about itself and about command lines that it does not understand.
#if defined(__linux__)
#include <sched.h>
#endif

#include <gtest/gtest.h>

#include <regex>
#include <utility>

#include <flotilla/build_info.hpp>

#include "support/command.hpp"

namespace flotilla::test {
namespace {

/// Lines of text: no byte below a space but the line's end.
bool is_text(const std::string& bytes) {
    for (const char c : bytes)
        if (c != '\n' && static_cast<unsigned char>(c) < ' ') return false;
    return true;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string boats(const TemporaryFolder& folder) {
    return folder.write("boats.json", run_flotilla("scene boats-in-bowl --bodies 12 --seed 3").out);
}

TEST(CommandLine, HelpAndComplaintsAreText) {
    const CommandOutput all = run_flotilla("--help");
    EXPECT_EQ(all.exit_code, 0);
    for (const char* name : {"ccd", "check", "compare", "export", "info", "picture", "plan", "report", "run", "scene",
                             "trace", "verify"}) {
        EXPECT_TRUE(contains(all.out, std::string("\n  ") + name + " ")) << name;
        const CommandOutput help = run_flotilla(std::string(name) + " --help");
        EXPECT_EQ(help.exit_code, 0) << name;
        EXPECT_TRUE(is_text(help.out)) << help.out;
    }
    for (const char* line : {"ccd f.csv --method exact", "verify d --motion some", "trace f.json --growth slow",
                             "export d --format stl"}) {
        const CommandOutput refused = run_flotilla(line);
        EXPECT_EQ(refused.exit_code, 2) << line;
        EXPECT_TRUE(is_text(refused.err)) << refused.err;
    }
    EXPECT_TRUE(contains(run_flotilla("export d --format stl").err, "stl not in {csv,vtp,obj,glb,usd}"));
    EXPECT_TRUE(contains(run_flotilla("export --help").out, "{csv,vtp,obj,glb,usd}=csv"));
}

TEST(CommandLine, VersionSaysWhatTheCommandWasBuiltFrom) {
    const CommandOutput r = run_flotilla("--version");
    const BuildInfo build = build_info();
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_TRUE(r.out.starts_with("flotilla " + std::string(build.version) + "\ncommit:   ")) << r.out;
    for (const std::string_view part :
         {build.compiler, build.flags}) // the commit may be newer than a test that was not built again
        EXPECT_TRUE(contains(r.out, std::string(part))) << r.out;
}

TEST(CommandLine, UnknownWordsNameTheNearestKnownOne) {
    for (const auto& [line, complaint] :
         {std::pair{"rn", "unknown command \"rn\"; did you mean \"run\"?"},
          {"exprot --format obj d", "unknown command \"exprot\"; did you mean \"export\"?"},
          {"simulate s.json", "unknown command \"simulate\" (flotilla --help lists them)"},
          {"scene stak", "unknown scene \"stak\"; did you mean \"stack\"?"},
          {"scene bowl", "unknown scene \"bowl\"; did you mean \"boats-in-bowl\"?"}}) {
        const CommandOutput r = run_flotilla(line);
        EXPECT_EQ(r.exit_code, 2) << line;
        EXPECT_EQ(r.out, "") << line;
        EXPECT_TRUE(contains(r.err, complaint)) << r.err;
    }
    EXPECT_EQ(run_flotilla("").exit_code, 2);
}

TEST(CommandLine, NumbersThatAreNoneAreRefused) {
    const TemporaryFolder folder;
    const std::string run = "run " + folder.write("stack.json", run_flotilla("scene stack").out) + " ";
    for (const auto& [line, complaint] :
         {std::pair{run + "--steps 99999999999999999999", "--steps: 99999999999999999999 is too large"},
          {run + "--steps -1", "--steps: -1 must be 0 or more"},
          {run + "--dt nan", "--dt: nan is not a finite number"},
          {run + "--dt inf", "--dt: inf is not a finite number"},
          {run + "--dt 0", "--dt: 0 must be above 0"},
          {run + "--duration nan", "--duration: nan is not a finite number"},
          {run + "--duration 1e300", "s are too many steps"},
          {run + "--threads 0", "--threads: 0 must be above 0"},
          {run + "--output ''", "--output: a name must be given"},
          {std::string("verify stack.json --poses ''"), "--poses: a name must be given"},
          {std::string("scene stack --seed 99999999999999999999"), "--seed: 99999999999999999999 is too large"},
          {std::string("sweep stack --dt nan --output x"), "--dt: nan is not a finite number"}}) {
        const CommandOutput r = run_flotilla(line);
        EXPECT_EQ(r.exit_code, 2) << line;
        EXPECT_EQ(r.out, "") << line;
        EXPECT_TRUE(contains(r.err, complaint)) << r.err;
    }
}

TEST(CommandLine, ScenesComeFromStandardInputToo) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", run_flotilla("scene stack").out);
    const std::string to = (folder.path() / "run").string();
    const std::string run = "run - --steps 2 --output " + to;
    const CommandOutput piped = run_flotilla(run + " <" + scene), file = run_flotilla("run --steps 2 " + scene);
    ASSERT_EQ(piped.exit_code, 0) << piped.err;
    const auto hash = [](const CommandOutput& r) { return r.out.substr(r.out.find("state hash: "), 28); };
    ASSERT_TRUE(contains(piped.out, "state hash: ")) << piped.out;
    EXPECT_EQ(hash(piped), hash(file));
    EXPECT_EQ(bytes_of(folder.path() / "run" / "scene.json"), bytes_of(scene));
    EXPECT_EQ(run_flotilla("run - --steps 3 --resume --quiet --output " + to + " <" + scene).exit_code, 0);
    EXPECT_EQ(run_flotilla("check - <" + scene).out, run_flotilla("check " + scene).out);
    EXPECT_EQ(run_flotilla("plan - <" + scene).out, run_flotilla("plan " + scene).out);
    const CommandOutput nothing = run_flotilla("run - --steps 1");
    EXPECT_EQ(nothing.exit_code, 2);
    EXPECT_TRUE(nothing.err.starts_with("flotilla: standard input: ")) << nothing.err;
}

TEST(RunCommand, ProgressShowsTheMeanOfTheLastSteps) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", run_flotilla("scene falling-boats").out);
    const CommandOutput r = run_flotilla("run --steps 3 --threads 1 " + scene);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    std::smatch shown;
    ASSERT_TRUE(std::regex_search(r.err, shown, std::regex("step 3 of 3, .* mean ([0-9.e-]+) ms/step, "))) << r.err;
    const double mean = std::stod(shown[1]);
    ASSERT_TRUE(std::regex_search(r.out, shown, std::regex("time per step: mean ([0-9.]+) ms"))) << r.out;
    EXPECT_GT(mean, 0);
    EXPECT_NEAR(mean, std::stod(shown[1]), 0.05 * mean + 0.005) << "two digits of one, two decimals of the other";
}

TEST(RunCommand, SaysWhereNothingIsKept) {
    const TemporaryFolder folder;
    const std::string run = "run --steps 1 " + boats(folder), in = folder.path().string(),
                      kept = "nothing of this run is kept";
    EXPECT_TRUE(contains(run_flotilla(run).err, kept));
    EXPECT_FALSE(contains(run_flotilla(run + " --quiet").err, kept));
    EXPECT_FALSE(contains(run_flotilla(run + " --output " + in + "/run").err, kept));
    EXPECT_FALSE(contains(run_flotilla(run + " --contacts " + in + "/contacts.csv").err, kept));
}

TEST(RunCommand, QuietIsQuietButForProblems) {
    const TemporaryFolder folder;
    const std::string scene = boats(folder), to = (folder.path() / "run").string();
    const std::string run = "run --quiet --steps 3 --output " + to + " " + scene;
    for (const std::string& line : {run, "run --quiet --steps 3 " + scene, "report --quiet --verify " + to}) {
        const CommandOutput r = run_flotilla(line);
        EXPECT_EQ(r.exit_code, 0) << line;
        EXPECT_EQ(r.out + r.err, "") << line;
    }
    const CommandOutput again = run_flotilla(run);
    EXPECT_EQ(again.exit_code, 2);
    EXPECT_NE(again.err, "");
}

#if defined(__linux__)
// Where there is one core nothing is left for the threads that write files.
TEST(RunCommand, QuietIsQuietOnOneCore) {
    const TemporaryFolder folder;
    const std::string scene = boats(folder);
    cpu_set_t all, one;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0); // the command inherits it
    const CommandOutput r =
        run_flotilla("run --quiet --steps 3 --output " + (folder.path() / "run").string() + " " + scene);
    ASSERT_EQ(sched_setaffinity(0, sizeof all, &all), 0);
    EXPECT_EQ(r.exit_code, 0);
    EXPECT_EQ(r.out + r.err, "");
}
#endif

TEST(RunCommand, PhaseTableSaysWhichTimesAreSumsOverThreads) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", run_flotilla("scene stack").out);
    const CommandOutput r = run_flotilla("run --steps 3 --threads 2 " + scene);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const auto matches = [&](const char* line) { return std::regex_search(r.out, std::regex(line)); };
    EXPECT_TRUE(matches("slowest .* ms; wall time of its stages:\n  stage")) << r.out;
    EXPECT_TRUE(matches("\n  stage7_static_contact +[0-9.]+ ms\n")) << r.out;
    EXPECT_TRUE(matches("\nof these:\n  ")) << r.out;
    EXPECT_TRUE(matches("\n  static_response +[0-9.]+ ms, stages 3 and 7, wall time\n")) << r.out;
    EXPECT_FALSE(matches("\n  (static_)?(detection|response) +[0-9.]+ ms\n")) << r.out;
    EXPECT_TRUE(std::regex_search(run_flotilla("run --steps 30 --threads 2 " + boats(folder)).out,
                                  std::regex("\n  detection +[0-9.]+ ms, stages 1 and 5, sum over threads\n")));
}

} // namespace
} // namespace flotilla::test
