// SPDX-License-Identifier: MIT
#include "run_folder/run_folder.hpp"

#include <algorithm>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <hdf5.h>

#include <flotilla/error.hpp>

#include "run_folder/damage.hpp"
#include "run_folder/sample_run.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

namespace fs = std::filesystem;
using io::RunReader;
using io::RunWriter;

std::set<std::string> names_in(const fs::path& folder, const std::string& prefix) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().starts_with(prefix)) names.insert(entry.path().filename().string());
    return names;
}

template <typename Action>
std::string io_error_of(Action action) {
    try {
        action();
    } catch (const IoError& error) {
        return error.what();
    }
    return "";
}

void expect_frame(const io::Frame& frame, std::size_t bodies, std::int64_t k) {
    const SampleFrame expected(bodies, k);
    EXPECT_EQ(frame.index, k);
    EXPECT_EQ(frame.step, k);
    EXPECT_EQ(frame.time, expected.view.time);
    EXPECT_EQ(frame.position, expected.position);
    EXPECT_EQ(frame.rotation, expected.rotation);
    EXPECT_EQ(frame.velocity, expected.velocity);
    EXPECT_EQ(frame.angular_velocity, expected.angular_velocity);
}

TEST(RunFolder, GivesBackWhatWasWrittenAcrossSegments) {
    const test::TemporaryFolder temporary;
    const fs::path folder = temporary.path() / "new" / "run";
    {
        RunWriter writer(folder, sample_info(), sample_scene(5), io::OpenRun::create);
        write_sample(writer, 5, 0, 260);
        EXPECT_EQ(writer.frames(), 261);
        writer.close("complete");
    }
    EXPECT_EQ(names_in(folder, ""), (std::set<std::string>{"frames-00000000-00000119.h5", "frames-00000120-00000239.h5",
                                                           "frames-00000240-00000260.h5", "meshes.h5", "run.json",
                                                           "scene.json", "steps.csv"}));

    RunReader reader(folder);
    ASSERT_EQ(reader.frames(), 261);
    for (const std::int64_t k : {0, 119, 120, 121, 5, 260, 239}) expect_frame(reader.frame(k), 5, k);
    EXPECT_EQ(reader.info().scene_hash, 0x8000000000000001u);
    EXPECT_EQ(reader.info().trajectory, Trajectory::rigid);
    EXPECT_EQ(reader.info().command_line, sample_info().command_line);
    ASSERT_EQ(reader.scene().bodies.size(), 5u);
    EXPECT_EQ(reader.scene().bodies[3].name, "body \"3\", plate");
    EXPECT_EQ(reader.scene().bodies[0].type, BodyType::fixed);
    EXPECT_EQ(reader.scene().shapes[0].mesh.vertices, sample_scene(1).shapes[0].mesh.vertices);
    EXPECT_EQ(reader.scene().shapes[0].center_of_mass, (Vec3{1.0 / 3, 1.0 / 3, 0}));
    EXPECT_NE(reader.run_json().find("\"status\": \"complete\""), std::string::npos);
    EXPECT_NE(reader.run_json().find("\"friction\": 0.25"), std::string::npos);
}

TEST(RunFolder, KeepsTurnsThatAreNotTheShortestArc) {
    const test::TemporaryFolder temporary;
    const Vec3 fast{0, 0, 20}, slow{0.3, 0.2, 0.1};
    SampleFrame a(3, 0), b(3, 1);
    b.path = {Vec3{}, fast, slow};
    for (std::size_t i = 0; i < 3; ++i) b.rotation[i] = rotation_from_vector(b.path[i]) * a.rotation[i];
    b.view.path_rotation = b.path;
    b.view.rotation = b.rotation;
    RunWriter writer(temporary.path(), sample_info(), sample_scene(3), io::OpenRun::create);
    writer.add_frame(a.view);
    writer.add_frame(b.view);
    writer.close("complete");

    RunReader reader(temporary.path());
    const io::Frame end = reader.frame(1);
    ASSERT_EQ(end.path.size(), 1u);
    EXPECT_EQ(end.path[0].body, 1);
    const auto turns = io::path_rotations(reader.frame(0), end);
    EXPECT_EQ(turns[0], Vec3{});
    EXPECT_EQ(turns[1], fast);
    EXPECT_NEAR(length(turns[2] - slow), 0, 1e-15);
}

TEST(RunFolder, AFrameOfTenThousandBodiesIsAtMost1100Kilobytes) {
    const test::TemporaryFolder temporary;
    RunWriter writer(temporary.path(), sample_info(), sample_scene(10002), io::OpenRun::create);
    write_sample(writer, 10002, 0, 9, true);
    writer.close("complete");
    EXPECT_LE(RunReader(temporary.path()).frame_file_bytes() / 10, 1'100'000u);
}

TEST(RunFolder, KeepsWhatTheStepsDidWithTheBodies) {
    const test::TemporaryFolder temporary;
    RunWriter writer(temporary.path(), sample_info(), sample_scene(5), io::OpenRun::create);
    write_sample(writer, 5, 0, 130, true);
    writer.close("complete");
    RunReader reader(temporary.path());
    for (const std::int64_t k : {0, 6, 7, 125}) {
        const io::Frame frame = reader.frame(k);
        expect_frame(frame, 5, k);
        EXPECT_EQ(frame.activity.contacts, (std::vector<std::uint16_t>{0, 1, 2, 3, 4}));
        EXPECT_EQ(frame.activity.cluster, (std::vector<std::uint8_t>{0, 1, 2, 3, 0}));
        EXPECT_EQ(frame.activity.cost[4], k < 7 ? 10000 * k : 65535);
    }
    // A flipped bit in a body's counts costs the frame, as one in its position does.
    const fs::path path = temporary.path() / "frames-00000120-00000130.h5";
    const std::string bytes = io::read_text(path);
    const std::size_t found = bytes.find(std::string("\0\0\1\0\2\0\3\0\4\0", 10));
    ASSERT_NE(found, std::string::npos);
    flip_bit(path, static_cast<std::streamoff>(found) + 2);
    RunReader damaged(temporary.path());
    EXPECT_NE(io_error_of([&] { (void)damaged.frame(120); }).find("frame 120 is lost"), std::string::npos);
    expect_frame(damaged.frame(121), 5, 121);
}

TEST(RunFolder, ASegmentHasTheActivityOfAllItsFramesOrOfNone) {
    const test::TemporaryFolder temporary;
    {
        RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::create);
        write_sample(writer, 2, 0, 60); // as runs of older versions did
        writer.close("stopped");
    }
    {
        RunWriter writer(temporary.path(), sample_info(), sample_scene(2), 50);
        write_sample(writer, 2, 51, 150, true);
        writer.close("complete");
    }
    RunReader reader(temporary.path());
    for (std::int64_t k = 0; k <= 150; ++k) {
        const io::Frame frame = reader.frame(k);
        expect_frame(frame, 2, k);
        EXPECT_EQ(frame.activity.empty(), k < 120) << k;
    }
    RunWriter again(temporary.path(), sample_info(), sample_scene(2), 140);
    write_sample(again, 2, 141, 150, true);
    again.close("complete");
    EXPECT_EQ(RunReader(temporary.path()).frame(130).activity.contacts, (std::vector<std::uint16_t>{0, 1}));
}

TEST(RunFolder, RefusesAFolderWithContent) {
    const test::TemporaryFolder temporary;
    { std::ofstream(temporary.path() / "notes.txt") << "mine"; }
    EXPECT_THROW(RunWriter(temporary.path(), sample_info(), sample_scene(1), io::OpenRun::create), InputError);
}

TEST(RunFolder, OverwritingRemovesAnEarlierRunAndNothingElse) {
    const test::TemporaryFolder temporary;
    {
        RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::create);
        write_sample(writer, 2, 0, 130);
        writer.close("complete");
        std::ofstream(temporary.path() / "notes.txt") << "mine";
        std::ofstream(temporary.path() / "frames-00000900-00000901.h5.tmp") << "left by a crash";
    }
    RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::overwrite);
    writer.add_frame(SampleFrame(2, 0).view);
    writer.close("complete");
    EXPECT_EQ(names_in(temporary.path(), "frames-"), std::set<std::string>{"frames-00000000-00000000.h5"});
    EXPECT_TRUE(fs::exists(temporary.path() / "notes.txt"));
}

TEST(RunFolder, ResumingRemovesLaterFramesAndRowsAndGoesOn) {
    const test::TemporaryFolder temporary;
    {
        RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::create);
        write_sample(writer, 2, 0, 300);
        writer.close("stopped");
    }
    for (const std::int64_t step : {290, 200, 119, 60}) {
        RunWriter writer(temporary.path(), sample_info(), sample_scene(2), step);
        EXPECT_EQ(writer.frames(), step + 1);
        write_sample(writer, 2, step + 1, 310);
        writer.close("complete");
        RunReader reader(temporary.path());
        ASSERT_EQ(reader.frames(), 311);
        for (std::int64_t k = 0; k <= 310; ++k) expect_frame(reader.frame(k), 2, k);
        const std::string rows = io::read_text(temporary.path() / "steps.csv");
        EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 311);
    }
    io::RunInfo other = sample_info();
    other.scene_hash = 5;
    EXPECT_THROW(RunWriter(temporary.path(), other, sample_scene(2), 60), InputError);
}

TEST(RunFolder, FlushedFramesSurviveARunThatIsKilled) {
    const test::TemporaryFolder temporary;
    RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::create);
    write_sample(writer, 2, 0, 10);
    writer.flush();
    write_sample(writer, 2, 11, 20);
    RunReader reader(temporary.path()); // what is on the disk now
    ASSERT_EQ(reader.frames(), 11);
    expect_frame(reader.frame(10), 2, 10);
}

class DamagedRun : public ::testing::Test {
  protected:
    DamagedRun() {
        RunWriter writer(temporary_.path(), sample_info(), sample_scene(2), io::OpenRun::create);
        write_sample(writer, 2, 0, 250);
        writer.close("complete");
    }
    /// Frames that cannot be read.
    std::int64_t lost() {
        RunReader reader(temporary_.path());
        std::int64_t count = 0;
        for (std::int64_t k = 0; k < reader.frames(); ++k)
            count += io_error_of([&] { (void)reader.frame(k); }).empty() ? 0 : 1;
        return count;
    }
    fs::path segment(const char* name) { return temporary_.path() / name; }
    test::TemporaryFolder temporary_;
};

TEST_F(DamagedRun, ATruncatedSegmentIsNamedWithItsFramesAndCostsOnlyThem) {
    const fs::path path = segment("frames-00000120-00000239.h5");
    for (const double part : {0.95, 0.5, 0.01, 0.0}) {
        fs::resize_file(path, static_cast<std::uintmax_t>(part * static_cast<double>(fs::file_size(path))));
        RunReader reader(temporary_.path());
        const std::string message = io_error_of([&] { (void)reader.frame(130); });
        EXPECT_NE(message.find(path.string()), std::string::npos) << message;
        EXPECT_NE(message.find("frames 120 to 239 are lost"), std::string::npos) << message;
        EXPECT_EQ(lost(), 120);
    }
}

TEST_F(DamagedRun, AMissingSegmentIsReportedAsAGap) {
    fs::remove(segment("frames-00000120-00000239.h5"));
    RunReader reader(temporary_.path());
    EXPECT_NE(io_error_of([&] { (void)reader.frame(130); }).find("frames 120 to 239 are missing"), std::string::npos);
    EXPECT_EQ(lost(), 120);
}

TEST_F(DamagedRun, AFlippedBitIsNeverTakenForData) {
    const fs::path path = segment("frames-00000120-00000239.h5");
    const auto size = static_cast<std::streamoff>(fs::file_size(path));
    std::int64_t damaged = 0, one_frame_only = 0;
    for (std::streamoff byte = 3; byte < size; byte += size / 97) {
        flip_bit(path, byte);
        RunReader reader(temporary_.path());
        std::int64_t lost_here = 0;
        for (std::int64_t k = 100; k < 245; ++k) {
            const std::string message = io_error_of([&] { expect_frame(reader.frame(k), 2, k); });
            if (message.empty()) continue;
            ++lost_here;
            EXPECT_GE(k, 120);
            EXPECT_LT(k, 240);
            EXPECT_NE(message.find("lost"), std::string::npos) << message;
        }
        flip_bit(path, byte);
        damaged += lost_here > 0 ? 1 : 0;
        one_frame_only += lost_here == 1 ? 1 : 0;
    }
    EXPECT_GE(damaged, 97); // every flip is seen
    EXPECT_GT(one_frame_only, 50);
}

TEST_F(DamagedRun, DamagedMeshesAndRunJsonAreReported) {
    const auto message = [this] { return io_error_of([this] { RunReader reader(temporary_.path()); }); };
    EXPECT_EQ(message(), "");
    const fs::path meshes = segment("meshes.h5");
    const auto size = static_cast<std::streamoff>(fs::file_size(meshes));
    for (std::streamoff byte = 0; byte < size; byte += 7) {
        flip_bit(meshes, byte);
        const std::string text = message();
        EXPECT_NE(text.find("meshes.h5: truncated or damaged"), std::string::npos) << byte;
        flip_bit(meshes, byte);
    }
    io::write_file(segment("run.json"), std::string_view("{\"flotilla_run\": 1"));
    EXPECT_NE(message().find("run.json: damaged"), std::string::npos);
    fs::remove(segment("run.json"));
    EXPECT_NE(message().find("not a run folder"), std::string::npos);
}

TEST(RunFolder, SegmentsAreOrdinaryHdf5Files) {
    const test::TemporaryFolder temporary;
    RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::create);
    write_sample(writer, 2, 0, 3);
    writer.close("complete");
    const hid_t file = H5Fopen((temporary.path() / "frames-00000000-00000003.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    const hid_t dataset = H5Dopen2(file, "position", H5P_DEFAULT);
    std::vector<double> values(4 * 2 * 3);
    EXPECT_GE(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    EXPECT_EQ(values[3 * 6 + 3], 1.0); // frame 3, body 1, x
    H5Dclose(dataset);
    H5Fclose(file);
}

TEST(RunFolder, AFullDiskLosesNothingOlder) {
    // /dev/full stands for the disk: a link to it under the temporary name makes the write fail with the real error.
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const test::TemporaryFolder temporary;
    RunWriter writer(temporary.path(), sample_info(), sample_scene(2), io::OpenRun::create);
    write_sample(writer, 2, 0, 10);
    writer.flush();
    fs::create_symlink("/dev/full", temporary.path() / "frames-00000011-00000011.h5.tmp");
    write_sample(writer, 2, 11, 11);
    const std::string message = io_error_of([&] { writer.flush(); });
    EXPECT_NE(message.find("frames-00000011-00000011.h5: cannot write: No space left on device"), std::string::npos)
        << message;
    RunReader reader(temporary.path());
    EXPECT_EQ(reader.frames(), 11);
    expect_frame(reader.frame(10), 2, 10);
    writer.close("complete"); // there is room again: the frame was not forgotten
    EXPECT_EQ(RunReader(temporary.path()).frames(), 12);
}

TEST(RunFolder, AFolderThatCannotBeWrittenIsNamed) {
    const std::string message =
        io_error_of([] { RunWriter writer("/proc/flotilla", sample_info(), sample_scene(1), io::OpenRun::create); });
    EXPECT_NE(message.find("/proc/flotilla"), std::string::npos) << message;
}

} // namespace
} // namespace flotilla
