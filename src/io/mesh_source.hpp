// SPDX-License-Identifier: MIT
// The mesh that a scene names: a file, or one part of it.
#pragma once

#include <filesystem>
#include <string>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::io {

/// "FILE" or "FILE#PART", relative to `folder`: OBJ, STL, PLY or glTF by the file's extension. PART is an object or
/// group of an OBJ file or a node of a glTF file; without it everything in the file is one mesh. A '#' that no
/// extension of these goes before belongs to the file's name. Throws InputError or IoError.
[[nodiscard]] TriangleMesh read_mesh_source(const std::filesystem::path& folder, const std::string& source);

} // namespace flotilla::io
