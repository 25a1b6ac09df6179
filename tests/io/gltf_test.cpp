// SPDX-License-Identifier: MIT
// Reading of glTF, and of the one mesh of a file that a scene names.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <flotilla/error.hpp>

#include "io/base64.hpp"
#include "io/mesh_source.hpp"
#include "io/read_gltf.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla::io {
namespace {

using test::TemporaryFolder;

constexpr const char* kPath = "a.gltf";

template <class T>
std::string bytes(const std::vector<T>& values) {
    const auto raw = std::as_bytes(std::span(values));
    return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}
std::string uri(const std::string& data) {
    return "data:application/octet-stream;base64," + base64(std::as_bytes(std::span(data)));
}

/// A square of two triangles and a fifth vertex that repeats the first, with 16 bit indices.
const std::string kPositions = bytes(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0});
const std::string kIndices = bytes(std::vector<std::uint16_t>{0, 1, 2, 4, 2, 3});

nlohmann::json document() {
    return nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"name": "square", "mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 7}, "indices": 1, "material": 3}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 60, "byteLength": 12}],
      "buffers": [{"byteLength": 72}]})");
}
nlohmann::json with_data() {
    nlohmann::json json = document();
    json["buffers"][0]["uri"] = uri(kPositions + kIndices);
    return json;
}
TriangleMesh read(const nlohmann::json& json, const std::string& node = "") {
    return read_gltf(kPath, json.dump(), node);
}
std::string refusal(const std::string& text, const std::string& node = "") {
    try {
        (void)read_gltf(kPath, text, node);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}
std::string refusal(const nlohmann::json& json, const std::string& node = "") { return refusal(json.dump(), node); }

std::string glb(const std::string& json, const std::string& binary) {
    const auto word = [](std::size_t n) { return bytes(std::vector<std::uint32_t>{static_cast<std::uint32_t>(n)}); };
    const std::string body = word(json.size()) + "JSON" + json + word(binary.size()) + std::string("BIN\0", 4) + binary;
    return "glTF" + word(2) + word(12 + body.size()) + body;
}

const TriangleMesh kSquare{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};

TEST(Gltf, ReadsTrianglesAndMergesEqualVertices) {
    const TriangleMesh m = read(with_data());
    EXPECT_EQ(m.vertices, kSquare.vertices);
    EXPECT_EQ(m.triangles, kSquare.triangles);
}

TEST(Gltf, ReadsBinaryFilesAndBuffersBesideTheFile) {
    std::string json = document().dump();
    json.append((4 - json.size() % 4) % 4, ' ');
    EXPECT_EQ(read_gltf(kPath, glb(json, kPositions + kIndices)).triangles, kSquare.triangles);
    const TemporaryFolder folder;
    (void)folder.write("my data.bin", kPositions + kIndices + "more");
    nlohmann::json outside = document();
    outside["buffers"][0]["uri"] = "my%20data.bin";
    const std::string file = folder.write("a.gltf", outside.dump());
    EXPECT_EQ(read_mesh_source(folder.path(), "a.gltf").vertices, kSquare.vertices);
    (void)folder.write("my data.bin", "short");
    EXPECT_THROW((void)read_mesh_source(folder.path(), "a.gltf"), InputError);
    outside["buffers"][0]["uri"] = "/dev/zero";
    EXPECT_EQ(refusal(outside), "a.gltf: /buffers/0/uri: cannot read /dev/zero: no file of bytes");
}

TEST(Gltf, AppliesTheTransformsOfNodes) {
    nlohmann::json json = with_data();
    json["scenes"][0]["nodes"] = {0, 2};
    json["nodes"] = nlohmann::json::parse(R"([{"translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1]},
      {"name": "turned", "mesh": 0, "rotation": [0, 0, 1, 0]},
      {"name": "by matrix", "mesh": 0, "matrix": [0,1,0,0, -1,0,0,0, 0,0,1,0, 0,0,5,1]}, {"mesh": 0, "name": "of no scene"}])");
    const TriangleMesh m = read(json);
    ASSERT_EQ(m.vertices.size(), 8U);
    EXPECT_EQ(m.vertices[2], (Vec3{8, -2, 0})) << "half a turn about z, doubled, moved by 10";
    EXPECT_EQ(m.vertices[5], (Vec3{0, 1, 5})) << "column by column: x becomes y";
    EXPECT_EQ(m.triangles.size(), 4U);
    EXPECT_EQ(read(json, "by matrix").vertices[1], (Vec3{0, 1, 5})) << "in the coordinates of the scene";
    EXPECT_EQ(refusal(json, "turnd"), "a.gltf: unknown node \"turnd\"; did you mean \"turned\"?");
    EXPECT_EQ(refusal(json, "of no scene").find("a.gltf: unknown node"), 0U);
}

TEST(Gltf, StripsFansAndPrimitivesWithoutIndices) {
    nlohmann::json json = with_data();
    nlohmann::json& primitive = json["meshes"][0]["primitives"][0];
    primitive.erase("indices");
    json["accessors"][0]["count"] = 4;
    primitive["mode"] = 5;
    EXPECT_EQ(read(json).triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
    primitive["mode"] = 6;
    EXPECT_EQ(read(json).triangles, (std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}}));
    const auto segments = [](std::vector<std::array<std::int32_t, 2>> ends) {
        std::vector<Triangle> list;
        for (const auto& [a, b] : ends) list.push_back(segment_element(a, b));
        return list;
    };
    primitive["mode"] = 0;
    EXPECT_EQ(read(json).triangles, (std::vector<Triangle>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}));
    primitive["mode"] = 1;
    EXPECT_EQ(read(json).triangles, segments({{0, 1}, {2, 3}}));
    primitive["mode"] = 2;
    EXPECT_EQ(read(json).triangles, segments({{0, 1}, {1, 2}, {2, 3}, {3, 0}}));
    primitive["mode"] = 3;
    EXPECT_EQ(read(json).triangles, segments({{0, 1}, {1, 2}, {2, 3}}));
    json["accessors"][0]["count"] = 1;
    EXPECT_EQ(refusal(json), "a.gltf: the file has no geometry");
}

TEST(Gltf, IndicesOfEveryWidthAndInterleavedPositions) {
    nlohmann::json json = with_data();
    json["accessors"][1]["componentType"] = 5125;
    json["buffers"][0] = {{"byteLength", 84},
                          {"uri", uri(kPositions + bytes(std::vector<std::uint32_t>{0, 1, 2, 4, 2, 3}))}};
    json["bufferViews"][1]["byteLength"] = 24;
    EXPECT_EQ(read(json).triangles, kSquare.triangles);
    json["accessors"][1]["componentType"] = 5121;
    json["buffers"][0] = {{"byteLength", 66}, {"uri", uri(kPositions + std::string("\0\1\2\4\2\3", 6))}};
    json["bufferViews"][1]["byteLength"] = 6;
    EXPECT_EQ(read(json).triangles, kSquare.triangles);
    std::vector<float> apart;
    for (const Vec3& v : kSquare.vertices)
        for (const double x : {v.x, v.y, v.z, 7.0}) apart.push_back(static_cast<float>(x));
    json = with_data();
    json["accessors"][0]["count"] = 4;
    json["meshes"][0]["primitives"][0].erase("indices");
    json["meshes"][0]["primitives"][0]["mode"] = 6;
    json["buffers"][0] = {{"byteLength", 64}, {"uri", uri(bytes(apart))}};
    json["bufferViews"][0] = {{"buffer", 0}, {"byteLength", 64}, {"byteStride", 16}};
    EXPECT_EQ(read(json).vertices, kSquare.vertices);
}

TEST(Gltf, WhatIsWrongIsRefusedWithItsPlace) {
    const auto changed = [](const char* pointer, const nlohmann::json& value) {
        nlohmann::json json = with_data();
        json[nlohmann::json::json_pointer(pointer)] = value;
        return refusal(json);
    };
    EXPECT_EQ(changed("/asset/version", "1.0"), "a.gltf: /asset/version: must be 2.0, got the string \"1.0\"");
    EXPECT_EQ(changed("/extensionsRequired", {"KHR_draco_mesh_compression"}),
              "a.gltf: /extensionsRequired: \"KHR_draco_mesh_compression\" is not supported");
    EXPECT_EQ(changed("/extensionsRequired", {"KHR_materials_unlit"}), "accepted");
    EXPECT_EQ(changed("/accessors/0/count", 1e18),
              "a.gltf: /accessors/0/count: must be a whole number from 0, got 1e+18");
    EXPECT_EQ(changed("/accessors/0/count", 6), "a.gltf: /accessors/0: ends at byte 72 of a view of 60");
    EXPECT_EQ(changed("/accessors/0/count", 1U << 30),
              "a.gltf: /accessors/0: ends at byte 12884901888 of a view of 60");
    EXPECT_EQ(changed("/accessors/0/sparse", nlohmann::json::object()),
              "a.gltf: /accessors/0/sparse: is not supported");
    EXPECT_EQ(changed("/accessors/0/componentType", 5123), "a.gltf: /accessors/0/componentType: must be 5126, floats");
    EXPECT_EQ(changed("/accessors/0/type", "VEC4"), "a.gltf: /accessors/0/type: must be VEC3");
    EXPECT_EQ(changed("/bufferViews/0/byteStride", 8), "a.gltf: /accessors/0: its elements of 12 bytes overlap");
    EXPECT_EQ(changed("/bufferViews/1/byteOffset", 61), "a.gltf: /bufferViews/1: ends at byte 73 of a buffer of 72");
    EXPECT_EQ(changed("/buffers/0/byteLength", 90), "a.gltf: /buffers/0/byteLength: says 90 bytes, there are 72");
    EXPECT_EQ(changed("/buffers/0/uri", "data:;base64,AB*A"), "a.gltf: /buffers/0/uri: malformed base64");
    EXPECT_EQ(changed("/buffers/0/uri", "http://host/a.bin"),
              "a.gltf: /buffers/0/uri: must be a data URI in base64, or a file");
    EXPECT_EQ(changed("/nodes/0/mesh", 3), "a.gltf: /nodes/0/mesh: names /meshes/3, there are 1");
    EXPECT_EQ(changed("/nodes/0/children", {0}), "a.gltf: /nodes/0: hangs on more than one node, or on itself");
    EXPECT_EQ(changed("/nodes/0/rotation", {0, 0, 2, 0}),
              "a.gltf: /nodes/0/rotation: must be a unit quaternion [x, y, z, w]");
    EXPECT_EQ(changed("/nodes/0/scale", {1, 2}), "a.gltf: /nodes/0/scale: must be an array of 3 numbers");
    EXPECT_EQ(changed("/nodes/0/scale", {1e300, 1e300, 1}).find("accepted"), 0U);
    nlohmann::json far = with_data();
    far["nodes"][0]["scale"] = {1e308, 1e308, 1e308};
    far["nodes"].push_back({{"scale", {1e10, 1e10, 1e10}}, {"children", {0}}});
    far["scenes"][0]["nodes"] = {1};
    EXPECT_EQ(refusal(far), "a.gltf: /meshes/0/primitives/0: a coordinate is not finite");
    nlohmann::json index = with_data();
    index["accessors"][0]["count"] = 4;
    EXPECT_EQ(refusal(index), "a.gltf: /meshes/0/primitives/0/indices: index 4 is out of range, there are 4 vertices");
    EXPECT_EQ(refusal(std::string("{")).find("a.gltf: line 1, column 2: "), 0U);
    EXPECT_EQ(refusal(std::string("glTF\2\0\0\0\x20\0\0\0", 12)), "a.gltf: the file says 32 bytes, it has 12");
}

// Nodes that show one large mesh again and again.
TEST(Gltf, MeshesBeyondAllMemoryAreRefusedBeforeTheyAreMade) {
    const std::size_t count = 1U << 21;
    nlohmann::json json = document();
    json["buffers"][0] = {{"byteLength", 12 * count}, {"uri", "zeros.bin"}};
    json["bufferViews"][0]["byteLength"] = 12 * count;
    json["accessors"][0]["count"] = count;
    json["meshes"][0]["primitives"][0].erase("indices");
    json["nodes"] = nlohmann::json::array();
    json["scenes"][0]["nodes"] = nlohmann::json::array();
    for (int i = 0; i < 40; ++i) json["nodes"].push_back({{"mesh", 0}}), json["scenes"][0]["nodes"].push_back(i);
    const TemporaryFolder folder;
    (void)folder.write("a.gltf", json.dump());
    std::ofstream(folder.path() / "zeros.bin") << "";
    std::filesystem::resize_file(folder.path() / "zeros.bin", 12 * count);
    try {
        (void)read_mesh_source(folder.path(), "a.gltf");
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what())
                      .find("a.gltf: /nodes/32/mesh: the mesh has more than 67108864 vertices or corners of triangles"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Gltf, ReadsWhatWasExported) {
    nlohmann::json json = with_data(); // a node above that turns z up into y up, as in files of ours
    json["nodes"] = nlohmann::json::parse(
        R"([{"rotation": [-0.7071067811865476, 0, 0, 0.7071067811865476], "children": [1]}, {"mesh": 0}])");
    const Vec3 v = read(json).vertices[3];
    EXPECT_NEAR(v.z, -1, 1e-15);
    EXPECT_NEAR(v.y, 0, 1e-15);
}

TEST(MeshSource, PartsOfFiles) {
    const TemporaryFolder folder;
    (void)folder.write("car.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no body shell\nf 1 2 3\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 6 1 "
                                  "0\no wheels\ng left all\nf 4 5 6\n"
                                  "g right all\nusemtl x\nf 5 7 6\n");
    const auto read = [&](const std::string& source) { return read_mesh_source(folder.path(), source); };
    EXPECT_EQ(read("car.obj").triangles.size(), 3U);
    EXPECT_EQ(read("car.obj#body shell").triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(read("car.obj#wheels").triangles.size(), 2U);
    EXPECT_EQ(read("car.obj#all").triangles.size(), 2U);
    EXPECT_EQ(read("car.obj#right").triangles, (std::vector<Triangle>{{0, 2, 1}})) << "without what others use";
    EXPECT_EQ(read("car.obj#right").vertices[0], (Vec3{6, 0, 0}));
    const auto refused = [&](const std::string& source) {
        try {
            (void)read(source);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_NE(refused("car.obj#whels").find("car.obj:15: unknown object or group \"whels\"; did you mean \"wheels\"?"),
              std::string::npos)
        << refused("car.obj#whels");
    (void)folder.write("none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\ng empty\ng full\nf 1 2 3\n");
    EXPECT_NE(refused("none.obj#empty").find("none.obj:6: \"empty\" has no faces"), std::string::npos)
        << refused("none.obj#empty");
    (void)folder.write("heap#3.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(read("heap#3.obj").triangles.size(), 1U) << "the # is the name's";
    (void)folder.write("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                                "0\nendloop\nendfacet\nendsolid\n");
    EXPECT_NE(refused("a.stl#x").find("has no objects"), std::string::npos) << refused("a.stl#x");
}

} // namespace
} // namespace flotilla::io
