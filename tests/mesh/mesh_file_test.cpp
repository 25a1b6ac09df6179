// SPDX-License-Identifier: MIT
#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <locale>
#include <map>
#include <random>

#include <flotilla/error.hpp>
#include <gtest/gtest.h>

#include "geometry/box.hpp"
#include "mesh/mass_properties.hpp"
#include "mesh/primitives.hpp"
#include "mesh/text_input.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test.
class MeshFile : public ::testing::Test {
  public:
    MeshFile() {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(::testing::TempDir()) / (std::string("flotilla_mesh_file_") + info->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~MeshFile() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

  protected:
    fs::path write(const std::string& name, const std::string& content) const {
        fs::path path = folder_ / name;
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }
    TriangleMesh read(const std::string& name, const std::string& content) const {
        return read_mesh(write(name, content));
    }

    /// The message of the InputError without the folder; "(no error)" where there is none.
    std::string error(const std::string& name, const std::string& content) const {
        const fs::path path = write(name, content);
        try {
            (void)read_mesh(path);
        } catch (const InputError& e) {
            const std::string text = e.what(), prefix = folder_.string() + "/";
            return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
        }
        return "(no error)";
    }

    fs::path folder_;
};

const TriangleMesh kQuad{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};

/// With the shortest texts that read back as the same doubles.
std::string obj_text(const TriangleMesh& mesh) {
    std::string text;
    for (const Vec3& v : mesh.vertices) {
        text += 'v';
        for (const double x : {v.x, v.y, v.z}) {
            char number[32];
            (text += ' ').append(number, std::to_chars(number, number + sizeof number, x).ptr);
        }
        text += '\n';
    }
    for (const Triangle& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            text += (k == 0 ? "f " : " ") + std::to_string(t[k] + 1) + (k == 2 ? "\n" : "");
    return text;
}

/// Whether every coordinate is finite, every index is in range and there is a triangle.
bool is_valid(const TriangleMesh& mesh) {
    const auto count = static_cast<std::int64_t>(mesh.vertices.size());
    return !mesh.triangles.empty() &&
           std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& v) { return is_finite(v); }) &&
           std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
               return std::all_of(t.begin(), t.end(), [&](std::int32_t v) { return v >= 0 && v < count; });
           });
}

void expect_equal(const TriangleMesh& a, const TriangleMesh& b) {
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
}

// ---- values in binary files

template <class T>
std::string bytes(T value, std::endian order = std::endian::little) {
    std::string s(sizeof(T), '\0');
    const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    std::copy(raw.begin(), raw.end(), s.begin());
    if (order != std::endian::native) std::reverse(s.begin(), s.end());
    return s;
}

std::string binary_stl(const std::vector<float>& coordinates, std::uint32_t count,
                       const std::string& title = "binary") {
    std::string s = title + std::string(80 - title.size(), ' ') + bytes(count);
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
        if (i % 9 == 0) s += std::string(12, '\0');
        s += bytes(coordinates[i]);
        if (i % 9 == 8) s += std::string(2, '\0');
    }
    return s;
}

std::string binary_ply(std::endian order, int vertices = 4, int faces = 1) {
    std::string s = "ply\nformat ";
    s += order == std::endian::little ? "binary_little_endian" : "binary_big_endian";
    s += " 1.0\ncomment made for a test\nelement vertex " + std::to_string(vertices) +
         "\nproperty double x\nproperty float y\nproperty short z\nproperty uchar red\nelement face " +
         std::to_string(faces) + "\nproperty float quality\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& v : kQuad.vertices)
        s += bytes(v.x, order) + bytes(static_cast<float>(v.y), order) + bytes(static_cast<std::int16_t>(v.z), order) +
             '\xff';
    s += bytes(1.5f, order) + '\x04';
    for (std::int32_t i : {0, 1, 2, 3}) s += bytes(i, order);
    return s;
}

const std::string kAsciiPlyHeader =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kAsciiPlyVertices = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

const std::string kAsciiStl =
    "solid two triangles\n"
    " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n"
    "  endloop\n endfacet\n"
    " facet normal nan nan nan\n  outer loop\n   vertex 0 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n"
    "  endloop\n endfacet\n"
    "endsolid two triangles\n";

// ---- good files

TEST_F(MeshFile, ReadsObjWithAllItsWaysOfNamingCorners) {
    expect_equal(read("a.obj", "# quad\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), kQuad);
    expect_equal(read("b.OBJ",
                      "mtllib m.mtl\no quad\ng a b\nv 0 0 0 1.0\nv 1. +0 -0\nv 1e0 1 0 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\n"
                      "v 0 .1e1 0 1 0 0 0\nusemtl x\ns off\nf 1/1/1 2/1/1 3/1/1\nf 1//1 3//1 4//1 # end"),
                 kQuad);
    expect_equal(read("c.obj", "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\n\r\nf -4 -3 -2\r\nf -4/1 -2/1 -1/1\r\n"),
                 kQuad);
    expect_equal(read("d.obj", "\tf 1 2 3 4\n  v 0 0 0\nv\t1 0 0\nv 1 1 0 \nv 0 1 0"), kQuad);
}

TEST_F(MeshFile, ReadsNumbersExactly) {
    const TriangleMesh m =
        read("a.obj",
             "v 0.1 -1.7976931348623157e308 4.9406564584124654e-324\nv 1e-400 -1e-400 123456789012345678901234567890\n"
             "v 0.333333333333333314829616256247390992939472198486328125 1E5 1e+5\nf 1 2 3\n");
    EXPECT_EQ(m.vertices[0],
              (Vec3{0.1, -std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()}));
    EXPECT_EQ(m.vertices[1], (Vec3{0, 0, 123456789012345678901234567890.0}));
    EXPECT_EQ(m.vertices[2], (Vec3{1.0 / 3, 1e5, 1e5}));
}

TEST_F(MeshFile, ReadsAsciiStlAndMergesItsVertices) {
    expect_equal(read("a.stl", kAsciiStl), kQuad);
    std::string shouting = kAsciiStl;
    std::transform(shouting.begin(), shouting.end(), shouting.begin(),
                   [](char c) { return static_cast<char>(std::toupper(c)); });
    expect_equal(read("b.stl", "\n" + shouting + "SOLID\nENDSOLID\n"), kQuad);
    std::string one_line = kAsciiStl.substr(kAsciiStl.find('\n') + 1);
    std::replace(one_line.begin(), one_line.end(), '\n', ' ');
    expect_equal(read("c.stl", "solid\n" + one_line), kQuad);
}

TEST_F(MeshFile, ReadsBinaryStlWhateverItsTitle) {
    const std::vector<float> quad{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0};
    expect_equal(read("a.stl", binary_stl(quad, 2)), kQuad);
    expect_equal(read("b.stl", binary_stl(quad, 2, "solid but binary")), kQuad);
}

TEST_F(MeshFile, ReadsPlyInEveryFormat) {
    expect_equal(read("ascii.ply", kAsciiPlyHeader + kAsciiPlyVertices + "4 0 1 2 3\n\n"), kQuad);
    expect_equal(read("little.ply", binary_ply(std::endian::little)), kQuad);
    expect_equal(read("big.ply", binary_ply(std::endian::big)), kQuad);
    expect_equal(read("order.ply",
                      "ply\r\nformat ascii 1.0\r\nobj_info x\r\nelement face 2\r\nproperty uchar flags\r\n"
                      "property list int uint vertex_index\r\nproperty list uchar float texcoord\r\n"
                      "element edge 1\r\nproperty int a\r\nelement vertex 4\r\nproperty double z\r\n"
                      "property double nx\r\nproperty double y\r\nproperty double x\r\nend_header\r\n"
                      "7 3 0 1 2 2 0.5 0.5\r\n7 3 0 2 3 0\r\n9\r\n0 9 0 0\r\n0 9 0 1\r\n0 nan 1 1\r\n0 9 1 0\r\n"),
                 kQuad);
}

TEST_F(MeshFile, AcceptsDegenerateAndNonManifoldGeometry) {
    const TriangleMesh m = read("a.obj", "v 0 0 0\nv 0 0 0\nv 1 0 0\nf 1 1 1\nf 1 2 3\nf 1 2 3\nf 3 2 1\nf 1 3 3\n");
    EXPECT_EQ(m.vertices.size(), 3u);
    EXPECT_EQ(m.triangles.size(), 5u);
}

TEST_F(MeshFile, ReadsTheShortestTextsOfDoublesBitForBit) {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> n;
    TriangleMesh m = make_sphere(1, 2);
    for (Vec3& v : m.vertices) v = {v.x * std::exp(20 * n(rng)), v.y + n(rng), -v.z / 3};
    m.vertices[0] = {-0.0, 5e-324, 1.7976931348623157e308};
    const TriangleMesh back = read("out.obj", obj_text(m));
    expect_equal(back, m);
    EXPECT_TRUE(std::signbit(back.vertices[0].x));
}

TEST_F(MeshFile, ReadsTheSameInALocaleWithDecimalCommas) {
    struct Commas : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
        char do_thousands_sep() const override { return '.'; }
        std::string do_grouping() const override { return "\3"; }
    };
    const std::locale old = std::locale::global(std::locale(std::locale::classic(), new Commas));
    const std::string c_old = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) // installed or not
        if (std::setlocale(LC_ALL, name) != nullptr) break;
    TriangleMesh m{{{0.5, 1.25, 0}, {1000000.25, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const TriangleMesh back = read("a.obj", obj_text(m));
    std::setlocale(LC_ALL, c_old.c_str());
    std::locale::global(old);
    expect_equal(back, m);
}

TEST_F(MeshFile, LinesAndPointsOfObjAreElements) {
    const TriangleMesh m = read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 3 -3\nl 1/7 2 3\nf 1 2 3\n");
    EXPECT_EQ(m.triangles,
              (std::vector<Triangle>{
                  point_element(2), point_element(0), segment_element(0, 1), segment_element(1, 2), {0, 1, 2}}));
}

// ---- bad files: the whole message

TEST_F(MeshFile, RefusesBadObj) {
    const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(error("a.obj", ""), "a.obj:1: the file has no faces, lines or points");
    EXPECT_EQ(error("a.obj", triangle), "a.obj:3: the file has no faces, lines or points");
    EXPECT_EQ(error("a.obj", triangle + "l 1\n"), "a.obj:4: a line needs at least 2 ends");
    EXPECT_EQ(error("a.obj", triangle + "l 1 1\n"), "a.obj:4: a line from a vertex to itself");
    EXPECT_EQ(error("a.obj", triangle + "p\n"), "a.obj:4: needs at least 1 vertex");
    EXPECT_EQ(error("a.obj", triangle + "p 4\n"), "a.obj:4: index 4 is out of range, there are 3 vertices");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2\n"), "a.obj:4: a face needs at least 3 corners");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 4\n"), "a.obj:4: index 4 is out of range, there are 3 vertices");
    EXPECT_EQ(error("a.obj", "f 1 2 4\n" + triangle), "a.obj:1: index 4 is out of range, there are 3 vertices");
    EXPECT_EQ(error("a.obj", triangle + "f 0 1 2\n"), "a.obj:4: index 0 is out of range, indices count from 1");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 -4\n"), "a.obj:4: index -4 is out of range, there are 3 vertices");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 99999999999\n"),
              "a.obj:4: index 99999999999 is out of range, there are 3 vertices");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 99999999999999999999\n"),
              "a.obj:4: malformed integer '99999999999999999999'");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 x\n"), "a.obj:4: malformed integer 'x'");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 3.0\n"), "a.obj:4: malformed integer '3.0'");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 3/x\n"), "a.obj:4: malformed corner '3/x'");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 3/\n"), "a.obj:4: malformed corner '3/'");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 3/1/1/1\n"), "a.obj:4: malformed corner '3/1/1/1'");
    EXPECT_EQ(error("a.obj", triangle + "f 1 2 /3\n"), "a.obj:4: an integer is missing");
    EXPECT_EQ(error("a.obj", triangle + "face 1 2 3\n"), "a.obj:4: unknown statement 'face'");
    EXPECT_EQ(error("a.obj", "v 0 0\n"), "a.obj:1: a number is missing");
    EXPECT_EQ(error("a.obj", "v 0 0 0 1 1\n"), "a.obj:1: a vertex has 3 coordinates, this one 5");
    EXPECT_EQ(error("a.obj", "v 0 0 1.0.0\n"), "a.obj:1: malformed number '1.0.0'");
    EXPECT_EQ(error("a.obj", "v 0 0 0,5\n"), "a.obj:1: malformed number '0,5'");
    EXPECT_EQ(error("a.obj", "v 0 0 +-1\n"), "a.obj:1: malformed number '+-1'");
    EXPECT_EQ(error("a.obj", "v 0 0 0x10\n"), "a.obj:1: malformed number '0x10'");
    EXPECT_EQ(error("a.obj", "v 0 0 1e400\n"), "a.obj:1: malformed number '1e400'");
    EXPECT_EQ(error("a.obj", "\n\nv 0 nan 0\n"), "a.obj:3: coordinate 'nan' is not finite");
    EXPECT_EQ(error("a.obj", "v -inf 0 0\n"), "a.obj:1: coordinate '-inf' is not finite");
    EXPECT_EQ(error("a.off", triangle), "a.off:1: unknown mesh format '.off', known are .obj, .stl and .ply");
}

TEST_F(MeshFile, RefusesBadStl) {
    const auto cut = [](const std::string& from) { return kAsciiStl.substr(0, kAsciiStl.find(from)); };
    const auto with = [](const std::string& from, const std::string& to) {
        std::string s = kAsciiStl;
        return s.replace(s.find(from), from.size(), to);
    };
    EXPECT_EQ(error("a.stl", "solid x\nendsolid x\n"), "a.stl:2: the file has no facets");
    EXPECT_EQ(error("a.stl", cut("endsolid")), "a.stl:15: the file ends early, 'endsolid' is missing");
    EXPECT_EQ(error("a.stl", cut("  endloop")), "a.stl:6: the file ends early, 'endloop' is missing");
    EXPECT_EQ(error("a.stl", cut(" 1 1 0\n")), "a.stl:6: a number is missing");
    EXPECT_EQ(error("a.stl", with("vertex 1 0 0", "vertex 1 0 x")), "a.stl:5: malformed number 'x'");
    EXPECT_EQ(error("a.stl", with("vertex 1 0 0", "vertex 1 0 inf")), "a.stl:5: coordinate 'inf' is not finite");
    EXPECT_EQ(error("a.stl", with("vertex 1 0 0", "vertex 1 0")), "a.stl:6: malformed number 'vertex'");
    EXPECT_EQ(error("a.stl", with("outer loop", "outer hoop")), "a.stl:3: expected 'loop', found 'hoop'");
    EXPECT_EQ(error("a.stl", with(" facet", " face")), "a.stl:2: expected 'facet' or 'endsolid', found 'face'");
    EXPECT_EQ(error("a.stl", kAsciiStl + "rest"), "a.stl:17: expected 'solid', found 'rest'");
    EXPECT_EQ(error("a.stl", ""), "a.stl:byte 0: the file ends early");
    EXPECT_EQ(error("a.stl", binary_stl({}, 0)), "a.stl:byte 80: the file has no facets");
    const std::string good = binary_stl({0, 0, 0, 1, 0, 0, 1, 1, 0}, 1);
    EXPECT_EQ(error("a.stl", good.substr(0, 82)), "a.stl:byte 80: the file ends early");
    EXPECT_EQ(error("a.stl", good.substr(0, good.size() - 1)),
              "a.stl:byte 80: the file says 1 facets, which take 50 bytes, but 49 follow");
    EXPECT_EQ(error("a.stl", good + "x"), "a.stl:byte 80: the file says 1 facets, which take 50 bytes, but 51 follow");
    EXPECT_EQ(error("a.stl", binary_stl({0, 0, 0, 1, 0, 0, 1, 1, 0}, 4000000000u)),
              "a.stl:byte 80: the file says 4000000000 facets, which take 200000000000 bytes, but 50 follow");
    EXPECT_EQ(error("a.stl", binary_stl({0, 0, 0, 1, std::numeric_limits<float>::quiet_NaN(), 0, 1, 1, 0}, 1)),
              "a.stl:byte 112: a coordinate is not finite");
}

TEST_F(MeshFile, RefusesBadPly) {
    const std::string good = kAsciiPlyHeader + kAsciiPlyVertices + "4 0 1 2 3\n";
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string s = good;
        return s.replace(s.find(from), from.size(), to);
    };
    EXPECT_EQ(error("a.ply", good), "(no error)");
    EXPECT_EQ(error("a.ply", ""), "a.ply:1: not a PLY file: the first line must be 'ply'");
    EXPECT_EQ(error("a.ply", "ply\nformat ascii 1.0\n"), "a.ply:2: the file ends early, 'end_header' is missing");
    EXPECT_EQ(error("a.ply", with("ascii 1.0", "ascii 2.0")), "a.ply:2: unknown format version, only 1.0 is known");
    EXPECT_EQ(error("a.ply", with("ascii", "middle_endian")), "a.ply:2: unknown format 'middle_endian'");
    EXPECT_EQ(error("a.ply", with("format ascii 1.0\n", "")), "a.ply:8: the header has no format");
    EXPECT_EQ(error("a.ply", with("float y", "float128 y")), "a.ply:5: unknown property type 'float128'");
    EXPECT_EQ(error("a.ply", with("float y", "float v")),
              "a.ply:3: a vertex needs the properties x, y and z, each once");
    EXPECT_EQ(error("a.ply", with("vertex_indices", "corners")),
              "a.ply:7: a face needs one list property vertex_indices");
    EXPECT_EQ(error("a.ply", with("uchar int", "float int")), "a.ply:8: the count of a list must be an integer type");
    EXPECT_EQ(error("a.ply", with("uchar int", "uchar float")), "a.ply:8: vertex indices must be of an integer type");
    EXPECT_EQ(error("a.ply", with("element face 1", "element fake 1")), "a.ply:9: the header has no element 'face'");
    EXPECT_EQ(error("a.ply", with("element face", "element x 99\nelement face")),
              "a.ply:7: element 'x' has no properties");
    EXPECT_EQ(error("a.ply", with("element vertex 4", "element vertex -4")),
              "a.ply:3: element count -4 is out of range");
    EXPECT_EQ(error("a.ply", with("element vertex 4", "elements vertex 4")), "a.ply:3: unknown header line 'elements'");
    EXPECT_EQ(error("a.ply", with("element vertex 4\n", "")), "a.ply:3: a property must follow an element");
    EXPECT_EQ(error("a.ply", with("element vertex 4", "element vertex")), "a.ply:3: an integer is missing");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3", "4 0 1 2 4")),
              "a.ply:14: index 4 is out of range, there are 4 vertices");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3", "4 0 1 2 -1")), "a.ply:14: index -1 is out of range");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3", "2 0 1")), "a.ply:14: a face needs at least 3 corners");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3", "-1 0 1")), "a.ply:14: a list has a negative length");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3", "4 0 1 2")), "a.ply:14: an integer is missing");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3", "4 0 1 2 3 0")), "a.ply:14: unexpected '0' at the end of the line");
    EXPECT_EQ(error("a.ply", with("4 0 1 2 3\n", "")), "a.ply:13: the file ends early");
    EXPECT_EQ(error("a.ply", with("1 1 0\n", "1 inf 0\n")), "a.ply:12: a coordinate is not finite");
    EXPECT_EQ(error("a.ply", with("1 1 0\n", "1 one 0\n")), "a.ply:12: malformed number 'one'");
    EXPECT_EQ(error("a.ply", good + "1 2 3\n"), "a.ply:15: the file goes on after its last element");
    EXPECT_EQ(error("a.ply", with("element face 1", "element face 0").substr(0, good.size() - 10)),
              "a.ply:13: the file has no faces");

    const std::string binary = binary_ply(std::endian::little);
    const std::size_t body = binary.find("end_header\n") + 11, faces = body + 4 * 15;
    const auto at = [](std::size_t byte) { return "a.ply:byte " + std::to_string(byte) + ": "; };
    EXPECT_EQ(error("a.ply", binary.substr(0, binary.size() - 2)), at(binary.size() - 4) + "the file ends early");
    EXPECT_EQ(error("a.ply", binary + "x"), at(binary.size()) + "the file goes on after its last element");
    EXPECT_EQ(error("a.ply", binary_ply(std::endian::little, 6, 1)), at(binary.size() - 6) + "the file ends early");
    // The count has ten digits where it had one.
    EXPECT_EQ(error("a.ply", binary_ply(std::endian::little, 4, 2147483647)),
              at(binary.size() + 9) + "the file ends early");
    std::string bad = binary;
    bad.replace(body, 8, bytes(std::numeric_limits<double>::infinity()));
    EXPECT_EQ(error("a.ply", bad), at(body) + "a coordinate is not finite");
    bad = binary;
    bad.replace(faces + 5, 4, bytes(std::int32_t{77}));
    EXPECT_EQ(error("a.ply", bad), at(faces) + "index 77 is out of range, there are 4 vertices");
}

TEST_F(MeshFile, ReportsUnreadableFilesAsSuch) {
    const auto io_message = [](const std::function<void()>& f) -> std::string {
        try {
            f();
        } catch (const IoError& e) {
            return e.what();
        }
        return "(no error)";
    };
    const std::string missing = (folder_ / "missing.obj").string();
    EXPECT_EQ(io_message([&] { (void)read_mesh(missing); }), "cannot read " + missing + ": No such file or directory");
    fs::create_directory(folder_ / "folder.ply");
    const std::string folder = (folder_ / "folder.ply").string();
    EXPECT_EQ(io_message([&] { (void)read_mesh(folder); }), "cannot read " + folder + ": Is a directory");
}

TEST(MeshReaders, EveryTruncationAndEveryFlippedByteIsReadOrRefusedCleanly) {
    // No crash and no exception but InputError, and what is read is valid.
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1/1/1 2//2 -1\n",
                      ply = kAsciiPlyHeader + kAsciiPlyVertices + "4 0 1 2 3\n";
    const std::vector<std::pair<decltype(&read_obj), std::string>> files{
        {&read_obj, obj},
        {&read_stl, kAsciiStl},
        {&read_stl, binary_stl({0, 0, 0, 1, 0, 0, 1, 1, 0}, 1)},
        {&read_ply, ply},
        {&read_ply, binary_ply(std::endian::little)},
        {&read_ply, binary_ply(std::endian::big)}};
    std::mt19937_64 rng(7);
    int accepted = 0;
    const auto attempt = [&](auto reader, const std::string& content) {
        try {
            const TriangleMesh mesh = reader("memory", content);
            EXPECT_TRUE(mesh.triangles.empty() || is_valid(mesh));
            accepted += is_valid(mesh) ? 1 : 0;
        } catch (const InputError&) {
        }
    };
    for (const auto& [reader, content] : files) {
        for (std::size_t n = 0; n < content.size(); ++n) attempt(reader, content.substr(0, n));
        for (int i = 0; i < 3000; ++i) {
            std::string s = content;
            for (std::uint64_t k = 1 + rng() % 3; k > 0; --k) {
                const std::uint64_t place = rng() % s.size();
                s[place] = static_cast<char>(rng());
            }
            attempt(reader, s);
        }
    }
    EXPECT_GT(accepted, 100);
}

// ---- real files

TEST(BenchMeshes, AreTheOpenSurfacesTheySay) {
    const TriangleMesh boat = read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj");
    const TriangleMesh bowl = read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/bowl.obj");
    for (const TriangleMesh* m : {&boat, &bowl}) {
        const MeshStatistics s = mesh_statistics(*m);
        EXPECT_FALSE(s.closedness.closed);
        EXPECT_EQ(s.unused_vertices + s.zero_area_triangles + s.duplicate_triangles, 0);
        EXPECT_GT(shell_mass_properties(*m, 10, "mesh").principal_inertia.x, 0);
    }
    // The boat is symmetric about the plane y = 0, its triangulation nearly.
    EXPECT_NEAR(shell_mass_properties(boat, 10, "boat").center_of_mass.y, 0, 1e-4);
}

/// Fields of a CSV row; a quoted field may hold commas.
std::vector<std::string> csv_fields(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (char c : line) {
        if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            fields.emplace_back();
        else
            fields.back() += c;
    }
    return fields;
}

TEST(ExternalMeshes, AllLoadAndAgreeWithTheirManifest) {
    const fs::path folder = fs::path(FLOTILLA_TEST_DATA) / "meshes";
    if (!fs::exists(folder / "MANIFEST.csv")) GTEST_SKIP() << "no external meshes at " << folder;
    std::ifstream manifest(folder / "MANIFEST.csv");
    std::string line;
    std::getline(manifest, line);
    const std::vector<std::string> names = csv_fields(line);
    int read = 0;
    while (std::getline(manifest, line)) {
        const std::vector<std::string> fields = csv_fields(line);
        ASSERT_EQ(fields.size(), names.size());
        std::map<std::string, std::string> row;
        for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = fields[i];
        SCOPED_TRACE(row["file"]);
        const TriangleMesh m = read_mesh(folder / row["file"]);
        EXPECT_TRUE(is_valid(m));
        const MeshStatistics s = mesh_statistics(m);
        const auto expected = [&](const char* name) { return std::stod(row[name]); };
        const auto near = [&](double value, const char* name) {
            EXPECT_NEAR(value, expected(name), 1e-5 * std::abs(expected(name)) + 1e-9) << name;
        };
        EXPECT_EQ(s.vertices, expected("vertices"));
        EXPECT_EQ(s.triangles, expected("triangles"));
        EXPECT_EQ(s.boundary_edges, expected("boundary_edges"));
        EXPECT_EQ(s.non_manifold_edges, expected("nonmanifold_edges"));
        EXPECT_EQ(s.misoriented_edges, expected("misoriented_edges"));
        EXPECT_EQ(s.duplicate_triangles, expected("duplicate"));
        EXPECT_EQ(s.zero_area_triangles, expected("degenerate"));
        EXPECT_EQ(s.closedness.closed, expected("boundary_edges") == 0);
        near(extent(s.box).x, "extent_x");
        near(extent(s.box).y, "extent_y");
        near(extent(s.box).z, "extent_z");
        near(s.area, "area");
        near(s.min_edge, "min_edge");
        near(s.max_edge, "max_edge");
        EXPECT_GT(shell_mass_properties(m, 1, row["file"]).principal_inertia.x, 0);
        if (s.closedness.oriented) near(solid_mass_properties(m, 1, row["file"]).mass, "signed_volume");
        ++read;
    }
    EXPECT_GE(read, 40);
}

} // namespace
} // namespace flotilla
