// SPDX-License-Identifier: MIT
// Errors, front and advice from figures that are made up.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "sweep/judge.hpp"
#include "sweep/sweep_scenes.hpp"

namespace flotilla::test {
namespace {

using namespace sweep;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Measures made_up(double cost, std::size_t metric, double value) {
    Measures m{cost, std::vector<double>(kMetrics, kNone)};
    m.values[metric] = value;
    return m;
}

/// Two axes of two values and a reference of its own.
Plan two_by_two(std::size_t starts) {
    Plan plan;
    plan.axes = {{"friction", {"0.1", "0.2"}}, {"time_step", {"0.04", "0.02"}}};
    for (const char* f : {"0.1", "0.2"})
        for (const char* dt : {"0.04", "0.02"}) {
            Point point;
            point.label = std::string(f) + " " + dt;
            point.values = {f, dt};
            plan.points.push_back(point);
        }
    Point reference;
    reference.label = "truth";
    reference.reference = reference.own = true;
    plan.points.push_back(reference);
    plan.starts.resize(starts);
    plan.duration = 1;
    return plan;
}

SweepReport judged(const Plan& plan, const Measured& measured, const std::vector<std::size_t>& wanted = {}) {
    SweepReport report;
    report.axes = plan.axes;
    report.starts.resize(plan.starts.size());
    const Problem problem(parse_scene(cube_scene(1), "scene", "."));
    report.size = problem.size;
    judge(plan, problem, measured, wanted, report);
    return report;
}

TEST(SweepJudge, MeanAndSpreadLeaveOutWhatIsMissing) {
    const SweepValue v = statistics({1, kNone, 3, 5});
    EXPECT_EQ(v.starts, 3);
    EXPECT_EQ(v.mean, 3);
    EXPECT_EQ(v.spread, 2);
    EXPECT_EQ(statistics({7}).spread, 0);
    EXPECT_TRUE(std::isnan(statistics({kNone}).mean));
}

TEST(SweepJudge, ErrorsAreTakenStartByStart) {
    const SweepMetric& of_height = sweep_metrics()[height];
    // What the starts differ by is in both runs and is no error.
    const SweepValue error = error_of(of_height, {1.5, 11.5, 21.5}, {1, 11, 21});
    EXPECT_DOUBLE_EQ(error.mean, 0.5);
    EXPECT_NEAR(error.spread, 0, 1e-15);
    const SweepValue scattered = error_of(of_height, {2, 0, 2, 0}, {0, 0, 0, 0});
    EXPECT_DOUBLE_EQ(scattered.mean, 1);
    EXPECT_DOUBLE_EQ(scattered.spread, std::sqrt(4.0 / 3) / 2) << "standard deviation by root of 4";
    EXPECT_FALSE(within_chance({1, 0.4, 4}));
    EXPECT_TRUE(within_chance({1, 0.6, 4}));
    EXPECT_EQ(error_of(sweep_metrics()[creep], {0.25}, {kNone}).mean, 0.25) << "its truth is zero";
    EXPECT_EQ(error_of(of_height, {0.25}, {kNone}).starts, 0);
}

TEST(SweepJudge, TheFrontIsWhatNothingBeatsAndTheLargestGainComesFirst) {
    const Plan plan = two_by_two(1);
    const Measured measured{{made_up(1, position, 8e-3)},
                            {made_up(2, position, 1e-3)},
                            {made_up(0.5, position, 8e-3)},
                            {made_up(3, position, 2e-3)},
                            {made_up(9, position, 0)}};
    const SweepReport r = judged(plan, measured);
    ASSERT_EQ(r.metrics[r.headline].name, "position");
    EXPECT_FALSE(r.chaotic);
    EXPECT_FALSE(r.points[0].on_front) << "friction 0.2 costs less at the same error";
    EXPECT_TRUE(r.points[1].on_front);
    EXPECT_TRUE(r.points[2].on_front);
    EXPECT_FALSE(r.points[3].on_front);
    EXPECT_FALSE(r.points[4].on_front) << "the reference is no choice";
    ASSERT_EQ(r.changes.size(), 2u);
    EXPECT_EQ(r.changes[0].key, "time_step");
    EXPECT_NEAR(r.changes[0].gain, std::log(8.0 / 2), 1e-12) << "an eighth of the error for twice the cost";
    EXPECT_EQ(r.changes[1].key, "friction");
    EXPECT_NEAR(r.changes[1].gain, std::log(2.0), 1e-12);
    EXPECT_EQ(r.advice.front(),
              "Change first: time_step from 0.04 to 0.02: error of position 0.008 m -> 0.001 m (/ 8), "
              "cost 1 s -> 2 s (x 2)");
    EXPECT_NE(r.advice[1].find("Cheapest without more error: friction from 0.1 to 0.2"), std::string::npos);
}

TEST(SweepJudge, EqualTermsAndNoiseAreNoReasonToChange) {
    const Plan plan = two_by_two(1);
    const Measured measured{{made_up(1, position, 8e-3)},
                            {made_up(2, position, 4e-3)},
                            {made_up(0.95, position, 8e-3)},
                            {made_up(1.9, position, 4e-3)},
                            {made_up(9, position, 0)}};
    const SweepReport r = judged(plan, measured);
    EXPECT_EQ(r.advice.front().find("Change nothing first"), 0u) << r.advice.front();
    for (const SweepChange& c : r.changes) EXPECT_NEAR(c.gain, 0, 1e-12) << c.key;
}

TEST(SweepJudge, WhereRunsPartHeightCountsAndChanceIsNoGain) {
    const Plan plan = two_by_two(2);
    const auto start = [](double cost, double far, double high) {
        Measures m = made_up(cost, position, far);
        m.values[height] = high;
        return std::optional<Measures>(m);
    };
    const Measured measured{{start(1, 1, 2.00), start(1, 1, 2.30)},
                            {start(2, 1, 2.12), start(2, 1, 2.10)}, // the mean is nearer, but by less than chance
                            {start(1, 1, 2.50), start(1, 1, 2.52)},
                            {start(2, 1, 2.10), start(2, 1, 2.10)},
                            {start(9, 0, 2.10), start(9, 0, 2.10)}};
    const SweepReport r = judged(plan, measured);
    EXPECT_TRUE(r.chaotic);
    EXPECT_EQ(r.metrics[r.headline].name, "height");
    for (const SweepChange& c : r.changes) {
        const bool within_the_spread = c.key == "time_step";
        EXPECT_EQ(c.error_ratio == 1, within_the_spread) << c.key << ' ' << c.error_ratio;
    }
    EXPECT_EQ(judged(plan, measured, {position}).headline, 0u) << "asked for";
}

TEST(SweepJudge, IncompleteRunsAndMissingReferencesLeaveFiguresOut) {
    const Plan plan = two_by_two(1);
    Measured measured{
        {made_up(1, residual, 1e-3)}, {std::nullopt}, {made_up(1, residual, 1e-5)}, {std::nullopt}, {std::nullopt}};
    const SweepReport r = judged(plan, measured);
    EXPECT_EQ(r.metrics[r.headline].name, "residual");
    EXPECT_EQ(r.points[1].complete, 0);
    ASSERT_EQ(r.changes.size(), 1u);
    EXPECT_EQ(r.changes[0].key, "friction");
    for (auto& point : measured) point[0].reset();
    EXPECT_EQ(judged(plan, measured).advice.front().find("No advice"), 0u);
}

} // namespace
} // namespace flotilla::test
