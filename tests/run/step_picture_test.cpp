// SPDX-License-Identifier: MIT
// Pictures of steps: what they count is what the World has, and a run's step is made again or refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/run.hpp>
#include <flotilla/scene_file.hpp>
#include <flotilla/scene_library.hpp>
#include <flotilla/step_picture.hpp>

#include "base/rotation.hpp"
#include "base/vec3.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

PictureOptions small() {
    PictureOptions options;
    options.width = 96, options.height = 64, options.supersampling = 1;
    options.sun_samples = 2, options.sky_samples = 2;
    return options;
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

World stepped(const SceneDescription& scene, int steps) {
    World world(scene);
    while (world.steps() < steps) world.step();
    return world;
}

class StepPictures : public ::testing::Test {
  protected:
    /// A run of boats that fall on the ground and on each other.
    void run(const SceneDescription& scene, int steps, std::vector<Edit> edits = {}, int checkpoint_every = 0) {
        RunOptions options;
        options.output = run_;
        options.steps = steps;
        options.checkpoint_every = checkpoint_every;
        options.edits = std::move(edits);
        std::ostringstream text;
        write_scene(text, scene);
        options.scene_json = text.str();
        static_cast<void>(run_scene(scene, "scene", options));
    }
    std::string picture_of_run(std::int64_t step) {
        static_cast<void>(write_step_picture(run_, step, output_, small()));
        return bytes_of(output_);
    }
    std::string picture_of(const World& world) {
        static_cast<void>(write_step_picture(world, output_, small()));
        return bytes_of(output_);
    }
    std::string refusal(std::int64_t step) {
        try {
            static_cast<void>(write_step_picture(run_, step, output_, small()));
        } catch (const InputError& e) {
            return e.what();
        }
        return "";
    }

    const test::TemporaryFolder folder_;
    const std::filesystem::path run_ = folder_.path() / "run", output_ = folder_.path() / "picture.png";
    const SceneDescription boats_ = make_scene("falling-boats", 5, 1);
};

TEST_F(StepPictures, CountWhatTheWorldHas) {
    const World world = stepped(boats_, 40);
    const StepPictureReport r = write_step_picture(world, output_, small());
    EXPECT_EQ(r.step, 40);
    EXPECT_EQ(r.time, world.time());
    EXPECT_EQ(r.bodies, world.num_bodies());
    ASSERT_GT(world.contacts().size(), 0U);
    EXPECT_EQ(r.contacts, world.contacts().size());
    double largest = 0;
    for (const ContactState& c : world.contacts()) largest = std::max(largest, length(c.impulse));
    EXPECT_EQ(r.largest_impulse, largest);
    EXPECT_GT(r.loaded_pairs, 0U);
    EXPECT_LE(r.loaded_pairs + r.sleeping_pairs + r.touching_pairs + r.near_pairs, 5U * 4U / 2U);
}

TEST_F(StepPictures, OfBodiesInTheAirShowBoxesThatMeetAlone) {
    SceneDescription scene;
    scene.gravity = {};
    ShapeDescription plate;
    plate.name = "plate";
    plate.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    plate.triangles = {{0, 1, 2}};
    plate.mass_kind = MassKind::mass, plate.mass_value = 1;
    scene.shapes.push_back(plate);
    // The boxes of the first two meet, their triangles are far apart; the third is elsewhere.
    for (const Vec3& position : {Vec3{0, 0, 0}, Vec3{1.5, 1.5, 0}, Vec3{9, 0, 0}}) {
        BodyDescription body;
        body.name = std::string(1, static_cast<char>('a' + scene.bodies.size()));
        body.shape = 0, body.position = position;
        scene.bodies.push_back(body);
    }
    scene.bodies[1].rotation = {0, 0, 0, 1};
    const StepPictureReport r = write_step_picture(stepped(scene, 1), output_, small());
    EXPECT_EQ(r.contacts, 0U);
    EXPECT_EQ(r.near_pairs, 1U);
    EXPECT_EQ(r.loaded_pairs + r.sleeping_pairs + r.touching_pairs, 0U);
}

std::size_t shown_pairs(const StepPictureReport& r) {
    return r.loaded_pairs + r.sleeping_pairs + r.touching_pairs + r.near_pairs;
}

TEST_F(StepPictures, TellHowPairsWereProvedApart) {
    const World world = stepped(boats_, 36);
    const StepPictureReport r = write_step_picture(world, output_, small(), PairLines::proofs);
    const std::string proofs = bytes_of(output_);
    EXPECT_NE(proofs, picture_of(world));
    EXPECT_GT(r.proved_by_query, 0U);
    EXPECT_EQ(r.not_proved, 0U);
    EXPECT_EQ(r.proved_by_query + r.proved_by_boxes + r.proved_by_cluster + r.proved_by_rest, shown_pairs(r));
    EXPECT_EQ(r.proved_by_cluster + r.proved_by_rest, 0U) << "the failsafe had nothing to do";

    const StepPictureReport before = write_step_picture(World(boats_), output_, small());
    EXPECT_EQ(before.not_proved, shown_pairs(before)) << "no step was made";
}

TEST_F(StepPictures, TellOfClustersThatTheFailsafeMade) {
    SceneDescription scene = boats_;
    scene.gravity = {};
    scene.bodies.resize(2); // boats side by side across the axes that meet faster than contact sees them coming
    for (const std::size_t i : {0U, 1U}) {
        const Vec3 side = (i == 0 ? -1.0 : 1.0) * Vec3{1, -1, 0};
        scene.bodies[i].position = 0.8 * side;
        scene.bodies[i].rotation = rotation_from_vector({0, 0, 0.7854});
        scene.bodies[i].velocity = -20 * side;
    }
    scene.settings.collision_iterations = scene.settings.dynamic_iterations = 0; // the failsafe has it all
    scene.settings.rigidification = Rigidification::rigid;
    World world(scene);
    std::size_t of_clusters = 0;
    while (world.steps() < 12) {
        const std::int64_t merges = world.step().merges;
        const StepPictureReport r = write_step_picture(world, output_, small());
        EXPECT_EQ(r.proved_by_query + r.proved_by_boxes + r.proved_by_cluster + r.proved_by_rest, shown_pairs(r));
        if (merges == 0) EXPECT_EQ(r.proved_by_cluster, 0U) << r.step;
        of_clusters += r.proved_by_cluster;
    }
    EXPECT_GT(of_clusters, 0U);
}

TEST_F(StepPictures, SayHowFarTheStepIs) {
    run(boats_, 30, {}, 12); // checkpoints after steps 24 and 30
    std::vector<std::pair<std::int64_t, std::int64_t>> said;
    StepPictureOptions options;
    options.progress = [&](std::int64_t done, std::int64_t total) { said.emplace_back(done, total); };
    static_cast<void>(write_step_picture(run_, 3, output_, small(), options));
    EXPECT_EQ(said, (std::vector<std::pair<std::int64_t, std::int64_t>>{{1, 3}, {2, 3}, {3, 3}}));
    said.clear();
    static_cast<void>(write_step_picture(run_, 32, output_, small(), options));
    EXPECT_EQ(said, (std::vector<std::pair<std::int64_t, std::int64_t>>{{1, 2}, {2, 2}})) << "from the checkpoint";
}

TEST_F(StepPictures, OfARunAreThoseOfTheWorldFromStartAndCheckpoint) {
    run(boats_, 30, {}, 12); // checkpoints after steps 24 and 30
    for (const int step : {0, 20, 27, 30}) EXPECT_EQ(picture_of_run(step), picture_of(stepped(boats_, step))) << step;
    EXPECT_NE(picture_of_run(20), picture_of_run(30));
    EXPECT_EQ(picture_of_run(33), picture_of(stepped(boats_, 33))) << "beyond the run's end";
}

TEST_F(StepPictures, OfAnEditedRunMakeItsEdits) {
    const std::vector<Edit> edits{{4, edits::SetGravity{{0, 0, -2}}}, {12, edits::RemoveBody{{1, 0}}}};
    run(boats_, 20, edits);
    World world(boats_);
    for (int i = 0; i < 16; ++i) {
        if (i == 4) world.apply(edits[0]);
        if (i == 12) world.apply(edits[1]);
        world.step();
    }
    EXPECT_EQ(picture_of_run(16), picture_of(world));
    EXPECT_EQ(write_step_picture(run_, 16, output_, small()).bodies, world.num_bodies());
}

TEST_F(StepPictures, AreRefusedWhereTheRunCannotBeMadeAgain) {
    run(boats_, 8);
    EXPECT_EQ(refusal(6), "");
    EXPECT_NE(refusal(-1).find("at least 0"), std::string::npos);

    std::string rows = bytes_of(run_ / "steps.csv");
    char hash[17];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(stepped(boats_, 6).state_hash()));
    const std::size_t at = rows.find(hash);
    ASSERT_NE(at, std::string::npos);
    rows[at] = rows[at] == '0' ? '1' : '0';
    std::ofstream(run_ / "steps.csv", std::ios::binary) << rows;
    EXPECT_NE(refusal(6).find("ends elsewhere"), std::string::npos) << refusal(6);
    EXPECT_EQ(refusal(7), "");

    std::ofstream(run_ / "scene.json", std::ios::binary) << R"({"flotilla_scene": 1, "shapes": [], "bodies": []})";
    EXPECT_NE(refusal(6), "");
    std::ofstream(run_ / "scene.json", std::ios::binary | std::ios::trunc).flush();
    EXPECT_NE(refusal(6).find("made of no scene file"), std::string::npos) << refusal(6);
}

TEST_F(StepPictures, RefuseBadOptionsAndNamesThatCannotBeWritten) {
    PictureOptions options = small();
    options.width = 0;
    EXPECT_THROW(static_cast<void>(write_step_picture(World(boats_), output_, options)), InputError);
    EXPECT_THROW(static_cast<void>(write_step_picture(World(boats_), folder_.path() / "no" / "a.png", small())),
                 IoError);
    EXPECT_THROW(static_cast<void>(write_step_picture(folder_.path(), 1, output_, small())), IoError);
}

} // namespace
} // namespace flotilla
