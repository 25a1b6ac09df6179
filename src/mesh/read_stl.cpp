// SPDX-License-Identifier: MIT
// STL, ASCII and binary. Normals and attributes are skipped: the order of the corners says which way a triangle faces.
#include <array>
#include <cmath>
#include <cstring>

#include "mesh/binary_input.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/text_input.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kHeaderBytes = 80, kTriangleBytes = 50;

void add_triangle(TriangleMesh& mesh, const std::array<Vec3, 3>& corners) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
}

/// Words regardless of lines: facets are laid out in many ways.
struct AsciiStlReader {
    TextInput in;
    std::string_view rest{};
    TriangleMesh mesh{};

    /// The next word of the file; empty at its end.
    std::string_view word() {
        for (;;) {
            if (const auto w = take_word(rest); !w.empty()) return w;
            const auto line = in.next_line();
            if (!line) return {};
            rest = *line;
        }
    }

    static bool equal_ignoring_case(std::string_view a, std::string_view lower) {
        return std::equal(a.begin(), a.end(), lower.begin(), lower.end(),
                          [](char x, char y) { return (x >= 'A' && x <= 'Z' ? x - 'A' + 'a' : x) == y; });
    }

    void expect(std::string_view keyword) {
        const std::string_view w = word();
        if (w.empty()) in.fail("the file ends early, '" + std::string(keyword) + "' is missing");
        if (!equal_ignoring_case(w, keyword))
            in.fail("expected '" + std::string(keyword) + "', found '" + std::string(w) + "'");
    }

    void read() {
        for (std::string_view w = word(); !w.empty(); w = word()) {
            if (!equal_ignoring_case(w, "solid")) in.fail("expected 'solid', found '" + std::string(w) + "'");
            rest = {}; // the name
            solid();
        }
        if (mesh.triangles.empty()) in.fail("the file has no facets");
    }

    void solid() {
        for (;;) {
            const std::string_view w = word();
            if (w.empty()) in.fail("the file ends early, 'endsolid' is missing");
            if (equal_ignoring_case(w, "endsolid")) break;
            if (!equal_ignoring_case(w, "facet"))
                in.fail("expected 'facet' or 'endsolid', found '" + std::string(w) + "'");
            facet();
        }
        rest = {};
    }

    void facet() {
        expect("normal");
        for (int i = 0; i < 3; ++i) in.number(word());
        expect("outer");
        expect("loop");
        std::array<Vec3, 3> corners;
        for (Vec3& v : corners) {
            expect("vertex");
            for (double* x : {&v.x, &v.y, &v.z}) *x = in.coordinate(word());
        }
        expect("endloop");
        expect("endfacet");
        add_triangle(mesh, corners);
    }
};

TriangleMesh read_binary_stl(const std::filesystem::path& path, const std::string& data) {
    BinaryInput in(path, data, 0, std::endian::little);
    in.skip(kHeaderBytes);
    const std::size_t count = in.take<std::uint32_t>();
    if (count == 0) in.fail_at(kHeaderBytes, "the file has no facets");
    if (in.remaining() != count * kTriangleBytes)
        in.fail_at(kHeaderBytes, "the file says " + std::to_string(count) + " facets, which take " +
                                     std::to_string(count * kTriangleBytes) + " bytes, but " +
                                     std::to_string(in.remaining()) + " follow");
    TriangleMesh mesh;
    for (std::size_t i = 0; i < count; ++i) {
        in.skip(3 * sizeof(float));
        std::array<Vec3, 3> corners;
        for (Vec3& v : corners)
            for (double* x : {&v.x, &v.y, &v.z}) {
                *x = double{in.take<float>()};
                if (!std::isfinite(*x)) in.fail_at(in.position() - sizeof(float), "a coordinate is not finite");
            }
        in.skip(sizeof(std::uint16_t));
        add_triangle(mesh, corners);
    }
    return mesh;
}

/// Binary files may begin with "solid" as well, so their length decides. (In text the four bytes of the count would say
/// more than 8 GB.)
bool is_binary(const std::string& data) {
    if (data.size() >= kHeaderBytes + 4) {
        std::uint32_t count = 0;
        for (std::size_t i = 0; i < 4; ++i)
            count |= std::uint32_t{static_cast<unsigned char>(data[kHeaderBytes + i])} << (8 * i);
        if (data.size() == kHeaderBytes + 4 + count * kTriangleBytes) return true;
    }
    const std::size_t start = data.find_first_not_of(" \t\r\n");
    return start == std::string::npos ||
           !AsciiStlReader::equal_ignoring_case(std::string_view(data).substr(start, 5), "solid") ||
           data.find('\0') != std::string::npos;
}

} // namespace

TriangleMesh read_stl(const std::filesystem::path& path, const std::string& data) {
    if (is_binary(data)) return merge_equal_vertices(read_binary_stl(path, data));
    AsciiStlReader reader{TextInput(path, data)};
    reader.read();
    return merge_equal_vertices(reader.mesh);
}

} // namespace flotilla
