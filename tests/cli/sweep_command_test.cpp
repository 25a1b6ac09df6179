// SPDX-License-Identifier: MIT
// flotilla sweep: files, messages and exit codes; the runs are processes.
#include <chrono>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/file.hpp"
#include "run_folder/run_files.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

class SweepCommand : public ::testing::Test {
  protected:
    [[nodiscard]] std::string to(const std::string& name) const {
        return " --output " + (folder_.path() / name).string();
    }
    [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

    TemporaryFolder folder_;
    const std::string stack_ = "sweep stack --bodies 3 --steps 6 ";
};

TEST_F(SweepCommand, PrintsATableAndWritesAFolder) {
    const std::string sweep = stack_ + "--vary preset=preview,balanced --seeds 2 --reference reference" + to("out");
    const CommandOutput r = run_flotilla(sweep);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    for (const char* word : {"preset=preview", "preset=balanced", "preset=reference (reference)", "cost, s", "support"})
        EXPECT_NE(r.out.find(word), std::string::npos) << word << '\n' << r.out;
    EXPECT_NE(r.err.find("run 6 of 6"), std::string::npos) << r.err;
    for (const char* file : {"sweep.csv", "members.csv", "sweep.json", "sweep.html", "scenes/stack-seed-1.json",
                             "members/preset=preview@stack-seed-2/run.json", "members/preset=preview@stack-seed-2.log"})
        EXPECT_TRUE(fs::exists(at("out") / file)) << file;
    EXPECT_EQ(run_flotilla("verify --quiet " + (at("out") / "members/preset=balanced@stack-seed-1").string()).exit_code,
              0);
    EXPECT_EQ(run_flotilla(sweep).exit_code, 2) << "the folder is not empty";
    const CommandOutput again = run_flotilla(sweep + " --resume");
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NE(again.err.find("6 of 6 runs are complete"), std::string::npos) << again.err;
    const CommandOutput quiet = run_flotilla(sweep + " --overwrite --quiet");
    EXPECT_EQ(quiet.exit_code, 0);
    EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(SweepCommand, RefusesWhatMakesNoSense) {
    const auto refused = [&](const std::string& arguments, const std::string& word) {
        const CommandOutput r = run_flotilla(arguments + to("none"));
        EXPECT_EQ(r.exit_code, 2) << arguments << '\n' << r.err;
        EXPECT_NE(r.err.find(word), std::string::npos) << arguments << '\n' << r.err;
        EXPECT_FALSE(fs::exists(at("none"))) << arguments;
    };
    refused(stack_, "nothing is varied");
    refused(stack_ + "--vary friction", "must be key=a,b");
    refused(stack_ + "--vary frction=1,2", "friction");
    refused(stack_ + "--vary friction=1,", "number");
    refused(stack_ + "--vary friction=0.1 --reference best", "best");
    refused(stack_ + "--vary friction=0.1 --metric hight", "height");
    refused(stack_ + "--vary friction=0.1 --metric position", "needs --reference");
    refused(stack_ + "--vary friction=0.1 --time-limit soon", "H:M:S");
    refused("sweep stck --vary friction=0.1", "neither a scene file nor");
    refused("sweep stack --steps 5 --bodies 100000000 --vary friction=0.1", "bodies");
    EXPECT_EQ(run_flotilla(stack_ + "--vary friction=0.1").exit_code, 2) << "no --output";
}

TEST_F(SweepCommand, TimeLimitLeavesACampaignThatGoesOn) {
    const std::string sweep = stack_ + "--vary friction=0.1,0.4" + to("out");
    const CommandOutput r = run_flotilla(sweep + " --time-limit 0:0:0");
    EXPECT_EQ(r.exit_code, 6) << r.err;
    EXPECT_NE(r.err.find("friction=0.1@stack: stopped"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("0 of 2 runs are complete"), std::string::npos) << r.err;
    const CommandOutput on = run_flotilla(sweep + " --resume");
    EXPECT_EQ(on.exit_code, 0) << on.err;
    const auto run = nlohmann::json::parse(io::read_text(at("out") / "members/friction=0.1@stack/run.json"));
    EXPECT_EQ(run.at("status"), "complete");
}

TEST_F(SweepCommand, AnInterruptStopsRunsWithACheckpoint) {
    const std::string arguments =
        "sweep boats-in-bowl --bodies 12 --steps 4000 --vary preset=balanced,accurate --jobs 1";
    RunningFlotilla command(arguments + to("out"));
    const fs::path steps = at("out") / "members/preset=balanced@boats-in-bowl/steps.csv";
    for (int k = 0; k < 3000 && (!fs::exists(steps) || fs::file_size(steps) < 1000); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_TRUE(fs::exists(steps)) << command.output();
    command.send(SIGINT);
    EXPECT_EQ(command.wait(), 6) << command.output();
    EXPECT_NE(command.output().find("0 of 2 runs are complete; --resume goes on"), std::string::npos)
        << command.output();
    const auto json = nlohmann::json::parse(io::read_text(at("out") / "sweep.json"));
    EXPECT_EQ(json.at("members").at("preset=balanced@boats-in-bowl").at("exit_code"), 6);
    EXPECT_EQ(json.at("members").at("preset=accurate@boats-in-bowl").at("begun"), false);
    const CommandOutput on = run_flotilla(arguments + to("out") + " --resume --time-limit 0:0:0");
    EXPECT_EQ(on.exit_code, 6) << on.err;
    std::string log = io::read_text(at("out") / "members/preset=balanced@boats-in-bowl.log");
    EXPECT_EQ(log.find("from the beginning"), std::string::npos) << log;
}

TEST_F(SweepCommand, TellsWhyRunsFailed) {
    const std::string scene = folder_.write("crossing.json", R"({"flotilla_scene": 1,
        "shapes": [{"name": "plate", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "mass": 1}],
        "bodies": [{"name": "a", "shape": "plate"},
                   {"name": "b", "shape": "plate", "position": [0.2, 0.2, -0.1], "rotation": [0.8, 0.6, 0, 0]}]})");
    const CommandOutput r = run_flotilla("sweep " + scene + " --steps 3 --vary friction=0.1,0.4" + to("out"));
    EXPECT_EQ(r.exit_code, 4) << r.err;
    EXPECT_NE(r.err.find("friction=0.4@crossing: failed (4): "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("intersect at t = 0"), std::string::npos) << r.err;
    EXPECT_EQ(r.out, "") << "nothing is complete";
}

TEST_F(SweepCommand, SaysWhichScriptWouldCrushWhat) {
    const CommandOutput r =
        run_flotilla("sweep closing-walls --vary unsatisfiable_script=hold,error --duration 2 --quiet" + to("out"));
    EXPECT_EQ(r.exit_code, 7) << r.err;
    const auto json = nlohmann::json::parse(io::read_text(at("out") / "sweep.json"));
    const std::string reason = json.at("members").at("unsatisfiable_script=error@closing-walls").at("reason");
    EXPECT_NE(reason.find(" cannot go on: it would crush body "), std::string::npos) << reason;
    EXPECT_NE(r.err.find("failed (7): " + reason), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find("--resume"), std::string::npos) << r.err;
    EXPECT_NE(io::read_text(at("out") / "sweep.html").find("it would crush body "), std::string::npos);
}

TEST_F(SweepCommand, ARunThatIsKilledFailsAlone) {
    const std::string err = at("err").string(); // a second of CPU time for every process: enough for the campaign's own
    const std::string line = "ulimit -t 1; " FLOTILLA_COMMAND
                             " sweep boats-in-bowl --bodies 102 --steps 100000 --vary friction=0.1 --threads 1" +
                             to("out") + " >/dev/null 2>" + err;
    const int status = std::system(line.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 1);
    const std::string text = io::read_text(err);
    EXPECT_NE(text.find("friction=0.1@boats-in-bowl: failed (1): ended by signal"), std::string::npos) << text;
    EXPECT_TRUE(fs::exists(at("out") / "sweep.html"));
}

} // namespace
} // namespace flotilla::test
