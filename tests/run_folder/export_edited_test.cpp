// SPDX-License-Identifier: MIT
// Exports of runs in which bodies come and go: who is not there is in no frame.
#include <algorithm>
#include <cstring>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/file.hpp"
#include "run_folder/export.hpp"
#include "run_folder/sample_run.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Frames 0 to 4 of three bodies, as write_sample() has them; body 1 leaves after frame 2, body 2 comes with it.
class ExportEdited : public testing::Test {
  protected:
    explicit ExportEdited(bool edited = true) {
        io::RunInfo info = sample_info();
        if (edited) info.edits_json = "{}", info.scene_bodies = 2;
        io::RunWriter writer(run_folder(), info, sample_scene(3), io::OpenRun::create);
        for (std::int64_t k = 0; k < 5; ++k) {
            SampleFrame frame(3, k);
            io::Activity activity;
            for (std::size_t i = 0; i < 3; ++i) {
                if (!edited || there(i, k)) {
                    activity.append({});
                    continue;
                }
                activity.append_absent();
                frame.position[i] = {}, frame.rotation[i] = {};
            }
            frame.view.activity = activity.view();
            writer.add_frame(frame.view);
        }
        writer.close("complete");
    }
    [[nodiscard]] static bool there(std::size_t body, std::int64_t k) {
        return body == 0 || (body == 1 ? k <= 2 : k >= 2);
    }
    [[nodiscard]] fs::path run_folder() const { return folder_.path() / "run"; }
    [[nodiscard]] std::string usd(const FrameRange& range = {}) const {
        io::RunReader run(run_folder());
        io::export_usd(run, io::frames_of(run, range), folder_.path() / "run.usda");
        return io::read_text(folder_.path() / "run.usda");
    }

    /// A glTF file as a reader sees it.
    struct Glb {
        nlohmann::json json;
        std::vector<std::byte> binary;

        [[nodiscard]] std::vector<float> floats(std::size_t accessor) const {
            const auto& a = json["accessors"][accessor];
            const auto& view = json["bufferViews"][a["bufferView"].get<std::size_t>()];
            std::vector<float> values(view["byteLength"].get<std::size_t>() / sizeof(float));
            std::memcpy(values.data(), binary.data() + view["byteOffset"].get<std::size_t>(),
                        values.size() * sizeof(float));
            return values;
        }
        /// The sampler of a channel of body i; null where there is none.
        [[nodiscard]] nlohmann::json sampler(std::size_t body, const std::string& path) const {
            if (!json.contains("animations")) return nullptr;
            const auto& animation = json["animations"][0];
            for (const auto& channel : animation["channels"])
                if (channel["target"]["node"] == body + 1 && channel["target"]["path"] == path)
                    return animation["samplers"][channel["sampler"].get<std::size_t>()];
            return nullptr;
        }
        [[nodiscard]] std::vector<float> track(std::size_t body, const std::string& path) const {
            return floats(sampler(body, path)["output"].get<std::size_t>());
        }
    };
    [[nodiscard]] Glb glb(const FrameRange& range = {}) const {
        io::RunReader run(run_folder());
        io::export_glb(run, io::frames_of(run, range), folder_.path() / "run.glb");
        const std::vector<std::byte> bytes = io::read_file(folder_.path() / "run.glb");
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 12, sizeof length);
        const auto* text = reinterpret_cast<const char*>(bytes.data()) + 20;
        return {nlohmann::json::parse(text, text + length), {bytes.begin() + 28 + length, bytes.end()}};
    }

    test::TemporaryFolder folder_;
};

struct ExportUnedited : ExportEdited {
    ExportUnedited() : ExportEdited(false) {}
};

TEST_F(ExportEdited, VtpHasPointsOfTheBodiesThatAreThere) {
    io::RunReader run(run_folder());
    io::export_vtp(run, io::frames_of(run, {}), folder_.path() / "vtp");
    const auto frame = [&](int k) {
        return io::read_text(folder_.path() / "vtp" / "frames" / ("bodies-0000000" + std::to_string(k) + ".vtp"));
    };
    EXPECT_THAT(frame(0), HasSubstr("NumberOfPoints=\"2\" NumberOfVerts=\"2\""));
    EXPECT_THAT(frame(2), HasSubstr("NumberOfPoints=\"3\" NumberOfVerts=\"3\""));
    // Body numbers 0 and 1, then 0 and 2, as 64-bit integers after their size, 16 bytes, in base64.
    EXPECT_THAT(
        frame(0),
        HasSubstr("Name=\"body\" NumberOfComponents=\"1\" format=\"binary\">EAAAAAAAAAAAAAAAAAAAAAEAAAAAAAAA<"));
    EXPECT_THAT(
        frame(4),
        HasSubstr("Name=\"body\" NumberOfComponents=\"1\" format=\"binary\">EAAAAAAAAAAAAAAAAAAAAAIAAAAAAAAA<"));
    const std::string points = "<Points>";
    EXPECT_LT(frame(0).substr(frame(0).find(points)).size(), frame(2).substr(frame(2).find(points)).size());
}

TEST_F(ExportEdited, GlbHidesBodiesInFramesThatTheyAreNotIn) {
    const Glb file = glb();
    EXPECT_TRUE(file.sampler(0, "scale").is_null());
    for (const std::size_t body : {1u, 2u}) {
        ASSERT_FALSE(file.sampler(body, "scale").is_null()) << body;
        EXPECT_EQ(file.sampler(body, "scale")["interpolation"], "STEP") << "no body grows or shrinks";
        EXPECT_EQ(file.sampler(body, "translation")["interpolation"], "LINEAR");
        for (std::int64_t k = 0; k < 5; ++k)
            for (std::size_t axis = 0; axis < 3; ++axis)
                EXPECT_EQ(file.track(body, "scale")[3 * static_cast<std::size_t>(k) + axis], there(body, k) ? 1 : 0);
    }
    EXPECT_FALSE(file.json["nodes"][2].contains("scale"));
    EXPECT_EQ(file.json["nodes"][3]["scale"], nlohmann::json({0, 0, 0})) << "before an animation runs";
}

TEST_F(ExportEdited, GlbMovesNobodyOnTheWayInAndOut) {
    const Glb file = glb();
    const auto y = [&](std::size_t body) {
        std::vector<float> out;
        const std::vector<float> track = file.track(body, "translation");
        for (std::size_t k = 0; k < 5; ++k) out.push_back(track[3 * k + 1]);
        return out;
    };
    EXPECT_THAT(y(0), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_THAT(y(1), ElementsAre(0, 1, 2, 2, 2));
    EXPECT_THAT(y(2), ElementsAre(2, 2, 2, 3, 4));
}

TEST_F(ExportEdited, GlbOfARangeHasNoMeshOfWhoIsInNoneOfItsFrames) {
    const Glb file = glb({0, 1});
    EXPECT_TRUE(file.json["nodes"][2].contains("mesh"));
    EXPECT_FALSE(file.json["nodes"][3].contains("mesh"));
    EXPECT_FALSE(glb({3, 3}).json["nodes"][2].contains("mesh"));
}

TEST_F(ExportEdited, UsdNamesWhoIsInvisible) {
    const std::string text = usd();
    EXPECT_THAT(text,
                HasSubstr("        int64[] invisibleIds.timeSamples = {\n            0: [2],\n            1: [2],\n"
                          "            2: [],\n            3: [1],\n            4: [1],\n        }\n"));
    EXPECT_THAT(text, HasSubstr("0: [(0,0,0.1),(1,0,0.1),(2,2,0.1)],")) << "where it will come";
    EXPECT_THAT(text, HasSubstr("4: [(0,4,0.1),(1,2,0.1),(2,4,0.1)],")) << "where it went";
}

TEST_F(ExportUnedited, NobodyIsHidden) {
    EXPECT_THAT(usd(), Not(HasSubstr("invisibleIds")));
    const Glb file = glb();
    for (const std::size_t body : {0u, 1u, 2u}) {
        EXPECT_TRUE(file.sampler(body, "scale").is_null());
        EXPECT_TRUE(file.json["nodes"][body + 1].contains("mesh"));
    }
}

} // namespace
} // namespace flotilla
