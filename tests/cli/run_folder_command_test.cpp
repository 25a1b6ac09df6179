// SPDX-License-Identifier: MIT
// flotilla verify, export and info on run folders written here: exit codes, verdicts and messages.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <flotilla/run_folder.hpp>

#include "run_folder/file_stream.hpp"
#include "run_folder/run_folder.hpp"
#include "run_folder/sample_run.hpp"
#include "run_folder/step_csv.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

/// A fixed plate at z = 0 and a free one that comes down to it, 0.1 per step.
struct PlateRun {
    TemporaryFolder folder;
    std::vector<io::Frame> frames;

    explicit PlateRun(std::int64_t count = 6) {
        for (std::int64_t k = 0; k < count; ++k) {
            io::Frame frame;
            frame.index = frame.step = k;
            frame.time = 0.04 * static_cast<double>(k);
            frame.position = {{0, 0, 0}, {0.1, 0.1, 1 - 0.1 * static_cast<double>(k)}};
            frame.rotation = {Quat{}, Quat{}};
            frame.velocity = {Vec3{}, {0, 0, -2.5}};
            frame.angular_velocity = {Vec3{}, Vec3{}};
            frames.push_back(frame);
        }
    }

    /// Writes the frames, numbers `every` steps apart.
    std::string write(int every = 1) const {
        io::RunInfo info = sample_info();
        info.trajectory = Trajectory::linear;
        info.frame_every = every;
        io::RunWriter writer(folder.path() / "run", info, sample_scene(2), io::OpenRun::overwrite);
        for (const auto& f : frames)
            writer.add_frame({f.step * every, f.time, f.position, f.rotation, f.velocity, f.angular_velocity, {}});
        writer.close("complete");
        return (folder.path() / "run").string();
    }
};

TEST(VerifyCommand, PassesACleanRunAndSumsUp) {
    const PlateRun run;
    const CommandOutput r = run_flotilla("verify " + run.write());
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.out.find("frames checked:       6 (2 bodies)"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("motions checked:      5\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("intersecting pairs:   0\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("smallest distance:    0.5 m (frame 5"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("free of intersections\n"), std::string::npos) << r.out;
    EXPECT_NE(r.err.find("verifying: 100 %"), std::string::npos) << r.err;
    EXPECT_EQ(run_flotilla("verify --quiet " + run.write()).err, "");
}

TEST(VerifyCommand, FailsOnAPlantedIntersectionAndNamesIt) {
    PlateRun run;
    run.frames[3].position[1].z = 0; // into the other plate
    const CommandOutput r = run_flotilla("verify " + run.write());
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_NE(r.out.find("frame 3: \"body \\\"0\\\", plate\" (body 0) and"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("triangles 0 and 0"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("FAILED"), std::string::npos) << r.out;
}

TEST(VerifyCommand, FailsOnAPassThroughBetweenCleanFrames) {
    PlateRun run;
    for (std::size_t k = 4; k < run.frames.size(); ++k) run.frames[k].position[1].z -= 2;
    const CommandOutput r = run_flotilla("verify " + run.write());
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_NE(r.out.find("intersecting pairs:   0\n"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("after frame 3, "), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("pass through each other"), std::string::npos) << r.out;
    EXPECT_EQ(run_flotilla("verify --motion never " + run.write()).exit_code, 0);
}

TEST(VerifyCommand, FailsOnANanPose) {
    PlateRun run;
    run.frames[2].position[1].x = std::nan("");
    const CommandOutput r = run_flotilla("verify " + run.write());
    EXPECT_EQ(r.exit_code, 3);
    EXPECT_NE(r.out.find("the position is not finite"), std::string::npos) << r.out;
}

TEST(VerifyCommand, SaysThatFramesStepsApartAreCheckedAsStates) {
    PlateRun run;
    for (std::size_t k = 4; k < run.frames.size(); ++k) run.frames[k].position[1].z -= 2;
    const std::string folder = run.write(10);
    const CommandOutput r = run_flotilla("verify " + folder);
    EXPECT_EQ(r.exit_code, 0) << r.out;
    EXPECT_NE(r.out.find("checked as states"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("free of intersections in every frame\n"), std::string::npos) << r.out;
    EXPECT_EQ(run_flotilla("verify --motion always " + folder).exit_code, 3);
}

TEST(VerifyCommand, ChecksWhatADamagedRunStillHasAndFailsWithFive) {
    PlateRun run(130);
    for (auto& frame : run.frames) frame.position[1].z = 1;
    const std::string folder = run.write();
    fs::resize_file(folder + "/frames-00000120-00000129.h5", 1000);
    const CommandOutput r = run_flotilla("verify " + folder);
    EXPECT_EQ(r.exit_code, 5);
    EXPECT_NE(r.out.find("frames checked:       120"), std::string::npos) << r.out;
    EXPECT_NE(r.err.find("frames 120 to 129 are lost"), std::string::npos) << r.err;
    EXPECT_EQ(run_flotilla("verify " + run.folder.path().string()).exit_code, 5) << "no run folder";
    EXPECT_EQ(run_flotilla("verify").exit_code, 2);
}

TEST(VerifyCommand, JudgesATrajectoryFromAFile) {
    PlateRun run;
    const std::string folder = run.write();
    const std::string shape =
        R"({"name": "plate", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "mass": 1})";
    const std::string scene =
        run.folder.write("scene.json", R"({"flotilla_scene": 1, "settings": {"time_step": 0.04}, "shapes": [)" + shape +
                                           R"(], "bodies": [
            {"name": "body \"0\", plate", "shape": "plate", "type": "static"},
            {"name": "body \"1\", plate", "shape": "plate", "position": [0.1, 0.1, 1]}]})");
    const CommandOutput csv = run_flotilla("export " + folder + " --format csv");
    ASSERT_EQ(csv.exit_code, 0) << csv.err;
    const std::string poses = run.folder.write("poses.csv", csv.out);
    const CommandOutput clean = run_flotilla("verify " + scene + " --poses " + poses);
    EXPECT_EQ(clean.exit_code, 0) << clean.err << clean.out;
    EXPECT_NE(clean.out.find("motions checked:      5\n"), std::string::npos) << clean.out;

    for (std::size_t k = 4; k < run.frames.size(); ++k) run.frames[k].position[1].z -= 2;
    const std::string jump = run.folder.write("jump.csv", run_flotilla("export " + run.write()).out);
    EXPECT_EQ(run_flotilla("verify " + scene + " --poses " + jump).exit_code, 3);
    const std::string wrong = run.folder.write("wrong.csv", "frame,time\n");
    EXPECT_EQ(run_flotilla("verify " + scene + " --poses " + wrong).exit_code, 2);
    EXPECT_EQ(run_flotilla("verify " + scene + " --poses none.csv").exit_code, 5);
}

TEST(ExportCommand, WritesEveryFormat) {
    const PlateRun run;
    const std::string folder = run.write();
    const std::string csv = run_flotilla("export " + folder).out;
    EXPECT_TRUE(csv.starts_with("frame,time,body,name,px,py,pz,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n0,0,0,"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 6 * 2);
    const std::string file = folder + "/poses.csv";
    EXPECT_EQ(run_flotilla("export " + folder + " --format csv --output " + file).exit_code, 0);
    EXPECT_EQ(fs::file_size(file), csv.size());
    for (const char* format : {"vtp", "obj", "glb", "usd"})
        EXPECT_EQ(run_flotilla("export " + folder + " --format " + format).exit_code, 0) << format;
    EXPECT_TRUE(fs::exists(folder + "/vtp/bodies.pvd"));
    EXPECT_TRUE(fs::exists(folder + "/obj/frame-00000005.obj"));
    EXPECT_TRUE(fs::exists(folder + "/run.glb"));
    EXPECT_TRUE(fs::exists(folder + "/run.usda"));
    EXPECT_EQ(run_flotilla("export " + folder + " --format xyz").exit_code, 2);
    EXPECT_EQ(run_flotilla("export " + folder + " --output /proc/none/poses.csv").exit_code, 5);
    EXPECT_EQ(run_flotilla("export " + run.folder.path().string()).exit_code, 5) << "no run folder";
}

TEST(ExportCommand, WritesARangeOfFrames) {
    const PlateRun run; // frames 0 to 5
    const std::string export_run = "export " + run.write();
    const auto frames = [&](const std::string& range) {
        std::istringstream csv(run_flotilla(export_run + " --frames " + range).out);
        std::string line, numbers;
        std::getline(csv, line);
        while (std::getline(csv, line))
            if (line.find(",0,") != std::string::npos && !numbers.ends_with(line.substr(0, line.find(','))))
                numbers += line.substr(0, line.find(','));
        return numbers;
    };
    EXPECT_EQ(frames("1:3"), "123");
    EXPECT_EQ(frames("1::2"), "135");
    EXPECT_EQ(frames(":2"), "012");
    EXPECT_EQ(frames("4"), "4");
    EXPECT_EQ(frames("4:99"), "45");
    for (const char* bad : {"x", "1:2:0", "1:2:3:4", ":::", "1:2:3:", "1.5", "9", "3:2", "-1"})
        EXPECT_EQ(run_flotilla(export_run + " --frames=" + bad).exit_code, 2) << bad;
}

/// Exports the run in every format; the command says nothing before so little, and the estimate is near what was
/// written.
void expect_estimates_hold(const fs::path& run, std::int64_t frames) {
    for (const auto& [name, format] :
         {std::pair("csv", ExportFormat::csv), std::pair("vtp", ExportFormat::vtp), std::pair("obj", ExportFormat::obj),
          std::pair("glb", ExportFormat::glb), std::pair("usd", ExportFormat::usd)}) {
        const fs::path output = run.parent_path() / name;
        fs::remove_all(output);
        const CommandOutput r =
            run_flotilla("export " + run.string() + " --format " + name + " --output " + output.string());
        ASSERT_EQ(r.exit_code, 0) << r.err;
        EXPECT_EQ(r.err, "wrote " + output.string() + "\n") << "nothing is said of little";
        double bytes = 0;
        if (fs::is_directory(output)) {
            for (const auto& file : fs::recursive_directory_iterator(output))
                if (file.is_regular_file()) bytes += static_cast<double>(file.file_size());
        } else {
            bytes = static_cast<double>(fs::file_size(output));
        }
        const ExportSize size = estimate_export(run, format);
        EXPECT_EQ(size.frames, frames);
        EXPECT_NEAR(static_cast<double>(size.bytes) / bytes, 1, 1.0 / 3) << name;
    }
}

TEST(ExportCommand, KnowsHowMuchItWrites) {
    const TemporaryFolder folder;
    const std::string scene = (folder.path() / "scene.json").string();
    const fs::path run = folder.path() / "run";
    std::ofstream(scene) << run_flotilla("scene boats-in-bowl --bodies 12").out;
    for (const int steps : {80, 1}) { // the start has few digits
        ASSERT_EQ(run_flotilla("run --quiet --overwrite --steps " + std::to_string(steps) + " --output " +
                               run.string() + " " + scene)
                      .exit_code,
                  0);
        expect_estimates_hold(run, steps + 1);
    }
}

TEST(ExportCommand, KnowsHowMuchOfFixedBodiesItWrites) {
    for (const bool turned : {true, false}) {
        SCOPED_TRACE(turned ? "turned" : "as they are");
        const TemporaryFolder folder;
        io::RunScene scene = sample_scene(400);
        for (io::RunBody& body : scene.bodies) body.type = BodyType::fixed;
        scene.shapes[0].mesh.vertices.push_back({0.25, 0.25, 0.5});
        io::RunWriter writer(folder.path() / "run", sample_info(), scene, io::OpenRun::create);
        std::vector<Vec3> position, zero(400);
        std::vector<Quat> rotation;
        for (int i = 0; i < 400; ++i) {
            const double x = turned ? std::sqrt(i + 2) : i;
            position.push_back({x, 2 * x, x / 3});
            rotation.push_back(turned ? rotation_from_vector({0.1, 0.2 * x, 0.3}) : Quat{});
        }
        for (std::int64_t k = 0; k < 20; ++k)
            writer.add_frame({k, 0.04 * static_cast<double>(k), position, rotation, zero, zero, {}});
        writer.close("complete");
        expect_estimates_hold(folder.path() / "run", 20);
    }
}

TEST(ExportCommand, WarnsBeforeItWritesGigabytes) {
    const TemporaryFolder folder;
    io::RunScene scene = sample_scene(3000);
    for (int i = 0; i < 20000; ++i) scene.shapes[0].mesh.vertices.push_back({0.1 * i, 0, 0});
    const std::string run = (folder.path() / "run").string();
    {
        io::RunWriter writer(run, sample_info(), scene, io::OpenRun::create);
        write_sample(writer, 3000, 0, 1, true);
        writer.close("complete");
    }
    const auto warning = [&](const std::string& options) {
        const CommandOutput r = run_flotilla("export " + run + " --output /proc/none/out " + options);
        EXPECT_EQ(r.exit_code, 5) << "nothing can be written there";
        return r.err;
    };
    EXPECT_NE(warning("--format obj").find("export writes about 3.6 GB in 2 frames; --frames "), std::string::npos);
    EXPECT_NE(warning("--format obj --frames 1").find("about 2.6 GB in 1 frame;"), std::string::npos);
    EXPECT_EQ(warning("--format csv").find("writes about"), std::string::npos);
}

TEST(InfoCommand, DescribesARun) {
    const PlateRun run;
    const std::string folder = run.write();
    const CommandOutput r = run_flotilla("info " + folder);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.out.find("status:       complete"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("command:      flotilla run scene.json"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("bodies:       2 (1 dynamic), 1 shapes, 2 triangles"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("frames:       6, the last at step 5, t = 0.2 s"), std::string::npos) << r.out;
    EXPECT_NE(r.out.find("checkpoint:   none"), std::string::npos) << r.out;
    fs::resize_file(folder + "/frames-00000000-00000005.h5", 1000);
    const CommandOutput damaged = run_flotilla("info " + folder);
    EXPECT_EQ(damaged.exit_code, 5);
    EXPECT_NE(damaged.err.find("frames 0 to 5 are lost"), std::string::npos) << damaged.err;
}

/// A block that comes to rest on the ground at once; `settings` as in a scene file.
std::string resting_block(const TemporaryFolder& folder, const std::string& settings) {
    return folder.write("block.json", R"({"flotilla_scene": 1, "settings": {"time_step": 0.02)" + settings + R"(},
        "shapes": [{"name": "block", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0.3,0.3,1]], "triangles": [[0,2,1],[0,1,3],[1,2,3],[2,0,3]], "mass": 2},
                   {"name": "ground", "vertices": [[-9,-9,0],[9,-9,0],[0,9,0]], "triangles": [[0,1,2]]}],
        "bodies": [{"name": "block", "shape": "block", "position": [0, 0, 0.001]}, {"name": "ground", "shape": "ground", "type": "static"}]})");
}

TEST(RunCommand, WritesContactsOnRequest) {
    const TemporaryFolder folder;
    const std::string in = folder.path().string() + "/", scene = resting_block(folder, R"(, "sleeping": false)");
    ASSERT_EQ(run_flotilla("run --quiet --steps 40 --contacts " + in + "contacts.csv " + scene).exit_code, 0);
    ASSERT_EQ(run_flotilla("run --quiet --steps 40 --contacts " + in + "contacts.csv.gz " + scene).exit_code, 0);
    const std::string text = io::read_text(in + "contacts.csv");
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "step,time,body_a,body_b,px,py,pz,nx,ny,nz,gap,normal_impulse,tangential_impulse,asleep");
    double carried = 0;
    int rows = 0;
    while (std::getline(lines, line)) {
        const auto fields = io::step_csv_fields(line);
        ASSERT_EQ(fields.size(), 14u) << line;
        EXPECT_EQ(fields[13], "0");
        if (fields[0] != "40") continue;
        ++rows;
        EXPECT_EQ(fields[1], "0.8");
        EXPECT_EQ(fields[2], "0");
        EXPECT_EQ(fields[3], "1");
        EXPECT_EQ(fields[9], "-1") << "from the block down to the ground";
        carried += std::stod(std::string(fields[11]));
        EXPECT_LE(std::stod(std::string(fields[12])), 0.1 * std::sqrt(2.0) * std::stod(std::string(fields[11])) + 1e-9);
    }
    EXPECT_GE(rows, 3);
    EXPECT_NEAR(carried, 2 * 9.8 * 0.02, 0.01 * 2 * 9.8 * 0.02);
    std::istringstream totals(io::read_text(in + "contacts-bodies.csv"));
    std::getline(totals, line);
    EXPECT_EQ(line, "step,time,body,contacts,normal_impulse,tangential_impulse,impulse_x,impulse_y,impulse_z");
    std::vector<std::vector<std::string>> last;
    while (std::getline(totals, line)) {
        const auto fields = io::step_csv_fields(line);
        ASSERT_EQ(fields.size(), 9u) << line;
        if (fields[0] == "40") last.emplace_back(fields.begin(), fields.end());
    }
    ASSERT_EQ(last.size(), 2u) << "block and ground";
    EXPECT_EQ(last[0][2], "0");
    EXPECT_EQ(last[0][3], std::to_string(rows));
    EXPECT_NEAR(std::stod(last[0][4]), carried, 1e-12);
    EXPECT_NEAR(std::stod(last[0][8]), 2 * 9.8 * 0.02, 0.01 * 2 * 9.8 * 0.02) << "the block's weight, upwards";
    EXPECT_NEAR(std::stod(last[1][8]), -std::stod(last[0][8]), 1e-12);
    EXPECT_TRUE(fs::exists(in + "contacts-bodies.csv.gz"));
    io::InputStream packed(in + "contacts.csv.gz");
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(packed.stream()), {}), text);
    EXPECT_EQ(run_flotilla("run --quiet --steps 1 --contacts /proc/none/contacts.csv " + scene).exit_code, 5);
}

TEST(RunCommand, KeepsTheEarlierRunWhereItsOtherFilesCannotBeWritten) {
    const TemporaryFolder folder;
    const std::string in = folder.path().string() + "/", scene = resting_block(folder, "");
    const std::string run = "run --quiet --steps 3 --output " + in + "run " + scene;
    ASSERT_EQ(run_flotilla(run).exit_code, 0);
    const std::string steps = io::read_text(in + "run/steps.csv");
    fs::create_directories(in + "taken-bodies.csv");
    for (const char* option : {"--contacts /proc/none/c.csv", "--trace /proc/none/t.json", "--trace /proc/t.json"}) {
        const CommandOutput r = run_flotilla(run + " --overwrite " + option);
        EXPECT_EQ(r.exit_code, 5) << option;
        EXPECT_NE(r.err.find(": cannot write: "), std::string::npos) << r.err;
        EXPECT_EQ(io::read_text(in + "run/steps.csv"), steps) << option;
    }
    EXPECT_EQ(run_flotilla(run + " --overwrite --contacts " + in + "taken.csv").exit_code, 5) << "of the totals";
    EXPECT_EQ(io::read_text(in + "run/steps.csv"), steps);
    const std::string other = "run --quiet --steps 3 --output " + in + "other " + scene;
    EXPECT_EQ(run_flotilla(other + " --contacts /proc/none/c.csv").exit_code, 5);
    EXPECT_EQ(run_flotilla(other + " --contacts " + in + "other/c.csv").exit_code, 0) << "nothing was begun there";
}

TEST(RunCommand, ContactsOfSleepingBodiesStay) {
    const TemporaryFolder folder;
    const std::string in = folder.path().string() + "/", scene = resting_block(folder, "");
    const CommandOutput r =
        run_flotilla("run --steps 40 --output " + in + "run --contacts " + in + "contacts.csv " + scene);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.out.find("contacts at the end: 3, all asleep"), std::string::npos) << r.out;
    EXPECT_NE(r.err.find("ms/step, 3 contacts"), std::string::npos) << r.err;
    std::istringstream lines(io::read_text(in + "contacts.csv"));
    double carried = 0;
    int rows = 0;
    for (std::string line; std::getline(lines, line);) {
        const auto fields = io::step_csv_fields(line);
        if (fields[0] != "40") continue;
        EXPECT_EQ(fields[13], "1");
        carried += std::stod(std::string(fields[11]));
        ++rows;
    }
    EXPECT_EQ(rows, 3);
    EXPECT_NEAR(carried, 2 * 9.8 * 0.02, 0.01 * 2 * 9.8 * 0.02);
    io::RunReader run(in + "run");
    const io::Frame last = run.frame(40);
    EXPECT_EQ(last.activity.contacts, (std::vector<std::uint16_t>{3, 3}));
    EXPECT_EQ(last.activity.cluster, (std::vector<std::uint8_t>{4, 0})) << "the ground does not sleep";
    const std::string steps = io::read_text(in + "run/steps.csv");
    EXPECT_TRUE(steps.ends_with(",3\n")) << steps.substr(steps.size() - 200);
    EXPECT_NE(steps.find(",sleeping_contacts\n"), std::string::npos);
}

TEST(RunCommand, RecordsItsCommandLine) {
    const TemporaryFolder folder;
    const std::string scene = (folder.path() / "two.json").string(), out = (folder.path() / "run").string();
    std::ofstream(scene) << run_flotilla("scene stack --bodies 2").out;
    const CommandOutput r = run_flotilla("run --quiet --steps 2 --output " + out + " " + scene);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    const auto command = io::RunReader(out).info().command_line;
    ASSERT_EQ(command.size(), 8u);
    EXPECT_EQ((std::vector<std::string>(command.begin() + 1, command.end())),
              (std::vector<std::string>{"run", "--quiet", "--steps", "2", "--output", out, scene}));
}

} // namespace
} // namespace flotilla::test
