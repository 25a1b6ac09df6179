// SPDX-License-Identifier: MIT
// flotilla picture: files, options and exit codes.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>

#include "run_folder/run_folder.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

const std::string kScene = R"({"flotilla_scene": 1,
  "shapes": [{"name": "plate", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "mass": 2.0}],
  "bodies": [{"name": "a", "shape": "plate", "type": "dynamic", "position": [0,0,1]},
             {"name": "b", "shape": "plate", "type": "static"}]})";
const std::string kSmall = " --width 64 --height 48 --supersampling 1";

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Width and height from the PNG header; zeros where it is none.
std::array<int, 2> png_size(const std::string& bytes) {
    if (bytes.size() < 24 || bytes.substr(1, 3) != "PNG") return {0, 0};
    const auto number = [&](std::size_t at) {
        int value = 0;
        for (std::size_t i = at; i < at + 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[i]);
        return value;
    };
    return {number(16), number(20)};
}

/// A run of one plate that sinks, frames 0 to 2.
void write_run(const std::filesystem::path& folder) {
    io::RunScene scene;
    scene.shapes.push_back({"plate", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, {}});
    scene.shapes.push_back({"floor", {{{-2, -2, -3}, {2, -2, -3}, {0, 4, -3}}, {{0, 1, 2}}}, {}});
    scene.bodies = {{"a", 0, BodyType::dynamic}, {"b", 1, BodyType::fixed}};
    io::RunInfo info;
    info.time_step = 0.5;
    io::RunWriter writer(folder, info, scene, io::OpenRun::create);
    for (std::int64_t k = 0; k < 3; ++k) {
        const std::array<Vec3, 2> position{Vec3{0, 0, -static_cast<double>(k)}, Vec3{}}, zero{};
        const std::array<Quat, 2> rotation{};
        writer.add_frame({.step = k,
                          .time = 0.5 * static_cast<double>(k),
                          .position = position,
                          .rotation = rotation,
                          .velocity = zero,
                          .angular_velocity = zero,
                          .path_rotation = {}});
    }
    writer.close("complete");
}

TEST(PictureCommand, ShowsTheInitialStateOfAScene) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", kScene), png = folder.path() / "out.png";
    const CommandOutput r = run_flotilla("picture " + scene + " --output " + png + kSmall);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.out, "");
    EXPECT_NE(r.err.find("2 bodies"), std::string::npos) << r.err;
    EXPECT_EQ(png_size(bytes_of(png)), (std::array{64, 48}));
    EXPECT_EQ(run_flotilla("picture " + scene + " --frame 1 --output " + png + kSmall).exit_code, 2);
}

TEST(PictureCommand, ShowsAnyFrameOfARunTheLastByDefault) {
    const TemporaryFolder folder;
    const std::string run = folder.path() / "run", out = folder.path();
    write_run(run);
    for (const char* frame : {"0", "2"}) {
        const CommandOutput r =
            run_flotilla("picture " + run + " --frame " + frame + " --output " + out + "/" + frame + ".png" + kSmall);
        EXPECT_EQ(r.exit_code, 0) << r.err;
    }
    const CommandOutput last = run_flotilla("picture " + run + " --output " + out + "/last.png" + kSmall);
    EXPECT_EQ(last.exit_code, 0) << last.err;
    EXPECT_NE(last.err.find("frame 2 of 3, t = 1 s"), std::string::npos) << last.err;
    EXPECT_EQ(bytes_of(out + "/last.png"), bytes_of(out + "/2.png"));
    EXPECT_NE(bytes_of(out + "/last.png"), bytes_of(out + "/0.png"));
    const CommandOutput beyond = run_flotilla("picture " + run + " --frame 3 --output " + out + "/x.png" + kSmall);
    EXPECT_EQ(beyond.exit_code, 2);
    EXPECT_NE(beyond.err.find("0 to 2"), std::string::npos) << beyond.err;
}

TEST(PictureCommand, ShowsStepsOfARunWhoseMeshFilesAreGone) {
    const TemporaryFolder folder;
    const std::string mesh =
        folder.write("ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const std::string scene = folder.write("s.json", R"({"flotilla_scene": 1,
  "shapes": [{"name": "t", "mesh": "ball.obj", "scale": 0.3, "density": 100}], "bodies": [{"name": "a", "shape": "t"}]})");
    const std::string edits = folder.write("e.json", R"({"flotilla_edits": 1, "edits": [
  {"step": 2, "add_shape": {"name": "u", "mesh": "ball.obj", "scale": 0.7, "density": 100}},
  {"step": 2, "add_body": {"name": "b", "shape": "u", "position": [3, 0, 0]}}]})");
    const std::string run = folder.path() / "run", moved = folder.path() / "moved", png = folder.path() / "out.png";
    ASSERT_EQ(run_flotilla("run " + scene + " --steps 6 --checkpoint-every 4 --quiet --output " + run + "s").exit_code,
              0);
    ASSERT_EQ(run_flotilla("run " + scene + " --edits " + edits + " --steps 6 --quiet --output " + run).exit_code, 0);
    const std::string poses = folder.path() / "poses.csv";
    ASSERT_EQ(run_flotilla("export " + run + "s --format csv --output " + poses).exit_code, 0);
    std::filesystem::remove(mesh);
    std::filesystem::rename(run, moved);
    for (const std::string& place : {moved, run + "s"}) {
        const CommandOutput r = run_flotilla("picture " + place + " --step 5 --output " + png + kSmall);
        EXPECT_EQ(r.exit_code, 0) << r.err;
    }
    const CommandOutput verified = run_flotilla("verify " + run + "s/scene.json --poses " + poses);
    EXPECT_EQ(verified.exit_code, 0) << verified.err;
    const CommandOutput again =
        run_flotilla("run " + run + "s/scene.json --resume --steps 9 --quiet --output " + run + "s");
    EXPECT_EQ(again.exit_code, 0) << again.err;
}

TEST(PictureCommand, TellsBadOptionsFromFailures) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", kScene), out = folder.path();
    EXPECT_EQ(run_flotilla("picture " + scene).exit_code, 2) << "no --output";
    EXPECT_EQ(run_flotilla("picture " + scene + " --output " + out + "/a.png --width 0").exit_code, 2);
    EXPECT_EQ(run_flotilla("picture " + scene + " --output " + out + "/a.png --zoom nan").exit_code, 2);
    EXPECT_EQ(run_flotilla("picture " + out + "/absent.json --output " + out + "/a.png").exit_code, 5);
    EXPECT_EQ(run_flotilla("picture " + out + " --output " + out + "/a.png").exit_code, 5) << "no run folder";
    const CommandOutput too_long = run_flotilla("picture " + std::string(300, 'x') + " --output " + out + "/a.png");
    EXPECT_EQ(too_long.exit_code, 5) << too_long.err;
    EXPECT_NE(too_long.err.find("File name too long"), std::string::npos) << too_long.err;
    EXPECT_EQ(run_flotilla("picture " + scene + " --output " + out + "/absent/a.png" + kSmall).exit_code, 5);
    EXPECT_FALSE(std::filesystem::exists(out + "/a.png"));
}

TEST(PictureCommand, WritesNoPngUnderAnotherName) {
    const TemporaryFolder folder;
    const std::string scene = folder.write("scene.json", kScene), out = folder.path();
    for (const char* name : {"/a.jpg", "/a", "/png", "/a.png.gz", "/.png"}) {
        const CommandOutput r = run_flotilla("picture " + scene + " --output " + out + name + kSmall);
        EXPECT_EQ(r.exit_code, 2) << name;
        EXPECT_NE(r.err.find("ends with .png"), std::string::npos) << r.err;
        EXPECT_FALSE(std::filesystem::exists(out + name)) << name;
    }
    EXPECT_EQ(run_flotilla("picture " + scene + " --output " + out + "/A.PNG" + kSmall).exit_code, 0);
}

TEST(PictureCommand, OneCameraForAllFramesOfAFilm) {
    const TemporaryFolder folder;
    const std::string run = (folder.path() / "run").string(), out = (folder.path() / "picture.png").string();
    write_run(run);
    const auto picture = [&](const std::string& options) {
        EXPECT_EQ(run_flotilla("picture " + run + " --output " + out + kSmall + options).exit_code, 0);
        return bytes_of(out);
    };
    EXPECT_EQ(picture(" --frame 1 --camera-frame 1"), picture(" --frame 1"));
    EXPECT_NE(picture(" --frame 1 --camera-frame 0"), picture(" --frame 1"));
    const CommandOutput none = run_flotilla("picture " + run + " --output " + out + " --camera-frame 3");
    EXPECT_EQ(none.exit_code, 2);
    EXPECT_NE(none.err.find("there is no frame 3"), std::string::npos) << none.err;
}

TEST(PictureCommand, ShowsContactsAndPairsOfAStep) {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "picture.png").string();
    const std::string scene = folder.write("stack.json", run_flotilla("scene stack --bodies 3").out);
    const CommandOutput r = run_flotilla("picture " + scene + " --step 4 --output " + out + kSmall);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.err.find("step 4, t = "), std::string::npos) << r.err;
    EXPECT_NE(r.err.find("pairs: 2 with an impulse (red)"), std::string::npos) << r.err;
    EXPECT_EQ(png_size(bytes_of(out)), (std::array{64, 48}));
    const std::string contacts = bytes_of(out);
    const CommandOutput proofs =
        run_flotilla("picture " + scene + " --step 4 --lines proofs --quiet --output " + out + kSmall);
    EXPECT_EQ(proofs.exit_code, 0) << proofs.err;
    EXPECT_NE(proofs.err.find("by a query (blue)"), std::string::npos) << proofs.err;
    EXPECT_EQ(proofs.err.find("step 4 of 4"), std::string::npos) << proofs.err;
    EXPECT_NE(r.err.find("step 4 of 4"), std::string::npos) << r.err;
    EXPECT_NE(bytes_of(out), contacts);
    for (const char* bad : {" --lines proofs", " --step 4 --lines hints", " --step -1", " --step x",
                            " --step 4 --frame 1", " --step 4 --camera-frame 1"})
        EXPECT_EQ(run_flotilla("picture " + scene + bad + " --output " + out + kSmall).exit_code, 2) << bad;
}

} // namespace
} // namespace flotilla::test
