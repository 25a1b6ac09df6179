// SPDX-License-Identifier: MIT
// Runs whose steps are made of inner ones: the folder holds what these did, and verify_run looks at it.
#include <functional>

#include <flotilla/error.hpp>
#include <flotilla/run.hpp>
#include <flotilla/run_folder.hpp>
#include <flotilla/verify.hpp>

#include "run_folder/run_folder.hpp"
#include "step/scenario.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

using namespace scenario;

constexpr int kSubsteps = 4;
constexpr std::int32_t kBall = 1, kSpinner = 2;

/// A thin plate, a ball that falls on it, and a body that makes more than a turn in a step.
SceneDescription ball_and_plate(Trajectory trajectory) {
    SceneDescription scene = empty_scene();
    scene.settings.substeps = kSubsteps;
    scene.settings.trajectory = trajectory;
    add_body(scene, add_shape(scene, make_plate(4, 4)), BodyType::fixed, {});
    add_body(scene, add_shape(scene, make_sphere(0.3, 1), 2), BodyType::dynamic, {0.1, 0, 1}).velocity = {0, 0, -3};
    add_body(scene, add_shape(scene, make_box(0.3, 0.2, 0.1), 1), BodyType::dynamic, {9, 0, 5}).angular_velocity = {
        0, 0, 400};
    return scene;
}

class SubstepsRun : public testing::TestWithParam<Trajectory> {
  protected:
    static constexpr int kSteps = 12;

    flotilla::RunTotals run(const std::string& name, int steps = kSteps,
                            const std::function<void(RunOptions&)>& change = {}) {
        RunOptions options;
        options.output = folder(name);
        options.steps = steps;
        if (change) change(options);
        return run_scene(ball_and_plate(GetParam()), "scene", options);
    }
    [[nodiscard]] std::filesystem::path folder(const std::string& name) const { return temporary_.path() / name; }

    /// A copy of a run whose ways are changed.
    void copy(const std::string& from, const std::string& to, const std::function<void(std::int64_t, io::Way&)>& edit) {
        io::RunReader reader(folder(from));
        io::RunInfo info = reader.info();
        info.scene_json = "{}";
        io::RunWriter writer(folder(to), info, reader.scene(), io::OpenRun::create);
        for (std::int64_t k = 0; k < reader.frames(); ++k) {
            const io::Frame f = reader.frame(k);
            io::Way way = reader.way(k);
            edit(k, way);
            std::vector<Vec3> turns;
            if (k > 0) turns = io::path_rotations(last_of(reader, k), f);
            writer.add_frame({f.step, f.time, f.position, f.rotation, f.velocity, f.angular_velocity, turns, {}, &way});
        }
        writer.close("complete");
    }
    /// Where frame k's last inner step began.
    static io::Frame last_of(io::RunReader& reader, std::int64_t k) {
        return io::inner_frames(reader.frame(k - 1), reader.frame(k), reader.way(k)).back();
    }
    static std::size_t place(int inner, std::int32_t body) { return static_cast<std::size_t>(3 * inner + body); }

  private:
    test::TemporaryFolder temporary_;
};

INSTANTIATE_TEST_SUITE_P(Paths, SubstepsRun, testing::Values(Trajectory::linear, Trajectory::rigid),
                         [](const auto& path) { return path.param == Trajectory::rigid ? "rigid" : "linear"; });

TEST_P(SubstepsRun, IsProvedAlongTheWaysThatItsFramesHold) {
    (void)run("run");
    io::RunReader reader(folder("run"));
    EXPECT_EQ(reader.info().substeps, kSubsteps);
    World world(ball_and_plate(GetParam()));
    for (std::int64_t k = 1; k <= kSteps; ++k) {
        (void)world.step();
        const auto inner = io::inner_frames(reader.frame(k - 1), reader.frame(k), reader.way(k));
        ASSERT_EQ(inner.size(), kSubsteps - 1u);
        io::Frame before = reader.frame(k - 1);
        for (std::size_t i = 0; i < world.size(); ++i) {
            const std::vector<WayPoint> way = world.way(i);
            for (std::size_t j = 0; j + 1 < way.size(); ++j) {
                EXPECT_EQ(inner[j].position[i], way[j].position);
                EXPECT_EQ(inner[j].rotation[i], way[j].rotation);
            }
        }
        for (std::size_t j = 0; j + 1 < kSubsteps; ++j) {
            const std::vector<Vec3> turns = io::path_rotations(before, inner[j]);
            EXPECT_NEAR(length(turns[kSpinner] - world.way(kSpinner)[j].turn), 0, 1e-12);
            before = inner[j];
        }
        EXPECT_NEAR(inner[0].time, (static_cast<double>(k) - 0.75) / 24, 1e-15);
    }
    const VerifyReport report = verify_run(folder("run"));
    EXPECT_TRUE(report.proved());
    EXPECT_EQ(report.frames, kSteps + 1);
    EXPECT_EQ(report.motions, kSteps);
    EXPECT_EQ(report.motions_skipped, 0);
    EXPECT_EQ(summarize_run(folder("run")).substeps, kSubsteps);
}

TEST_P(SubstepsRun, AnIntersectionInAnInnerStepIsFound) {
    (void)run("run");
    constexpr std::int64_t kFrame = 3;
    copy("run", "same", [](std::int64_t, io::Way&) {});
    EXPECT_TRUE(verify_run(folder("same")).proved());
    // The ball hangs above the plate at both frames, and through it, or wholly below, in an inner step between.
    for (const double z : {0.1, -1.0}) {
        const std::string name = "planted" + std::to_string(z);
        copy("run", name, [&](std::int64_t k, io::Way& way) {
            if (k == kFrame) way.position[place(1, kBall)].z = z;
        });
        const VerifyReport report = verify_run(folder(name));
        EXPECT_EQ(report.intersecting_pairs, 0) << "frames are as they were";
        ASSERT_EQ(report.crossing_pairs, 2) << "on the way there and back";
        for (const VerifyFault& fault : report.faults) {
            EXPECT_EQ(fault.kind, VerifyFault::Kind::crossing);
            EXPECT_EQ(fault.frame, kFrame - 1);
            EXPECT_EQ(fault.body_a, 0);
            EXPECT_EQ(fault.body_b, kBall);
            EXPECT_GE(fault.time, (kFrame - 1 + 0.25) / 24);
            EXPECT_LE(fault.time, (kFrame - 1 + 0.75) / 24 + 1e-12);
        }
    }
}

TEST_P(SubstepsRun, APoseOfAnInnerStepThatIsNoneIsFound) {
    (void)run("run");
    copy("run", "planted", [&](std::int64_t k, io::Way& way) {
        if (k == 5) way.rotation[place(2, kBall)] = {2, 0, 0, 0};
    });
    const VerifyReport report = verify_run(folder("planted"));
    EXPECT_EQ(report.bad_poses, 1);
    EXPECT_FALSE(report.proved());
}

TEST_P(SubstepsRun, AResumedRunHoldsTheSame) {
    (void)run("whole");
    const auto in_parts = [](RunOptions& options) { options.resume = true, options.checkpoint_every = 5; };
    (void)run("parts", 7, in_parts);
    EXPECT_EQ(run("parts", kSteps, in_parts).resumed_after, 7);
    io::RunReader a(folder("whole")), b(folder("parts"));
    ASSERT_EQ(b.frames(), kSteps + 1);
    for (std::int64_t k = 0; k <= kSteps; ++k) {
        EXPECT_EQ(a.frame(k).position, b.frame(k).position);
        EXPECT_EQ(a.way(k).position, b.way(k).position) << k;
        EXPECT_EQ(a.way(k).rotation, b.way(k).rotation) << k;
        EXPECT_EQ(a.way(k).turns.size(), b.way(k).turns.size()) << k;
    }
    EXPECT_TRUE(verify_run(folder("parts")).proved());
}

TEST_P(SubstepsRun, WithMoreThanOneStepAFrameIsCheckedAsStatesAndSaysSo) {
    (void)run("run", kSteps, [](RunOptions& options) { options.frame_every = 2; });
    EXPECT_TRUE(io::RunReader(folder("run")).way(1).empty());
    const VerifyReport report = verify_run(folder("run"));
    EXPECT_TRUE(report.proved());
    EXPECT_EQ(report.motions, 0);
    EXPECT_EQ(report.motions_skipped, kSteps / 2);
    EXPECT_EQ(report.notes.size(), 1u);
}

TEST_P(SubstepsRun, ARunWithoutInnerStepsHasNoneOfTheirData) {
    SceneDescription scene = ball_and_plate(GetParam());
    scene.settings.substeps = 1;
    RunOptions options;
    options.output = folder("run");
    options.steps = 3;
    (void)run_scene(scene, "scene", options);
    io::RunReader reader(folder("run"));
    EXPECT_TRUE(reader.way(2).empty());
    const io::Hdf5Reader file(folder("run") / "frames-00000000-00000003.h5");
    for (const char* name : {"/way_position", "/way_rotation", "/way_checksum", "/way_index", "/way_turn"})
        EXPECT_FALSE(file.has(name)) << name;
    EXPECT_EQ(reader.run_json().find("\n  \"substeps\""), std::string::npos);
}

TEST(SubstepsRunOf, NoBodiesIsWrittenAndRead) {
    const test::TemporaryFolder temporary;
    SceneDescription scene;
    scene.settings.substeps = kSubsteps;
    RunOptions options;
    options.output = temporary.path() / "run";
    options.steps = 3;
    (void)run_scene(scene, "scene", options);
    io::RunReader reader(options.output);
    ASSERT_EQ(reader.frames(), 4);
    for (std::int64_t k = 0; k < reader.frames(); ++k) EXPECT_TRUE(reader.way(k).empty()) << k;
}

} // namespace
} // namespace flotilla
