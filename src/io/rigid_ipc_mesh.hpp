// SPDX-License-Identifier: MIT
// Meshes of Rigid-IPC's scenes, in its own axes.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.hpp"

namespace flotilla::io {

/// Finds and reads mesh files, each once.
class RigidIpcMeshes {
  public:
    explicit RigidIpcMeshes(const std::filesystem::path& folder);

    /// With its loose points. Throws InputError where the mesh is not found; IoError where it cannot be read.
    const TriangleMesh& read(const std::string& name);

  private:
    [[nodiscard]] std::filesystem::path find(const std::string& name) const;

    std::filesystem::path folder_; ///< absolute
    std::map<std::string, TriangleMesh> meshes_;
};

/// Vertices that no face or edge has are points that collide by themselves.
void add_loose_points(TriangleMesh& mesh);

/// Per axis, what makes the mesh's box as long as `dimensions`; 1 along axes in which it has no extent.
[[nodiscard]] Vec3 scale_to(const TriangleMesh& mesh, const Vec3& dimensions);

/// The parts that hang together by edges, in the order of their first triangles.
[[nodiscard]] std::vector<TriangleMesh> components(const TriangleMesh& mesh);

} // namespace flotilla::io
