// SPDX-License-Identifier: MIT
// The page as a file: what is in it, and what a browser would load.
#include <flotilla/html_report.hpp>

#include <regex>

#include <gtest/gtest.h>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "report/report_page.hpp"
#include "run_folder/damage.hpp"
#include "run_folder/run_files.hpp"
#include "run_folder/sample_run.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class HtmlReportFile : public ::testing::Test {
  protected:
    fs::path run() const { return folder_.path() / "run"; }
    fs::path page() const { return folder_.path() / "report.html"; }

    void write_run(std::int64_t last_frame, const io::RunScene& scene = sample_scene(3),
                   const io::RunInfo& info = sample_info()) const {
        io::RunWriter writer(run(), info, scene, io::OpenRun::create);
        write_sample(writer, scene.bodies.size(), 0, last_frame);
        writer.close("complete");
    }
    std::string html() const { return io::read_text(page()); }
    json data() const { return json::parse(test::element_text(html(), "data")); }
    static std::string text_of(const json& table) { return table.dump(); }
    static json table(const json& data, const std::string& title) {
        for (const json& t : data["tables"])
            if (t["title"] == title) return t;
        return {};
    }

    test::TemporaryFolder folder_;
};

TEST_F(HtmlReportFile, HoldsThePosesOfTheRun) {
    write_run(4);
    const HtmlReport report = write_html_report(run(), page());
    EXPECT_EQ(report.frames, 5);
    EXPECT_EQ(report.frames_shown, 5);
    EXPECT_EQ(report.bytes, fs::file_size(page()));
    EXPECT_TRUE(report.problems.empty());
    const json d = data(), track = d["track"];
    const std::vector<double> origin = track["origin"];
    const auto poses =
        test::decode_poses(test::from_base64(test::element_text(html(), "poses")), 5, test::floats_of(track["boxes"]),
                           {origin[0], origin[1], origin[2]}, track["top_speed"]);
    io::RunReader reader(run());
    for (std::size_t k = 0; k < 5; ++k) {
        const io::Frame frame = reader.frame(static_cast<std::int64_t>(k));
        EXPECT_EQ(track["times"][k], frame.time);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t body = d["bodies"]["indices"][i];
            const Vec3 middle{0.5, 0.5, 0}; // of the sample's plate
            const Vec3 expected = frame.position[body] + rotate(frame.rotation[body], middle);
            EXPECT_LE(length(poses[k][i].middle - expected), report.position_error + 1e-6);
            EXPECT_LE(length(rotation_vector(poses[k][i].rotation * conjugate(frame.rotation[body]))),
                      report.rotation_error + 1e-12);
        }
    }
    EXPECT_LT(report.position_error, 1e-3);
    EXPECT_LT(report.rotation_error, 1e-4);
    EXPECT_EQ(test::floats_of(d["plots"]["step"]), (std::vector<float>{1, 2, 3, 4}));
    EXPECT_EQ(test::floats_of(d["shapes"][0]["vertices"]).size(), 9u);
}

TEST_F(HtmlReportFile, NeedsNoOtherFileAndNoNetwork) {
    write_run(2);
    write_html_report(run(), page());
    const std::string text = html();
    for (const char* loads : {"http:", "https:", "src=", "href=", "@import", "url(", "fetch(", "XMLHttpRequest"})
        EXPECT_EQ(text.find(loads), std::string::npos) << loads;
    EXPECT_NE(text.find("default-src 'none'"), std::string::npos);
    EXPECT_EQ(text.find("{{"), std::string::npos) << "a placeholder is left";
}

TEST_F(HtmlReportFile, NamesCannotBecomeMarkup) {
    const std::string hostile = "</script><script>alert(1)</script><!-- \"' & {{poses}} \xff";
    io::RunScene scene = sample_scene(2);
    scene.bodies[0].name = hostile;
    scene.shapes[0].name = hostile;
    io::RunInfo info = sample_info();
    info.command_line = {"flotilla", "run", "</script><script>alert(2)</script>"};
    write_run(2, scene, info);
    write_html_report(run(), page());
    const std::string text = html();
    EXPECT_EQ(text.find("alert(1)</script>"), std::string::npos);
    EXPECT_EQ(text.find("alert(2)</script>"), std::string::npos);
    const std::regex script("<script"), end("</script");
    const auto count = [&](const std::regex& r) {
        return std::distance(std::sregex_iterator(text.begin(), text.end(), r), std::sregex_iterator());
    };
    EXPECT_EQ(count(script), 3);
    EXPECT_EQ(count(end), 3);
    // Back to the name itself, but for the byte that is no UTF-8.
    EXPECT_EQ(data()["bodies"]["names"][1], hostile.substr(0, hostile.size() - 1) + "\xef\xbf\xbd");
    EXPECT_FALSE(test::element_text(text, "poses").empty());
}

TEST_F(HtmlReportFile, ShowsWhatIsReadableAndNamesWhatIsLost) {
    write_run(200); // two segments: frames 0 to 119, and the rest
    const fs::path damaged = io::segment_path(run(), 0, 119);
    flip_bit(damaged, 100);
    const HtmlReport report = write_html_report(run(), page());
    EXPECT_EQ(report.frames, 201);
    EXPECT_EQ(report.frames_shown, 81);
    ASSERT_EQ(report.problems.size(), 1u);
    EXPECT_NE(report.problems[0].find("frames 0 to 119 are lost"), std::string::npos) << report.problems[0];
    EXPECT_EQ(data()["problems"][0], report.problems[0]);
    EXPECT_EQ(data()["track"]["frames"][0], 120);

    fs::remove(damaged);
    fs::remove(run() / io::kStepsCsv);
    const HtmlReport missing = write_html_report(run(), page());
    EXPECT_EQ(missing.frames_shown, 81);
    ASSERT_EQ(missing.problems.size(), 2u);
    EXPECT_NE(missing.problems[0].find("frames 0 to 119 are missing"), std::string::npos) << missing.problems[0];
    EXPECT_NE(missing.problems[1].find("steps.csv"), std::string::npos) << missing.problems[1];
}

TEST_F(HtmlReportFile, ShowsARunWithoutAnyFrame) {
    write_run(0);
    fs::remove(io::segment_path(run(), 0, 0));
    const HtmlReport report = write_html_report(run(), page());
    EXPECT_EQ(report.frames_shown, 0);
    EXPECT_EQ(test::element_text(html(), "poses"), "");
}

TEST_F(HtmlReportFile, SaysWhereTheRunComesFromAndHowItWent) {
    {
        io::RunWriter writer(run(), sample_info(), sample_scene(3), io::OpenRun::create);
        StepReport row;
        row.step = 1, row.total_ms = 10, row.merges = 2, row.state_hash = 0xfe, row.min_distance = 3e-4;
        writer.add_step(row);
        row.step = 2, row.total_ms = 30, row.warnings = kDynamicLimit | kReboundLost, row.min_distance = 5e-4;
        writer.add_step(row);
        writer.close("stopped");
    }
    write_html_report(run(), page());
    const json d = data();
    const auto expect = [&](const char* title, const char* text) {
        EXPECT_NE(text_of(table(d, title)).find(text), std::string::npos) << title << ": " << text_of(table(d, title));
    };
    expect("Summary", "\"mean time per step\",\"20 ms\"");
    expect("Summary", "30 ms (step 2)");
    expect("Summary", "4 merges");
    expect("Summary", "0.0003 m (step 1)");
    expect("Summary", "00000000000000fe");
    expect("Summary", "stopped");
    expect("Warnings", "raise dynamic_iterations");
    expect("Warnings", "1 step, first at step 2");
    expect("Settings", "\"friction\",\"0.25\"");
    expect("Provenance", "flotilla run scene.json");
    expect("Verification", "flotilla verify");
    EXPECT_EQ(d["verdict"], "not verified");
}

TEST_F(HtmlReportFile, HoldsTheVerdictWhereAskedFor) {
    write_run(2); // the plates of the sample cross one another
    HtmlReportOptions options;
    options.verify = true;
    options.verification.threads = 1;
    const HtmlReport report = write_html_report(run(), page(), options);
    ASSERT_TRUE(report.verification.has_value());
    EXPECT_FALSE(report.verification->proved());
    EXPECT_EQ(data()["verdict"], "failed");
    EXPECT_NE(text_of(table(data(), "Verification")).find("\"fault\""), std::string::npos);

    fs::remove_all(run());
    write_run(2, sample_scene(1));
    EXPECT_TRUE(write_html_report(run(), page(), options).verification->proved());
    EXPECT_EQ(data()["verdict"], "proved");
}

TEST_F(HtmlReportFile, RefusesWhatIsNoRunFolder) {
    EXPECT_THROW((void)write_html_report(folder_.path(), page()), IoError);
    write_run(1);
    EXPECT_THROW((void)write_html_report(run(), folder_.path() / "absent" / "report.html"), IoError);
    HtmlReportOptions options;
    options.frame_every = -1;
    EXPECT_THROW((void)write_html_report(run(), page(), options), InputError);
    EXPECT_FALSE(fs::exists(page()));
}

} // namespace
} // namespace flotilla
