// SPDX-License-Identifier: MIT
#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <tuple>

#include <flotilla/error.hpp>

#include "base/vec3.hpp"
#include "mesh/text_input.hpp"

namespace flotilla {
namespace {

[[noreturn]] void io_failure(const std::filesystem::path& path, const char* verb) {
    throw IoError(std::string("cannot ") + verb + " " + path.string() + ": " +
                  (errno != 0 ? std::strerror(errno) : "unknown reason"));
}

std::string read_file(const std::filesystem::path& path) {
    errno = 0;
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) errno = EISDIR, io_failure(path, "read");
    std::ifstream file(path, std::ios::binary);
    if (!file) io_failure(path, "read");
    std::string data(std::istreambuf_iterator<char>(file), {});
    if (file.bad()) io_failure(path, "read");
    return data;
}

std::string lower_case_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

/// The shortest text that reads back as the same double.
void append_number(std::string& text, double x) {
    std::array<char, 32> buffer;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), x).ptr;
    text.append(buffer.data(), end);
}

} // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
    const std::string extension = lower_case_extension(path);
    if (extension != ".obj" && extension != ".stl" && extension != ".ply")
        throw InputError(path.string() + ":1: unknown mesh format '" + extension + "', known are .obj, .stl and .ply");
    const std::string data = read_file(path);
    if (extension == ".obj") return read_obj(path, data);
    if (extension == ".stl") return read_stl(path, data);
    return read_ply(path, data);
}

void validate_mesh(const TriangleMesh& mesh, const std::string& name) {
    const std::string shape = "shape '" + name + "': ";
    if (mesh.vertices.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
        throw InputError(shape + "too many vertices");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        if (!is_finite(mesh.vertices[i])) throw InputError(shape + "vertex " + std::to_string(i) + " is not finite");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::int32_t v : mesh.triangles[t])
            if (v < 0 || static_cast<std::size_t>(v) >= mesh.vertices.size())
                throw InputError(shape + "triangle " + std::to_string(t) + ": " +
                                 out_of_range_text(v, mesh.vertices.size()));
    if (mesh.triangles.empty()) throw InputError(shape + "it has no triangles");
}

void write_obj(const std::filesystem::path& path, const TriangleMesh& mesh) {
    std::string text;
    for (const Vec3& v : mesh.vertices) {
        text += "v";
        for (double x : {v.x, v.y, v.z}) append_number(text += ' ', x);
        text += '\n';
    }
    for (const Triangle& t : mesh.triangles) {
        text += "f";
        for (std::int32_t i : t) text += ' ' + std::to_string(i + 1);
        text += '\n';
    }
    errno = 0;
    std::ofstream file(path, std::ios::binary);
    file.write(text.data(), static_cast<std::streamsize>(text.size()));
    file.close();
    if (!file) io_failure(path, "write");
}

TriangleMesh merge_equal_vertices(const TriangleMesh& mesh) {
    const std::vector<Vec3>& v = mesh.vertices;
    std::vector<std::size_t> order(v.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return std::tie(v[i].x, v[i].y, v[i].z, i) < std::tie(v[j].x, v[j].y, v[j].z, j);
    });
    // In a run of equal positions the first has the lowest index: it stands for all.
    std::vector<std::size_t> representative(v.size());
    for (std::size_t k = 0; k < order.size(); ++k)
        representative[order[k]] = k > 0 && v[order[k]] == v[order[k - 1]] ? representative[order[k - 1]] : order[k];
    TriangleMesh merged;
    std::vector<std::int32_t> new_index(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) {
        if (representative[i] == i) {
            new_index[i] = static_cast<std::int32_t>(merged.vertices.size());
            merged.vertices.push_back(v[i]);
        } else {
            new_index[i] = new_index[representative[i]];
        }
    }
    merged.triangles = mesh.triangles;
    for (Triangle& t : merged.triangles)
        for (std::int32_t& i : t) i = new_index[static_cast<std::size_t>(i)];
    return merged;
}

} // namespace flotilla
