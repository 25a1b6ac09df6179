// SPDX-License-Identifier: MIT
// Trajectories in the CSV export format: what was read is written and read again to the same, and verified.
#include <cmath>
#include <vector>

#include <flotilla/verify.hpp>

#include "fuzz/checks.hpp"
#include "run_folder/poses_csv.hpp"
#include "run_folder/run_folder.hpp"

namespace {

using namespace flotilla;

constexpr std::string_view kScene = R"({"flotilla_scene": 1,
  "shapes": [{"name": "t", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0.2,0.2,0.5]],
              "triangles": [[0,1,2],[0,1,3]], "mass": 1}],
  "bodies": [{"name": "a", "shape": "t"}, {"name": "b \"2\", c", "shape": "t", "position": [3,0,0]}]})";
const std::vector<std::string> kNames{"a", "b \"2\", c"};

std::vector<io::Frame> read_all(const std::filesystem::path& path) {
    io::PosesCsvReader reader(path, kNames);
    std::vector<io::Frame> frames;
    for (io::Frame frame; reader.next(frame);) frames.push_back(frame);
    return frames;
}

std::string text_of(const std::vector<io::Frame>& frames) {
    std::string text = std::string(io::kPosesHeader) + "\n";
    for (const io::Frame& frame : frames) text += io::poses_csv_rows(frame, kNames);
    return text;
}

void check_verdict(const VerifyReport& report, const std::vector<io::Frame>& frames) {
    bool finite = true;
    for (const io::Frame& frame : frames)
        for (std::size_t i = 0; i < kNames.size(); ++i) {
            const Vec3& p = frame.position[i];
            finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
        }
    fuzz::require(finite || report.bad_poses > 0, "a place that is no number is found");
    fuzz::require(report.frames == static_cast<std::int64_t>(frames.size()), "every frame is looked at");
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::filesystem::path scene = fuzz::write_scratch("scene.json", kScene);
    const std::filesystem::path path = fuzz::write_scratch("poses.csv", fuzz::text_of(data, size));
    std::vector<io::Frame> frames;
    if (!fuzz::accepted("poses.csv", [&] { frames = read_all(path); })) return 0;
    const std::string once = text_of(frames);
    fuzz::require(text_of(read_all(fuzz::write_scratch("again.csv", once))) == once,
                  "written poses read back to the same");
    fuzz::accepted("poses.csv", [&] { check_verdict(verify_poses(scene, path, fuzz::one_thread()), frames); });
    return 0;
}
