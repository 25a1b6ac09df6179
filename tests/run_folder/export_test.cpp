// SPDX-License-Identifier: MIT
#include "run_folder/export.hpp"

#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "run_folder/sample_run.hpp"
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
    io::export_obj(run, io::frames_of(run, {}), folder_.path() / "obj");
    const std::string text = io::read_text(folder_.path() / "obj" / "frame-00000000.obj");
    EXPECT_NE(text.find("o body \"2\", plate\nv 2 0 0.1\nv 3 0 0.1\nv 2 1 0.1\nf 7 8 9\n"), std::string::npos) << text;
    EXPECT_TRUE(fs::exists(folder_.path() / "obj" / "frame-00000004.obj"));
}

TEST_F(Export, VtpHasOnePointPerBodyAndACollectionOverTime) {
    io::RunReader run(folder_.path());
    const fs::path folder = folder_.path() / "vtp";
    io::export_vtp(run, io::frames_of(run, {}), folder);
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
    io::export_glb(run, io::frames_of(run, {}), path);
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
    EXPECT_EQ(json["meshes"].size(), json["materials"].size()) << "one shape in some colours";
    EXPECT_EQ(json["animations"][0]["channels"].size(), 6u); // translation and rotation of three bodies
    EXPECT_EQ(json["accessors"][0]["max"], (std::vector<double>{1, 1, 0}));
    EXPECT_EQ(20 + words[3] + 8 + json["buffers"][0]["byteLength"].get<std::size_t>(), bytes.size());
}

/// The JSON chunk of the exported file.
std::string glb_json(io::RunReader& run, const FrameRange& range) {
    const test::TemporaryFolder folder;
    io::export_glb(run, io::frames_of(run, range), folder.path() / "run.glb");
    const auto bytes = io::read_file(folder.path() / "run.glb");
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    return {reinterpret_cast<const char*>(bytes.data()) + 20, length};
}

TEST(ExportGlb, HasAMaterialForEveryColour) {
    test::TemporaryFolder folder;
    io::RunScene scene = sample_scene(40);
    scene.bodies[7].type = scene.bodies[8].type = BodyType::fixed;
    io::RunWriter writer(folder.path(), sample_info(), scene, io::OpenRun::create);
    write_sample(writer, 40, 0, 1, true);
    writer.close("complete");
    io::RunReader run(folder.path());
    const auto json = nlohmann::json::parse(glb_json(run, {}));
    std::set<std::vector<double>> colours;
    for (const auto& material : json["materials"])
        colours.insert(material["pbrMetallicRoughness"]["baseColorFactor"].get<std::vector<double>>());
    EXPECT_EQ(colours.size(), json["materials"].size()) << "no colour twice";
    EXPECT_GT(colours.size(), 8U);
    EXPECT_LE(colours.size(), 13U);
    const auto material_of = [&](std::size_t body) {
        return json["meshes"][json["nodes"][body + 1]["mesh"].get<std::size_t>()]["primitives"][0]["material"];
    };
    EXPECT_EQ(material_of(7), material_of(8)) << "the grey of what is fixed";
    EXPECT_NE(material_of(7), material_of(6));
    EXPECT_NE(material_of(0), material_of(1));
    for (const auto& mesh : json["meshes"])
        EXPECT_EQ(mesh["primitives"][0]["indices"], json["meshes"][0]["primitives"][0]["indices"])
            << "arrays are shared";
}

TEST(ExportElements, SegmentsAndPointsAreThoseOfEachFormat) {
    const test::TemporaryFolder folder;
    io::RunScene scene = sample_scene(2);
    scene.shapes[0].mesh.vertices.push_back({0, 0, 2});
    scene.shapes[0].mesh.triangles = {segment_element(0, 3), {0, 1, 2}, point_element(3), segment_element(3, 1)};
    io::RunWriter writer(folder.path(), sample_info(), scene, io::OpenRun::create);
    write_sample(writer, 2, 0, 1);
    writer.close("complete");
    io::RunReader run(folder.path());
    const FrameRange all = io::frames_of(run, {});

    io::export_obj(run, all, folder.path() / "obj");
    const std::string obj = io::read_text(folder.path() / "obj" / "frame-00000000.obj");
    EXPECT_NE(obj.find("l 5 8\nf 5 6 7\np 8\nl 8 6\n"), std::string::npos) << obj;

    io::export_vtp(run, all, folder.path() / "vtp");
    const std::string vtp = io::read_text(folder.path() / "vtp" / "meshes" / "0-plate.vtp");
    EXPECT_NE(vtp.find("NumberOfVerts=\"1\" NumberOfLines=\"2\" NumberOfStrips=\"0\" NumberOfPolys=\"1\""),
              std::string::npos);
    EXPECT_NE(vtp.find("<Lines>"), std::string::npos);

    const auto json = nlohmann::json::parse(glb_json(run, {}));
    const auto& primitives = json["meshes"][0]["primitives"];
    ASSERT_EQ(primitives.size(), 3U);
    EXPECT_FALSE(primitives[0].contains("mode")) << "triangles";
    EXPECT_EQ(primitives[1]["mode"], 1);
    EXPECT_EQ(primitives[2]["mode"], 0);
    const auto count = [&](std::size_t k) {
        return json["accessors"][primitives[k]["indices"].get<std::size_t>()]["count"];
    };
    EXPECT_EQ(count(0), 3);
    EXPECT_EQ(count(1), 4);
    EXPECT_EQ(count(2), 1);

    io::export_usd(run, all, folder.path() / "run.usda");
    const std::string usd = io::read_text(folder.path() / "run.usda");
    const std::size_t faces = usd.find("faceVertexIndices = [0,1,2,");
    ASSERT_NE(faces, std::string::npos) << "tubes after the triangle";
    const std::string corners = usd.substr(faces, usd.find(']', faces) - faces) + ",";
    for (const char* thin : {",0,3,3,", ",3,3,3,", ",3,1,1,"})
        EXPECT_EQ(corners.find(thin), std::string::npos) << "no faces without an area";
}

TEST_F(Export, FramesOfARangeKeepTheirNumbers) {
    io::RunReader run(folder_.path()); // frames 0 to 4
    const auto frames = [&](FrameRange range) {
        const FrameRange r = io::frames_of(run, range);
        return std::vector<std::int64_t>{r.first, r.last, r.every, io::count(r)};
    };
    EXPECT_EQ(frames({}), (std::vector<std::int64_t>{0, 4, 1, 5}));
    EXPECT_EQ(frames({1, 100, 2}), (std::vector<std::int64_t>{1, 3, 2, 2}));
    EXPECT_EQ(frames({4, 4, 1}), (std::vector<std::int64_t>{4, 4, 1, 1}));
    for (const FrameRange none : {FrameRange{5, 9, 1}, FrameRange{3, 2, 1}, FrameRange{0, 4, 0}, FrameRange{-1, 4, 1}})
        EXPECT_THROW((void)io::frames_of(run, none), InputError);
    const FrameRange odd = io::frames_of(run, {1, 3, 2});
    io::export_obj(run, odd, folder_.path() / "obj");
    for (const int k : {0, 1, 2, 3, 4})
        EXPECT_EQ(fs::exists(folder_.path() / "obj" / ("frame-0000000" + std::to_string(k) + ".obj")), k % 2 == 1) << k;
    std::string csv;
    io::export_csv(run, odd, [&](std::string_view text) { csv += text; });
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 3);
    EXPECT_NE(csv.find("\n3,0.12,2,"), std::string::npos) << csv;
    io::export_usd(run, odd, folder_.path() / "run.usda");
    const std::string usd = io::read_text(folder_.path() / "run.usda");
    EXPECT_NE(usd.find("startTimeCode = 1\n    endTimeCode = 3\n"), std::string::npos);
    EXPECT_EQ(usd.find("            2: ["), std::string::npos);
    io::export_vtp(run, odd, folder_.path() / "vtp");
    EXPECT_EQ(io::read_text(folder_.path() / "vtp" / "bodies.pvd").find("bodies-00000002.vtp"), std::string::npos);
    const std::string whole = glb_json(run, {}), part = glb_json(run, odd);
    EXPECT_NE(whole.find("\"count\":5,"), std::string::npos);
    EXPECT_EQ(part.find("\"count\":5,"), std::string::npos);
    EXPECT_NE(part.find("\"count\":2,"), std::string::npos) << "times of two frames";
}

/// Fails on text that is not balanced outside of its strings.
void expect_balanced(const std::string& text) {
    std::string open;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::size_t bracket = std::string("([{").find(text[i]);
        if (text[i] == '"') {
            for (++i; i < text.size() && text[i] != '"'; ++i)
                if (text[i] == '\\') ++i;
        } else if (bracket != std::string::npos) {
            open += ")]}"[bracket];
        } else if (std::string(")]}").find(text[i]) != std::string::npos) {
            ASSERT_FALSE(open.empty()) << "at " << i;
            ASSERT_EQ(open.back(), text[i]) << "at " << i;
            open.pop_back();
        }
    }
    EXPECT_EQ(open, "");
}

/// All numbers of the list that follows `name`, brackets left out.
std::vector<double> numbers_after(const std::string& text, const std::string& name) {
    std::vector<double> numbers;
    const std::size_t begin = text.find('[', text.find(name) + name.size()), end = text.find(']', begin);
    std::string list = text.substr(begin + 1, end - begin - 1);
    for (char& c : list)
        if (c == '(' || c == ')' || c == ',') c = ' ';
    std::istringstream in(list);
    for (double value = 0; in >> value;) numbers.push_back(value);
    return numbers;
}

TEST_F(Export, UsdHasAnInstancerWithSamplesOfEveryFrame) {
    io::RunReader run(folder_.path());
    const fs::path path = folder_.path() / "run.usda";
    io::export_usd(run, io::frames_of(run, {}), path);
    const std::string text = io::read_text(path);
    EXPECT_TRUE(text.starts_with("#usda 1.0\n("));
    expect_balanced(text);
    for (const char* line :
         {"defaultPrim = \"run\"", "upAxis = \"Z\"", "metersPerUnit = 1\n", "endTimeCode = 4\n",
          "timeCodesPerSecond = 25\n", "def PointInstancer \"bodies\"",
          "rel prototypes = [</run/bodies/prototypes/shape_0_plate>]\n", "def Mesh \"shape_0_plate\"",
          "int64[] ids = [0,1,2]\n", "int[] protoIndices = [0,0,0]\n",
          "string[] primvars:name = [\"body \\\"0\\\", plate\",", "uniform token subdivisionScheme = \"none\""})
        EXPECT_NE(text.find(line), std::string::npos) << line;
    EXPECT_EQ(numbers_after(text, "int[] faceVertexCounts ="), (std::vector<double>{3}));
    EXPECT_EQ(numbers_after(text, "int[] faceVertexIndices ="), (std::vector<double>{0, 1, 2}));
    EXPECT_EQ(numbers_after(text, "point3f[] points ="), (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    for (const char* attribute : {"point3f[] positions", "quath[] orientations", "quatf[] orientationsf",
                                  "vector3f[] velocities", "vector3f[] angularVelocities"}) {
        const std::size_t begin = text.find(std::string(attribute) + ".timeSamples = {\n");
        ASSERT_NE(begin, std::string::npos) << attribute;
        const std::string samples = text.substr(begin, text.find('}', begin) - begin);
        EXPECT_EQ(std::count(samples.begin(), samples.end(), ':'), 5) << attribute;
        const SampleFrame frame(3, 2);
        const auto values = numbers_after(samples, "\n            2:");
        if (samples.starts_with("point3f")) {
            EXPECT_EQ(values, (std::vector<double>{0, 2, 0.1, 1, 2, 0.1, 2, 2, 0.1}));
        }
        if (samples.starts_with("quat")) {
            ASSERT_EQ(values.size(), 12u);
            EXPECT_NEAR(values[8], frame.rotation[2].w, 1e-7);
            EXPECT_NEAR(values[11], frame.rotation[2].z, 1e-7);
        }
        if (samples.find("angularVelocities") != std::string::npos) {
            EXPECT_NEAR(values[2], 0.01 * 180 / 3.14159265, 1e-6);
        }
    }
}

} // namespace
} // namespace flotilla
