// SPDX-License-Identifier: MIT
// Mesh files: strict readers for OBJ, STL and PLY.
//
// Geometry is taken as it is: degenerate and duplicate triangles, open and non-manifold surfaces are all accepted. What
// is refused, by an InputError saying `path:line: reason` (`path:byte N: reason` in binary data), is anything whose
// meaning is in doubt: malformed numbers, coordinates that are not finite, indices out of range, files shorter or
// longer than they say, meshes without a triangle. Numbers are read and written the same in every locale.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// Reads a mesh; the extension (.obj, .stl, .ply, in any case) decides the format. Polygons become fans around their
/// first corner. STL, which repeats every vertex, has its equal vertices merged. `part` names one object or group of an
/// OBJ file; without it all faces are one mesh. Throws InputError, or IoError where the file cannot be read.
[[nodiscard]] TriangleMesh read_mesh(const std::filesystem::path& path, std::string_view part = {});

/// For each vertex the number of its position (0 and -0 are equal), in order of first appearance.
[[nodiscard]] std::vector<std::int32_t> number_positions(std::span<const Vec3> vertices);

/// The mesh with vertices at equal positions (0 and -0 are equal) made one, in order of first appearance.
[[nodiscard]] TriangleMesh merge_equal_vertices(const TriangleMesh& mesh);

/// The mesh with the vertices that triangles use, in their order.
[[nodiscard]] TriangleMesh without_unused_vertices(const TriangleMesh& mesh);

/// The extension with its dot, A to Z in lower case.
[[nodiscard]] std::string lower_case_extension(const std::filesystem::path& path);

} // namespace flotilla
