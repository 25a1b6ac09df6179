// SPDX-License-Identifier: MIT
// Which runs a campaign consists of.
#include <gtest/gtest.h>

#include <flotilla/error.hpp>

#include "sweep/plan.hpp"
#include "sweep/sweep_scenes.hpp"

namespace flotilla::test {
namespace {

using namespace sweep;

class SweepPlan : public ::testing::Test {
  protected:
    SweepPlan() {
        options_.scenes = {folder_.write("cube.json", cube_scene(1))};
        options_.output = folder_.path() / "out";
        options_.steps = 10;
    }
    [[nodiscard]] Plan plan(std::vector<SweepAxis> vary) const {
        SweepOptions options = options_;
        options.vary = std::move(vary);
        return make_plan(options);
    }
    [[nodiscard]] std::string refusal(std::vector<SweepAxis> vary) const {
        try {
            (void)plan(std::move(vary));
        } catch (const InputError& e) {
            return e.what();
        }
        return "accepted";
    }
    TemporaryFolder folder_;
    SweepOptions options_;
};

TEST_F(SweepPlan, IsTheProductOfValuesAndStarts) {
    options_.scenes = {"stack"};
    options_.bodies = 3;
    const Plan p = plan({{"preset", {"preview", "balanced"}}, {"seed", {"1", "2", "3"}}, {"friction", {"0.1", "0.5"}}});
    EXPECT_EQ(p.points.size(), 4u);
    ASSERT_EQ(p.starts.size(), 3u);
    EXPECT_EQ(p.members.size(), 12u);
    EXPECT_EQ(p.axes.size(), 2u) << "seeds are starts";
    EXPECT_EQ(p.points[1].label, "preset=preview friction=0.5");
    EXPECT_EQ(p.points[p.base].label, "preset=balanced friction=0.1") << "what runs where nothing is varied";
    EXPECT_EQ(p.starts[2].name, "stack-seed-3");
    EXPECT_EQ(p.members[4].run.overrides.back(), (std::pair<std::string, std::string>("seed", "2")));
}

TEST_F(SweepPlan, CoversTheSameTimeAtEveryTimeStep) {
    options_.reference = "accurate";
    const Plan p = plan({{"dt", {"0.04", "0.02", "5e-3"}}});
    EXPECT_DOUBLE_EQ(p.duration, 10 * 0.02);
    const auto steps = [&](std::size_t i) { return p.members[i].run.steps; };
    EXPECT_EQ(steps(0), 5);
    EXPECT_EQ(steps(1), 10);
    EXPECT_EQ(steps(2), 40);
    EXPECT_EQ(p.members[2].run.frame_every, 4) << "frames at the times of the scene's own step";
    ASSERT_EQ(p.members.size(), 4u);
    EXPECT_EQ(p.points[3].label, "preset=accurate time_step=0.0025") << "half of the shortest";
    EXPECT_EQ(steps(3), 80);
    EXPECT_EQ(p.reference(), 3u);
    EXPECT_EQ(p.base, 1u);
}

TEST_F(SweepPlan, WritesEveryFrameOfAReferenceWhoseTimesOthersDoNotShare) {
    options_.reference = "accurate";
    const Plan p = plan({{"dt", {"0.02", "0.01"}}});
    EXPECT_EQ(p.members.back().run.frame_every, 4);
    const Plan other = plan({{"dt", {"0.015", "0.01"}}});
    EXPECT_EQ(other.members[0].run.frame_every, 1);
    EXPECT_EQ(other.members[1].run.frame_every, 2);
    EXPECT_EQ(other.members.back().run.frame_every, 1) << "poses between its frames are interpolated";
}

TEST_F(SweepPlan, TakesAReferenceThatIsAmongThePoints) {
    options_.reference = "accurate";
    const Plan p = plan({{"preset", {"preview", "accurate"}}});
    EXPECT_EQ(p.points.size(), 2u);
    EXPECT_EQ(p.reference(), 1u);
}

TEST_F(SweepPlan, InputsDifferExactlyWhereRunsMay) {
    const Plan p = plan({{"friction", {"0.1", "0.2"}}});
    EXPECT_NE(p.members[0].input, p.members[1].input);
    EXPECT_EQ(p.members[0].input, plan({{"friction", {"0.1"}}}).members[0].input);
    options_.steps = 11;
    EXPECT_NE(p.members[0].input, plan({{"friction", {"0.1"}}}).members[0].input);
    options_.steps = 10;
    folder_.write("cube.json", cube_scene(1.5));
    EXPECT_NE(p.members[0].input, plan({{"friction", {"0.1"}}}).members[0].input);
}

TEST_F(SweepPlan, SaysWhatCannotDiffer) {
    const Plan seeds = plan({{"seed", {"1", "2"}}});
    ASSERT_EQ(seeds.notes.size(), 1u);
    EXPECT_NE(seeds.notes[0].find("the seeds change nothing"), std::string::npos);
    options_.overrides = {{"trajectory", "linear"}};
    const Plan fixed = plan({{"preset", {"accurate", "balanced"}}});
    ASSERT_FALSE(fixed.notes.empty());
    EXPECT_NE(fixed.notes[0].find("preset accurate asks for trajectory=rigid"), std::string::npos) << fixed.notes[0];
}

TEST_F(SweepPlan, RefusesNonsenseAllAtOnce) {
    options_.threads = 0;
    const std::string text =
        refusal({{"frction", {"1"}}, {"preset", {"fast"}}, {"friction", {"1", "1.0"}}, {"dt", {"-1"}}});
    EXPECT_NE(text.find("at least one thread"), std::string::npos) << text;
    EXPECT_NE(text.find("\"frction\""), std::string::npos) << text;
    EXPECT_NE(text.find("\"fast\""), std::string::npos) << text;
    EXPECT_NE(text.find("friction has the value 1 twice"), std::string::npos) << text;
    EXPECT_NE(text.find("time_step"), std::string::npos) << text;
    options_.threads = 1;
    EXPECT_NE(refusal({}).find("nothing is varied"), std::string::npos);
    EXPECT_NE(refusal({{"friction", {}}}).find("no values"), std::string::npos);
    EXPECT_NE(refusal({{"dt", {"0.1"}}, {"time_step", {"0.2"}}}).find("varied twice"), std::string::npos);
    options_.overrides = {{"friction", "0.3"}};
    EXPECT_NE(refusal({{"friction", {"0.1"}}}).find("both set and varied"), std::string::npos);
    options_.scenes = {"no-such-scene"};
    EXPECT_NE(refusal({{"friction", {"0.1"}}}).find("neither a scene file nor"), std::string::npos);
}

} // namespace
} // namespace flotilla::test
