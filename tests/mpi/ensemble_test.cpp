// SPDX-License-Identifier: MIT
// flotilla-mpi run: ensembles over ranks, some of which are killed.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/step_hashes.hpp"
#include "io/file.hpp"
#include "mpi/ranks.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Ensemble : public ::testing::Test {
  protected:
    [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
    [[nodiscard]] std::string to(const std::string& name) const { return " --output " + at(name).string(); }
    [[nodiscard]] Json summary(const std::string& name) const {
        return Json::parse(io::read_text(at(name) / "ensemble.json"));
    }
    /// What members of the folder say of themselves at the time.
    [[nodiscard]] std::vector<Json> records(const std::string& name) const {
        std::vector<Json> out;
        std::error_code error;
        for (const auto& entry : fs::directory_iterator(at(name) / "members", error))
            if (entry.path().extension() == ".json") out.push_back(Json::parse(io::read_text(entry.path())));
        return out;
    }
    /// Waits until `complete` runs are complete, and kills a rank that runs another one.
    void kill_a_rank(const std::string& name, std::ptrdiff_t complete) const {
        for (int k = 0; k < 6000; ++k) {
            const std::vector<Json> all = records(name);
            const auto in = [](const char* state) { return [state](const Json& r) { return r.at("state") == state; }; };
            const auto runs = std::find_if(all.begin(), all.end(), in("running"));
            if (std::count_if(all.begin(), all.end(), in("complete")) >= complete && runs != all.end()) {
                ::kill(runs->at("holder").at("process").get<pid_t>(), SIGKILL);
                return;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        FAIL() << "no run of " << name << " began";
    }
    void expect_hashes_of_single_runs(const std::string& name) const {
        for (const auto& [member, record] : summary(name).at("members").items()) {
            const std::string scene =
                (at(name) / "scenes" / (record.at("start").get<std::string>() + ".json")).string();
            const std::string steps = std::to_string(record.at("step").get<int>());
            ASSERT_EQ(run_flotilla("run " + scene + " --quiet --steps " + steps + to("single/" + member)).exit_code, 0);
            EXPECT_EQ(step_hashes(at(name) / "members" / member), step_hashes(at("single/" + member))) << member;
            EXPECT_EQ(record.at("state_hash"), step_hashes(at("single/" + member)).back());
        }
    }

    TemporaryFolder folder_;
    const std::string boats_ = "run boats-in-bowl --bodies 22 --steps 40 --seeds 1-16";
    const std::string stack_ = "run stack --bodies 3 --steps 5 ";
};

TEST_F(Ensemble, OneThatIsKilledGoesOnWithTheHashesOfSingleRuns) {
    RunningLine job(ranks_line(2, boats_ + to("out")));
    kill_a_rank("out", 4);
    EXPECT_NE(job.wait(), 0) << "mpirun ends a job that loses a rank";
    const CommandOutput on = run_ranks(3, boats_ + to("out") + " --resume");
    EXPECT_EQ(on.exit_code, 0) << on.err;
    EXPECT_NE(on.err.find("16 of 16 runs are complete"), std::string::npos) << on.err;
    EXPECT_NE(on.err.find("runs are complete and kept"), std::string::npos) << on.err;
    EXPECT_EQ(summary("out").at("members").size(), 16U);
    EXPECT_EQ(summary("out").at("job"), 2);
    expect_hashes_of_single_runs("out");
}

TEST_F(Ensemble, OtherRanksTakeOverFromOneThatIsLost) {
    RunningLine job(ranks_line(3, boats_ + to("out"), "--enable-recovery"));
    kill_a_rank("out", 2);
    job.wait(); // the exit code is mpirun's own affair
    const Json members = summary("out").at("members");
    int lost = 0;
    for (const Json& member : members) {
        EXPECT_EQ(member.at("state"), "complete") << member;
        lost += static_cast<int>(member.at("lost").size());
    }
    EXPECT_EQ(members.size(), 16U);
    EXPECT_EQ(lost, 1);
    EXPECT_NE(job.output().find("was lost while it ran"), std::string::npos) << job.output();
    expect_hashes_of_single_runs("out");
}

TEST_F(Ensemble, SeedsAndSettingsAreCombined) {
    const CommandOutput r = run_ranks(2, stack_ + "--seeds 3,5-6 --vary friction=0.1,0.4" + to("out"));
    EXPECT_EQ(r.exit_code, 0) << r.err;
    const std::string table = io::read_text(at("out") / "ensemble.csv");
    EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 7) << table;
    EXPECT_EQ(table.find("member,start,seed,friction,state,step,time,energy,"), 0U) << table;
    EXPECT_NE(table.find("friction=0.4@stack-seed-5,stack-seed-5,5,0.4,complete,5,"), std::string::npos) << table;
    EXPECT_EQ(run_flotilla("verify --quiet " + (at("out") / "members/friction=0.1@stack-seed-3").string()).exit_code,
              0);
    EXPECT_EQ(run_ranks(2, stack_ + "--seeds 3,5-6 --vary friction=0.1,0.4" + to("out")).exit_code, 2);
    const CommandOutput more = run_ranks(1, stack_ + "--seeds 3-7 --vary friction=0.1,0.4 --resume" + to("out"));
    EXPECT_EQ(more.exit_code, 0) << more.err;
    EXPECT_NE(more.err.find("6 of 10 runs are complete and kept"), std::string::npos) << more.err;
    const CommandOutput other = run_ranks(2, stack_ + "--seeds 3 --vary friction=0.1 --dt 0.01 --resume" + to("out"));
    EXPECT_EQ(other.exit_code, 2) << other.err;
    EXPECT_NE(other.err.find("--overwrite starts anew"), std::string::npos) << other.err;
    EXPECT_EQ(run_ranks(2, stack_ + "--seeds 3 --vary friction=0.1 --dt 0.01 --overwrite" + to("out")).exit_code, 0);
}

TEST_F(Ensemble, RefusesWhatMakesNoSense) {
    const auto refused = [&](const std::string& arguments, const std::string& word) {
        const CommandOutput r = run_ranks(2, arguments);
        EXPECT_EQ(r.exit_code, 2) << arguments << '\n' << r.err;
        EXPECT_NE(r.err.find(word), std::string::npos) << arguments << '\n' << r.err;
        EXPECT_EQ(r.err.find(word), r.err.rfind(word)) << "one rank says it\n" << r.err;
    };
    refused(stack_ + "--seeds 1-x" + to("none"), "must be N, FIRST-LAST");
    refused(stack_ + "--seeds 5-1" + to("none"), "5-1 is empty");
    refused(stack_ + "--seeds 2 --vary frction=1" + to("none"), "frction");
    refused(stack_ + "--seeds 2", "an ensemble needs --output");
    refused("run stack --seed 2", "--seed");
}

TEST_F(Ensemble, TellsWhatFailedAndGoesOnWithTheRest) {
    const std::string scene = folder_.write("crossing.json", R"({"flotilla_scene": 1,
        "shapes": [{"name": "plate", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "mass": 1}],
        "bodies": [{"name": "a", "shape": "plate"},
                   {"name": "b", "shape": "plate", "position": [0.2, 0.2, -0.1], "rotation": [0.8, 0.6, 0, 0]}]})");
    const CommandOutput r = run_ranks(2, "run stack " + scene + " --steps 3 --vary friction=0.1,0.4" + to("out"));
    EXPECT_EQ(r.exit_code, 4) << r.err;
    EXPECT_NE(r.err.find("friction=0.4@crossing: failed: "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("2 of 4 runs are complete"), std::string::npos) << r.err;
}

TEST_F(Ensemble, ATimeLimitIsThatOfARun) {
    const std::string two = stack_ + "--seeds 2" + to("out");
    const CommandOutput r = run_ranks(2, two + " --time-limit 0:0:0");
    EXPECT_EQ(r.exit_code, 6) << r.err;
    EXPECT_NE(r.err.find("0 of 2 runs are complete; --resume goes on"), std::string::npos) << r.err;
    EXPECT_EQ(run_ranks(2, two + " --resume").exit_code, 0);
}

} // namespace
} // namespace flotilla::test
