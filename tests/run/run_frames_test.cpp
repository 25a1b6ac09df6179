// SPDX-License-Identifier: MIT
// read_frames: the arrays are what the World was in, frame by frame.
#include <gtest/gtest.h>

#include <filesystem>

#include <flotilla/error.hpp>
#include <flotilla/run.hpp>
#include <flotilla/run_folder.hpp>
#include <flotilla/scene_library.hpp>

#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

constexpr int kSteps = 6;

TEST(ReadFrames, GivesThePosesOfTheWorld) {
    const test::TemporaryFolder folder;
    const SceneDescription scene = make_scene("stack", 3);
    RunOptions options;
    options.output = folder.path() / "run";
    options.steps = kSteps;
    options.world.threads = 1;
    static_cast<void>(run_scene(scene, "scene", options));
    const RunFrames frames = read_frames(options.output, {.first = 0, .every = 2});
    World world(scene);
    const std::size_t n = world.size();
    ASSERT_EQ(frames.frame, (std::vector<std::int64_t>{0, 2, 4, 6}));
    ASSERT_EQ(frames.position.size(), 4 * n);
    ASSERT_EQ(frames.activity.size(), 4 * n);
    for (std::size_t k = 0; k < frames.frame.size(); ++k) {
        while (world.steps() < frames.step[k]) world.step();
        EXPECT_EQ(frames.time[k], world.time());
        const std::vector<BodyActivity> activity = world.activity();
        for (std::size_t i = 0; i < n; ++i) {
            const BodyState body = world.body(i);
            EXPECT_EQ(frames.position[k * n + i], body.position);
            EXPECT_EQ(frames.rotation[k * n + i], body.rotation);
            EXPECT_EQ(frames.velocity[k * n + i], body.velocity);
            EXPECT_EQ(frames.angular_velocity[k * n + i], body.angular_velocity);
            EXPECT_EQ(frames.activity[k * n + i].contacts, activity[i].contacts);
            EXPECT_EQ(frames.activity[k * n + i].cluster, activity[i].cluster);
        }
    }
    EXPECT_THROW(static_cast<void>(read_frames(options.output, {.first = kSteps + 1})), InputError);
    EXPECT_THROW(static_cast<void>(read_frames(folder.path())), IoError);
}

} // namespace
} // namespace flotilla
