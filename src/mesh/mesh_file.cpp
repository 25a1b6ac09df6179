// SPDX-License-Identifier: MIT
#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <tuple>

#include <flotilla/error.hpp>

#include "base/text.hpp"
#include "base/vec3.hpp"
#include "mesh/text_input.hpp"

namespace flotilla {
namespace {

[[noreturn]] void cannot_read(const std::filesystem::path& path) {
    throw IoError("cannot read " + path.string() + ": " + (errno != 0 ? std::strerror(errno) : "unknown reason"));
}

std::string read_file(const std::filesystem::path& path) {
    errno = 0;
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored)) errno = EISDIR, cannot_read(path);
    std::ifstream file(path, std::ios::binary);
    if (!file) cannot_read(path);
    std::string data(std::istreambuf_iterator<char>(file), {});
    if (file.bad()) cannot_read(path);
    return data;
}

} // namespace

std::string lower_case_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

TriangleMesh read_mesh(const std::filesystem::path& path, std::string_view part) {
    const std::string extension = lower_case_extension(path);
    if (extension != ".obj" && extension != ".stl" && extension != ".ply")
        throw InputError(path.string() + ":1: unknown mesh format '" + extension + "', known are .obj, .stl and .ply");
    if (!part.empty() && extension != ".obj")
        throw InputError(path.string() + ":1: a file of this format has no objects, " + in_quotes(part) +
                         " is none of it");
    const std::string data = read_file(path);
    if (extension == ".obj") return part.empty() ? read_obj(path, data) : read_obj_part(path, data, part);
    if (extension == ".stl") return read_stl(path, data);
    return read_ply(path, data);
}

std::vector<std::int32_t> number_positions(std::span<const Vec3> v) {
    std::vector<std::size_t> order(v.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        return std::tie(v[i].x, v[i].y, v[i].z, i) < std::tie(v[j].x, v[j].y, v[j].z, j);
    });
    // In a run of equal positions the first has the lowest index: it stands for all.
    std::vector<std::size_t> representative(v.size());
    for (std::size_t k = 0; k < order.size(); ++k)
        representative[order[k]] = k > 0 && v[order[k]] == v[order[k - 1]] ? representative[order[k - 1]] : order[k];
    std::vector<std::int32_t> number(v.size());
    std::int32_t numbers = 0;
    for (std::size_t i = 0; i < v.size(); ++i)
        number[i] = representative[i] == i ? numbers++ : number[representative[i]];
    return number;
}

TriangleMesh merge_equal_vertices(const TriangleMesh& mesh) {
    const std::vector<std::int32_t> number = number_positions(mesh.vertices);
    TriangleMesh merged{{}, mesh.triangles};
    for (std::size_t i = 0; i < number.size(); ++i)
        if (static_cast<std::size_t>(number[i]) == merged.vertices.size()) merged.vertices.push_back(mesh.vertices[i]);
    for (Triangle& t : merged.triangles)
        for (std::int32_t& i : t) i = number[static_cast<std::size_t>(i)];
    return merged;
}

TriangleMesh without_unused_vertices(const TriangleMesh& mesh) {
    std::vector<std::int32_t> new_index(mesh.vertices.size(), -1);
    for (const Triangle& t : mesh.triangles)
        for (const std::int32_t i : t) new_index[static_cast<std::size_t>(i)] = 0;
    TriangleMesh used{{}, mesh.triangles};
    for (std::size_t i = 0; i < new_index.size(); ++i) {
        if (new_index[i] < 0) continue;
        new_index[i] = static_cast<std::int32_t>(used.vertices.size());
        used.vertices.push_back(mesh.vertices[i]);
    }
    for (Triangle& t : used.triangles)
        for (std::int32_t& i : t) i = new_index[static_cast<std::size_t>(i)];
    return used;
}

} // namespace flotilla
