// SPDX-License-Identifier: MIT
#include "io/mesh_source.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <flotilla/error.hpp>

#include "io/file.hpp"
#include "io/read_gltf.hpp"
#include "mesh/mesh_file.hpp"

namespace flotilla::io {

namespace {

using std::string_view_literals::operator""sv;

constexpr std::array kExtensions{".obj"sv, ".stl"sv, ".ply"sv, ".gltf"sv, ".glb"sv};

/// Where the part's '#' is; the end where there is none.
std::size_t part_mark(const std::string& source) {
    for (std::size_t at = source.find('#'); at != std::string::npos; at = source.find('#', at + 1)) {
        const std::string extension = lower_case_extension(source.substr(0, at));
        if (std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end()) return at;
    }
    return source.size();
}

} // namespace

TriangleMesh read_mesh_source(const std::filesystem::path& folder, const std::string& source) {
    const std::size_t mark = part_mark(source);
    const std::filesystem::path file = folder / source.substr(0, mark);
    const std::string_view part = mark < source.size() ? std::string_view(source).substr(mark + 1) : std::string_view{};
    const std::string extension = lower_case_extension(file);
    if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
        throw InputError(file.string() + ":1: unknown mesh format '" + extension +
                         "', known are .obj, .stl, .ply, .gltf and .glb");
    if (extension == ".gltf" || extension == ".glb") return read_gltf(file, read_text(file), part);
    return read_mesh(file, part);
}

} // namespace flotilla::io
