// SPDX-License-Identifier: MIT
// Whole campaigns, with runs inside this process.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "parallel/threads.hpp"
#include "sweep/sweep_scenes.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

class SweepCampaign : public ::testing::Test {
  protected:
    SweepCampaign() {
        options_.scenes = {folder_.write("cube.json", cube_scene(0.7))};
        options_.output = folder_.path() / "out";
        options_.steps = 30;
        options_.reference = "reference";
        options_.vary = {{"time_step", {"0.04", "0.02"}}, {"friction", {"0.1", "0.5"}}};
        options_.run = [this](const SweepMember& member) {
            {
                const std::lock_guard held(lock_);
                ran_.insert(member.name);
            }
            return run_here(member);
        };
        options_.note = [this](const std::string& text) { notes_ += text + '\n'; };
    }
    /// How many runs were made.
    std::size_t runs() {
        ran_.clear();
        notes_.clear();
        report_ = run_sweep(options_);
        return ran_.size();
    }
    std::string refusal() {
        try {
            (void)run_sweep(options_);
        } catch (const InputError& e) {
            return e.what();
        }
        return "accepted";
    }
    TemporaryFolder folder_;
    SweepOptions options_;
    SweepReport report_;
    std::mutex lock_;
    std::set<std::string> ran_;
    std::string notes_;
};

TEST_F(SweepCampaign, MakesEveryRunAndWritesWhatItFound) {
    EXPECT_EQ(runs(), 5u);
    EXPECT_EQ(report_.exit_code, 0);
    EXPECT_EQ(report_.complete, 5u);
    EXPECT_TRUE(report_.problems.empty());
    EXPECT_FALSE(report_.advice.empty());
    const auto json = nlohmann::json::parse(io::read_text(options_.output / "sweep.json"));
    EXPECT_EQ(json.at("members").size(), 5u);
    EXPECT_EQ(json.at("results").at("points").size(), 5u);
    const std::string csv = io::read_text(options_.output / "sweep.csv"),
                      members = io::read_text(options_.output / "members.csv"),
                      html = io::read_text(options_.output / "sweep.html");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 6);
    EXPECT_EQ(std::count(members.begin(), members.end(), '\n'), 6);
    const auto columns = std::count(csv.begin(), std::find(csv.begin(), csv.end(), '\n'), ',');
    EXPECT_EQ(std::count(csv.begin(), csv.end(), ','), 6 * columns) << csv;
    EXPECT_NE(html.find("<svg"), std::string::npos);
    EXPECT_NE(html.find(report_.advice.front().substr(0, 13)), std::string::npos);
    for (const char* outside : {"src=", "href=", "<script", "@import"})
        EXPECT_EQ(html.find(outside), std::string::npos) << "not self-contained";
}

TEST_F(SweepCampaign, KeepsWhatIsThereAndAddsWhatIsNew) {
    EXPECT_EQ(runs(), 5u);
    EXPECT_NE(refusal().find("not empty"), std::string::npos);
    options_.resume = true;
    EXPECT_EQ(runs(), 0u);
    EXPECT_NE(notes_.find("5 of 5 runs are complete"), std::string::npos) << notes_;
    options_.vary[1].values.emplace_back("0.9");
    EXPECT_EQ(runs(), 2u);
    EXPECT_EQ(report_.points.size(), 7u);
    options_.vary.pop_back();
    EXPECT_EQ(runs(), 2u) << "points of one axis have other names";
    EXPECT_NE(notes_.find("stay there"), std::string::npos) << notes_;
    options_.resume = false;
    options_.overwrite = true;
    EXPECT_EQ(runs(), 3u);
}

TEST_F(SweepCampaign, RefusesToMixOtherRuns) {
    EXPECT_EQ(runs(), 5u);
    options_.resume = true;
    folder_.write("cube.json", cube_scene(0.8));
    EXPECT_NE(refusal().find("was run with another scene"), std::string::npos);
    folder_.write("cube.json", cube_scene(0.7));
    options_.overrides = {{"restitution", "0.2"}};
    EXPECT_NE(refusal().find("other settings"), std::string::npos);
    options_.overrides.clear();
    options_.steps = 40;
    EXPECT_NE(refusal().find("not of"), std::string::npos);
    options_.steps = 30;
    options_.threads = 2;
    EXPECT_NE(refusal().find("threads"), std::string::npos);
    options_.threads = 1;
    EXPECT_EQ(runs(), 0u);
}

TEST_F(SweepCampaign, OutlivesRunsThatFailAndMakesThemAgain) {
    const auto good = options_.run;
    options_.run = [&](const SweepMember& member) {
        return member.name.find("friction=0.5") != std::string::npos ? SweepOutcome{4, "bodies intersect", 0.1}
                                                                     : good(member);
    };
    EXPECT_EQ(runs(), 3u);
    EXPECT_EQ(report_.exit_code, 4);
    EXPECT_EQ(report_.complete, 3u);
    ASSERT_EQ(report_.problems.size(), 2u);
    EXPECT_NE(report_.problems[0].find("failed (4): bodies intersect"), std::string::npos) << report_.problems[0];
    options_.run = good;
    options_.resume = true;
    EXPECT_EQ(runs(), 2u);
    EXPECT_EQ(report_.exit_code, 0);
}

TEST_F(SweepCampaign, StopsBetweenRunsAndSaysSo) {
    std::atomic<int> begun{0};
    const auto good = options_.run;
    options_.jobs = 1;
    options_.run = [&](const SweepMember& member) {
        ++begun;
        return good(member);
    };
    options_.stop = [&] { return begun >= 2; };
    EXPECT_EQ(runs(), 2u);
    EXPECT_EQ(report_.exit_code, 6);
    EXPECT_TRUE(report_.stopped);
    EXPECT_TRUE(fs::exists(options_.output / "sweep.html"));
    options_.stop = nullptr;
    options_.resume = true;
    EXPECT_EQ(runs(), 3u);
    EXPECT_EQ(report_.exit_code, 0);
}

TEST_F(SweepCampaign, MakesAsManyRunsAtATimeAsItIsTold) {
    const auto good = options_.run;
    for (const int jobs : {1, 2}) {
        const int expected = std::min(jobs, usable_cores());
        std::atomic<int> active{0}, most{0};
        options_.output = folder_.path() / std::to_string(jobs);
        options_.jobs = jobs;
        options_.run = [&](const SweepMember& member) {
            const int now = ++active;
            for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
            }
            for (int k = 0; k < 1000 && most < expected; ++k)
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
            const SweepOutcome outcome = good(member);
            --active;
            return outcome;
        };
        EXPECT_EQ(runs(), 5u);
        EXPECT_EQ(most, expected);
    }
}

TEST_F(SweepCampaign, TakesCpuTimeForStepsThatWaitedForACore) {
    options_.vary.pop_back();
    const auto good = options_.run;
    options_.run = [&](const SweepMember& member) {
        (void)good(member);
        return SweepOutcome{0, "", 1e-9};
    };
    EXPECT_EQ(runs(), 3u);
    EXPECT_DOUBLE_EQ(report_.points[0].cost.mean, 1e-9);
    ASSERT_EQ(report_.remarks.size(), 1u);
    EXPECT_NE(report_.remarks[0].find("3 runs had to wait"), std::string::npos) << report_.remarks[0];
}

TEST_F(SweepCampaign, SmallerTimeStepsAreNearerToTheReference) {
    std::string scene = cube_scene(1.3, "[2, 0, 0]");
    const std::string plastic = "\"restitution\": 0";
    scene.replace(scene.find(plastic), plastic.size(), "\"restitution\": 0.5"); // when it bounces is of first order
    folder_.write("cube.json", scene);
    options_.vary = {{"time_step", {"0.04", "0.01"}}};
    options_.metrics = {"position"};
    EXPECT_EQ(runs(), 3u);
    ASSERT_EQ(report_.metrics.size(), 1u);
    const double coarse = report_.points[0].errors[0].mean, fine = report_.points[1].errors[0].mean;
    EXPECT_LT(fine, coarse / 2);
    EXPECT_GT(fine, 0);
    options_.metrics = {"postion"};
    EXPECT_NE(refusal().find("did you mean"), std::string::npos) << refusal();
}

} // namespace
} // namespace flotilla::test
