// SPDX-License-Identifier: MIT
// flotilla report: files, messages and exit codes.
#include <gtest/gtest.h>

#include "io/file.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/sample_run.hpp"
#include "support/command.hpp"

namespace flotilla::test {
namespace {

namespace fs = std::filesystem;

void write_run(const fs::path& folder, std::size_t bodies, std::int64_t last_frame) {
    io::RunWriter writer(folder, sample_info(), sample_scene(bodies), io::OpenRun::create);
    write_sample(writer, bodies, 0, last_frame);
    writer.close("complete");
}

TEST(ReportCommand, WritesIntoTheRunFolderOrWhereItIsTold) {
    const TemporaryFolder folder;
    const std::string run = folder.path() / "run", page = folder.path() / "page.html";
    write_run(run, 2, 3);
    const CommandOutput r = run_flotilla("report " + run);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(r.out, "");
    EXPECT_NE(r.err.find("4 of 4 frames"), std::string::npos) << r.err;
    EXPECT_TRUE(fs::exists(run + "/report.html"));
    EXPECT_EQ(run_flotilla("report " + run + " --frame-every 2 --output " + page).exit_code, 0);
    EXPECT_NE(io::read_text(page).find("\"frames\":[0,2,3]"), std::string::npos);
}

TEST(ReportCommand, ShowsADamagedRunAndSaysSo) {
    const TemporaryFolder folder;
    const std::string run = folder.path() / "run";
    write_run(run, 2, 130);
    fs::remove(io::segment_path(run, 0, 119));
    const CommandOutput r = run_flotilla("report " + run);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_NE(r.err.find("frames 0 to 119 are missing"), std::string::npos) << r.err;
    EXPECT_NE(io::read_text(run + "/report.html").find("frames 0 to 119 are missing"), std::string::npos);
}

TEST(ReportCommand, ExitsAsTheVerdictDemands) {
    const TemporaryFolder folder;
    const std::string apart = folder.path() / "apart", crossing = folder.path() / "crossing";
    write_run(apart, 1, 2);
    write_run(crossing, 3, 2);
    EXPECT_EQ(run_flotilla("report " + apart + " --verify --threads 1").exit_code, 0);
    EXPECT_EQ(run_flotilla("report " + crossing + " --verify --threads 1 --quiet").exit_code, 3);
    EXPECT_EQ(run_flotilla("report " + crossing).exit_code, 0) << "nothing was asked";
}

TEST(ReportCommand, TellsBadOptionsFromFailures) {
    const TemporaryFolder folder;
    EXPECT_EQ(run_flotilla("report " + folder.path().string()).exit_code, 5) << "no run folder";
    EXPECT_FALSE(fs::exists(folder.path() / "report.html"));
    EXPECT_EQ(run_flotilla("report").exit_code, 2);
    EXPECT_EQ(run_flotilla("report " + folder.path().string() + " --frame-every 0").exit_code, 2);
}

} // namespace
} // namespace flotilla::test
