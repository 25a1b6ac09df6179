// SPDX-License-Identifier: MIT
// Scene files of Rigid-IPC (github.com/ipc-sim/rigid-ipc) as scenes of ours. README.md has what is taken over and how.
//
// Its y axis points up, ours z: everything is turned by a quarter about x, (x, y, z) -> (x, -z, y), which moves and
// negates coordinates and so changes no digit of them.
#pragma once

#include <filesystem>

#include <flotilla/scene_file.hpp>

#include "io/json_document.hpp"

namespace flotilla::io {

/// Whether a document is such a scene: it has the key that all of them have.
[[nodiscard]] bool is_rigid_ipc(const Json& document);

/// Reads it into `scene`, whose settings are those of a preset, and says in `origin` what was left out without changing
/// the outcome. Adds every problem to `errors`, at places of `document`. Meshes are looked for in `folder`, and in
/// folders "meshes" there and above it.
void read_rigid_ipc(const Json& document, const std::filesystem::path& folder, const SceneFileOptions& options,
                    SceneDescription& scene, SceneOrigin& origin, ErrorList& errors);

} // namespace flotilla::io
