// SPDX-License-Identifier: MIT
// glTF 2.0, as JSON (.gltf, with buffers as data URIs or files beside it) and binary (.glb): the triangles, strips and
// fans of all nodes of a scene as one mesh. Materials, skins, morph targets, animations, points and lines are skipped.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::io {

/// `data` is the whole file. Coordinates are those of the scene (its y points up), with the transforms of nodes;
/// vertices at equal positions, which texture seams and creases repeat, are one. `node` names one node: what hangs on
/// it, in the same coordinates. Throws InputError: "path: /meshes/0/primitives/1: reason". Sizes are checked against
/// the bytes that are there before memory is asked for.
[[nodiscard]] TriangleMesh read_gltf(const std::filesystem::path& path, std::string_view data,
                                     std::string_view node = {});

} // namespace flotilla::io
