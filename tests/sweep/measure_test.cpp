// SPDX-License-Identifier: MIT
// What is measured of a run, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "sweep/measure.hpp"
#include "sweep/sweep_scenes.hpp"

namespace flotilla::test {
namespace {

using namespace sweep;

Measures measure_run(const std::filesystem::path& folder, const SceneDescription& scene,
                     const std::filesystem::path& reference = {}) {
    return measure(Problem(scene), scene, folder, reference);
}

TEST(SweepMeasure, FreeFallHasNoErrorAtAnotherTimeStep) {
    const TemporaryFolder folder;
    const auto coarse = folder.path() / "coarse", fine = folder.path() / "fine";
    const std::string scene = cube_scene(0, "[1, 0, 3]", false);
    const SceneDescription ran = run_into(coarse, scene, 10, {{"time_step", "0.04"}});
    run_into(fine, scene, 20, {{"time_step", "0.02"}});
    const Measures m = measure_run(coarse, ran, fine);
    EXPECT_LT(m.values[position], 1e-12) << "constant acceleration is integrated exactly";
    EXPECT_LT(m.values[rotation], 1e-12);
    EXPECT_NEAR(m.values[energy], 0, 1e-9) << "nothing is lost in flight";
    EXPECT_NEAR(m.values[height], 0.5, 1e-12);
    EXPECT_TRUE(std::isnan(m.values[rest_time]));
    EXPECT_EQ(m.values[support], 0);
    EXPECT_GT(m.cost, 0);
}

TEST(SweepMeasure, InterpolatesBetweenFramesOfTheReference) {
    const TemporaryFolder folder;
    const auto a = folder.path() / "a", b = folder.path() / "b";
    const std::string scene = cube_scene(0, "[0, 0, 0]", false);
    const SceneDescription ran = run_into(a, scene, 8, {{"time_step", "0.03"}});
    run_into(b, scene, 12, {{"time_step", "0.02"}});
    // Every other time is halfway between two frames, where a chord is g h^2 / 8 from the parabola.
    EXPECT_NEAR(measure_run(a, ran, b).values[position], 10 * 0.02 * 0.02 / 8 / std::sqrt(2), 1e-12);
}

TEST(SweepMeasure, PoseErrorsAreRootMeanSquaresOverTheRun) {
    const TemporaryFolder folder;
    const auto a = folder.path() / "a", b = folder.path() / "b";
    const SceneDescription ran = run_into(a, cube_scene(0, "[1.5, 0, 0]", false), 10);
    run_into(b, cube_scene(0, "[1, 0, 0]", false), 10);
    double sum = 0;
    for (int k = 1; k <= 10; ++k) sum += std::pow(0.5 * 0.02 * k, 2);
    EXPECT_NEAR(measure_run(a, ran, b).values[position], std::sqrt(sum / 10), 1e-12);
}

TEST(SweepMeasure, RotationsAreComparedByTheirAngle) {
    const TemporaryFolder folder;
    const auto a = folder.path() / "a", b = folder.path() / "b";
    const auto turning = [](const char* speed) {
        std::string scene = cube_scene(0, "[0, 0, 0]", false);
        const std::string at = "\"velocity\"";
        return scene.insert(scene.find(at), std::string("\"angular_velocity\": [0, 0, ") + speed + "], ");
    };
    const SceneDescription ran = run_into(a, turning("2.5"), 10);
    run_into(b, turning("2"), 10);
    double sum = 0;
    for (int k = 1; k <= 10; ++k) sum += std::pow(0.5 * 0.02 * k, 2);
    EXPECT_NEAR(measure_run(a, ran, b).values[rotation], std::sqrt(sum / 10), 1e-9);
}

TEST(SweepMeasure, ADroppedCubeRestsWithItsWeightOnTheGround) {
    const TemporaryFolder folder;
    constexpr double kDrop = 0.44;
    const SceneDescription ran = run_into(folder.path() / "run", cube_scene(0.5 + kDrop), 60);
    const Measures m = measure_run(folder.path() / "run", ran);
    EXPECT_NEAR(m.values[support], 1, 1e-6);
    EXPECT_NEAR(m.values[load], 1, 1e-6) << "one body, one neighbour";
    EXPECT_GT(m.values[rest_time], std::sqrt(2 * kDrop / 10)) << "it falls for so long";
    EXPECT_LT(m.values[rest_time], 1);
    EXPECT_NEAR(m.values[energy], 500 * 10 * kDrop, 0.02 * 500 * 10 * kDrop) << "but for the gap it rests at";
    EXPECT_NEAR(m.values[height], 0.5, 1e-4) << "it lies flat";
    EXPECT_LT(m.values[creep], 1e-6);
    EXPECT_TRUE(std::isnan(m.values[position])) << "no reference";
}

TEST(SweepMeasure, ASlidingCubeRestsWhenFrictionHasStoppedIt) {
    const TemporaryFolder folder;
    const SceneDescription ran =
        run_into(folder.path() / "run", cube_scene(0.506, "[2, 0, 0]"), 40, {{"friction", "0.5"}});
    const Measures m = measure_run(folder.path() / "run", ran);
    const double slow = std::sqrt(2 * 10 * std::sqrt(3) / 330); // m/s, too slow to climb 1/330 of the size
    EXPECT_NEAR(m.values[rest_time], (2 - slow) / (0.5 * 10), 1.5 * 0.02);
    EXPECT_NEAR(m.values[energy], 0.5 * 500 * 4, 0.01 * 500 * 10) << "but for a centimetre of height";
}

TEST(SweepMeasure, TimeToRestIsTheEndOfTheLastMotion) {
    const std::vector<double> times{1, 2, 3, 4, 5};
    EXPECT_EQ(time_to_rest(times, std::vector<double>{0, 0, 0, 0, 0}, 0.5), 0);
    EXPECT_EQ(time_to_rest(times, std::vector<double>{0, 9, 0, 1, 0.5}, 0.5), 5);
    EXPECT_EQ(time_to_rest(times, std::vector<double>{9, 9, 0, 0, 0}, 0.5), 3);
    EXPECT_TRUE(std::isnan(time_to_rest(times, std::vector<double>{0, 0, 0, 0, 1}, 0.5)));
}

TEST(SweepMeasure, ProblemKnowsSizeWeightAndEnergyOfTheStart) {
    const Problem p(parse_scene(cube_scene(3, "[0, 2, 0]"), "scene", "."));
    EXPECT_NEAR(p.size, std::sqrt(3), 1e-6);
    EXPECT_NEAR(p.mass, 500, 1e-9);
    EXPECT_NEAR(p.start_energy, 500 * 10 * 3 + 0.5 * 500 * 4, 1e-6);
    EXPECT_EQ(p.moving.size(), 1u);
}

} // namespace
} // namespace flotilla::test
