// SPDX-License-Identifier: MIT
#include "io/export.hpp"

#include <cstring>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "io/file.hpp"
#include "io/sample_run.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla {
namespace {

namespace fs = std::filesystem;

class Export : public ::testing::Test {
  protected:
    Export() {
        io::RunWriter writer(folder_.path(), sample_info(), sample_scene(3), io::OpenRun::create);
        write_sample(writer, 3, 0, 4, true);
        writer.close("complete");
    }
    test::TemporaryFolder folder_;
};

TEST_F(Export, ObjHasEveryBodyWhereTheFramePutsIt) {
    io::RunReader run(folder_.path());
    io::export_obj(run, folder_.path() / "obj");
    const std::string text = io::read_text(folder_.path() / "obj" / "frame-00000000.obj");
    EXPECT_NE(text.find("o body \"2\", plate\nv 2 0 0.1\nv 3 0 0.1\nv 2 1 0.1\nf 7 8 9\n"), std::string::npos) << text;
    EXPECT_TRUE(fs::exists(folder_.path() / "obj" / "frame-00000004.obj"));
}

TEST_F(Export, VtpHasOnePointPerBodyAndACollectionOverTime) {
    io::RunReader run(folder_.path());
    const fs::path folder = folder_.path() / "vtp";
    io::export_vtp(run, folder);
    const std::string text = io::read_text(folder / "frames" / "bodies-00000003.vtp");
    EXPECT_NE(text.find("NumberOfPoints=\"3\" NumberOfVerts=\"3\""), std::string::npos);
    // Body numbers 0, 1, 2 as 64-bit integers after their size, 24 bytes, in base64.
    EXPECT_NE(text.find("Name=\"body\" NumberOfComponents=\"1\" "
                        "format=\"binary\">GAAAAAAAAAAAAAAAAAAAAAEAAAAAAAAAAgAAAAAAAAA=<"),
              std::string::npos)
        << text;
    for (const char* name :
         {"shape", "type", "quaternion", "velocity", "angular_velocity", "speed", "contacts", "cluster", "cost"})
        EXPECT_NE(text.find("Name=\"" + std::string(name) + "\""), std::string::npos) << name;
    EXPECT_NE(
        io::read_text(folder / "bodies.pvd").find("timestep=\"0.12\" part=\"0\" file=\"frames/bodies-00000003.vtp\""),
        std::string::npos);
    EXPECT_NE(io::read_text(folder / "meshes" / "0-plate.vtp").find("NumberOfPolys=\"1\""), std::string::npos);
}

TEST_F(Export, GlbHasOneAnimatedNodePerBody) {
    io::RunReader run(folder_.path());
    const fs::path path = folder_.path() / "run.glb";
    io::export_glb(run, path);
    const auto bytes = io::read_file(path);
    std::uint32_t words[5];
    ASSERT_GT(bytes.size(), sizeof words);
    std::memcpy(words, bytes.data(), sizeof words);
    EXPECT_EQ(words[0], 0x46546c67u);
    EXPECT_EQ(words[1], 2u);
    EXPECT_EQ(words[2], bytes.size());
    const auto* text = reinterpret_cast<const char*>(bytes.data()) + sizeof words;
    const auto json = nlohmann::json::parse(text, text + words[3]);
    EXPECT_EQ(json["nodes"].size(), 4u);
    EXPECT_EQ(json["nodes"][3]["name"], "body \"2\", plate");
    EXPECT_EQ(json["meshes"].size(), 1u);
    EXPECT_EQ(json["animations"][0]["channels"].size(), 6u); // translation and rotation of three bodies
    EXPECT_EQ(json["accessors"][0]["max"], (std::vector<double>{1, 1, 0}));
    EXPECT_EQ(20 + words[3] + 8 + json["buffers"][0]["byteLength"].get<std::size_t>(), bytes.size());
}

} // namespace
} // namespace flotilla
