// SPDX-License-Identifier: MIT
// The encoder against a decoder of the test's own.
#include "report/pose_track.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "base/random.hpp"
#include "report/report_page.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

double uniform(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    return 2 * unit_interval(random_bits(a, b, c)) - 1;
}

/// Bodies that tumble at random, from one frame to the next by anything up to half a turn.
class Tumbling {
  public:
    Tumbling(std::size_t bodies, std::int64_t frames) {
        scene_.shapes.push_back(
            {"tetrahedron", {{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}}, {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}}}, {}});
        scene_.shapes.push_back({"wall", {{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}, {{0, 1, 2}}}, {}});
        for (std::size_t i = 0; i < bodies; ++i)
            scene_.bodies.push_back(
                {"body " + std::to_string(i), i % 3 == 1 ? 1 : 0, i % 3 == 1 ? BodyType::fixed : BodyType::dynamic});
        io::RunInfo info;
        info.time_step = 0.1;
        io::RunWriter writer(folder_.path(), info, scene_, io::OpenRun::create);
        for (std::int64_t k = 0; k < frames; ++k) write(writer, k);
        writer.close("complete");
    }
    [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

  private:
    void write(io::RunWriter& writer, std::int64_t k) const {
        const std::size_t n = scene_.bodies.size();
        std::vector<Vec3> position(n), velocity(n), zero(n);
        std::vector<Quat> rotation(n);
        for (std::uint64_t i = 0; i < n; ++i) {
            const auto frame = static_cast<std::uint64_t>(k);
            const auto random = [&](std::uint64_t what) { return uniform(i, frame, what); };
            const double reach = i == 0 ? 1e5 : 10; // one flies off
            position[i] = {1e4 + reach * random(0), reach * random(1), random(2)};
            velocity[i] = {random(3), random(4), random(5)};
            rotation[i] = rotation_from_vector({3 * random(6), 3 * random(7), 3 * random(8)});
        }
        writer.add_frame({k, 0.1 * static_cast<double>(k), position, rotation, velocity, zero, {}});
    }

    test::TemporaryFolder folder_;
    io::RunScene scene_;
};

std::vector<std::uint8_t> bytes_of(const report::PoseTrack& track) {
    std::vector<std::uint8_t> bytes;
    for (const std::byte b : track.stream) bytes.push_back(std::to_integer<std::uint8_t>(b));
    return bytes;
}

TEST(PoseTrack, DecodesToThePosesWithinTheStatedError) {
    const Tumbling run(7, 40);
    io::RunReader reader(run.path());
    const report::DrawOrder order = report::draw_order(reader.scene());
    const report::PoseTrack track = report::encode_poses(reader, order, 1, 2);
    ASSERT_EQ(track.frames.size(), 40u);
    EXPECT_TRUE(track.problems.empty());
    EXPECT_LT(track.rotation_error, 1e-4);
    const auto poses = test::decode_poses(bytes_of(track), 40, track.boxes, track.origin, track.top_speed);
    double position_error = 0, rotation_error = 0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
        const io::Frame frame = reader.frame(static_cast<std::int64_t>(k));
        for (std::size_t i = 0; i < poses[k].size(); ++i) {
            const auto body = static_cast<std::size_t>(order.bodies[i]);
            const Vec3 center =
                report::middle(reader.scene().shapes[static_cast<std::size_t>(reader.scene().bodies[body].shape)].mesh);
            const Vec3 expected = frame.position[body] + rotate(frame.rotation[body], center);
            const double error = length(poses[k][i].middle - expected);
            position_error = std::max(position_error, error);
            // The box of a body that stays near is small, whatever the others do.
            EXPECT_LT(error, body == 0 ? 3.0 : 1e-2) << body;
            rotation_error = std::max(rotation_error,
                                      length(rotation_vector(poses[k][i].rotation * conjugate(frame.rotation[body]))));
            EXPECT_NEAR(poses[k][i].speed, length(frame.velocity[body]), 2 * track.top_speed / 65535);
        }
    }
    // The decoder here works in double precision, the encoder measures single precision: 1e5 m at 2^-24.
    EXPECT_LE(position_error, track.position_error + 0.02);
    EXPECT_LE(rotation_error, track.rotation_error * (1 + 1e-6));
}

TEST(PoseTrack, MarksBodiesThatAreNotThereAndDoesNotMeasureThem) {
    test::TemporaryFolder folder;
    io::RunScene scene;
    scene.shapes.push_back({"point", {{{0, 0, 0}}, {}}, {}});
    for (const char* name : {"stays", "comes"}) scene.bodies.push_back({name, 0, BodyType::dynamic});
    io::RunInfo info;
    info.time_step = 0.1;
    info.edits_json = "{}", info.scene_bodies = 1;
    constexpr std::int64_t kFrames = 6, kComes = 2, kGoes = 4;
    {
        io::RunWriter writer(folder.path(), info, scene, io::OpenRun::create);
        for (std::int64_t k = 0; k < kFrames; ++k) {
            const bool there = k >= kComes && k < kGoes;
            const double x = static_cast<double>(k);
            io::Activity activity;
            activity.append({});
            if (there)
                activity.append({});
            else
                activity.append_absent();
            const std::vector<Vec3> position{{100 + x, 0, 0}, there ? Vec3{1000 + x, 5, 0} : Vec3{}}, zero(2);
            const std::vector<Quat> rotation(2);
            writer.add_frame({k, 0.1 * x, position, rotation, zero, zero, {}, activity.view()});
        }
        writer.close("complete");
    }
    io::RunReader reader(folder.path());
    const report::PoseTrack track = report::encode_poses(reader, report::draw_order(scene), 1, 1);
    EXPECT_TRUE(track.problems.empty());
    EXPECT_NEAR(track.origin.x, (100 + 1003) / 2.0, 1e-3) << "the world's origin is far from all";
    EXPECT_LT(track.position_error, 1e-3);
    const auto poses = test::decode_poses(bytes_of(track), kFrames, track.boxes, track.origin, track.top_speed);
    for (std::int64_t k = 0; k < kFrames; ++k) {
        const auto& frame = poses[static_cast<std::size_t>(k)];
        EXPECT_TRUE(frame[0].there);
        EXPECT_EQ(frame[1].there, k >= kComes && k < kGoes) << k;
        if (frame[1].there) {
            EXPECT_NEAR(frame[1].middle.x, 1000.0 + static_cast<double>(k), 1e-3);
        }
    }
}

TEST(PoseTrack, DrawsDynamicBodiesFirstAndOneShapeAtATime) {
    const Tumbling run(7, 1);
    io::RunReader reader(run.path());
    const report::DrawOrder order = report::draw_order(reader.scene());
    EXPECT_EQ(order.bodies, (std::vector<std::int32_t>{0, 2, 3, 5, 6, 1, 4}));
    ASSERT_EQ(order.groups.size(), 2u);
    EXPECT_FALSE(order.groups[0].fixed);
    EXPECT_EQ(order.groups[0].count, 5u);
    EXPECT_TRUE(order.groups[1].fixed);
    EXPECT_EQ(order.groups[1].first, 5u);
    EXPECT_EQ(order.groups[1].shape, 1);
}

TEST(PoseTrack, TakesEveryKthFrameAndTheLast) {
    const Tumbling run(2, 11);
    io::RunReader reader(run.path());
    const report::PoseTrack track = report::encode_poses(reader, report::draw_order(reader.scene()), 4, 2);
    EXPECT_EQ(track.frames, (std::vector<std::int64_t>{0, 4, 8, 10}));
    EXPECT_EQ(track.frames_in_run, 11);
}

} // namespace
} // namespace flotilla
