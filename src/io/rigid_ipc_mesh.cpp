// SPDX-License-Identifier: MIT
#include "io/rigid_ipc_mesh.hpp"

#include <algorithm>
#include <numeric>

#include <flotilla/error.hpp>

#include "base/text.hpp"
#include "base/vec3.hpp"
#include "io/file.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/text_input.hpp"
#include "mesh/topology.hpp"

namespace flotilla::io {

RigidIpcMeshes::RigidIpcMeshes(const std::filesystem::path& folder)
    : folder_(std::filesystem::absolute(folder.empty() ? "." : folder).lexically_normal()) {}

std::filesystem::path RigidIpcMeshes::find(const std::string& name) const {
    std::error_code none;
    const auto is_there = [&](const std::filesystem::path& path) { return std::filesystem::exists(path, none); };
    if (is_there(folder_ / name)) return folder_ / name;
    for (std::filesystem::path folder = folder_;; folder = folder.parent_path()) {
        if (is_there(folder / "meshes" / name)) return folder / "meshes" / name;
        if (folder == folder.parent_path()) break;
    }
    throw InputError("was found neither beside the scene nor in a folder \"meshes\" there or above");
}

const TriangleMesh& RigidIpcMeshes::read(const std::string& name) {
    const auto known = meshes_.find(name);
    if (known != meshes_.end()) return known->second;
    const std::filesystem::path path = find(name);
    TriangleMesh mesh = lower_case_extension(path) == ".obj" ? read_obj_cloud(path, read_text(path)) : read_mesh(path);
    add_loose_points(mesh);
    return meshes_[name] = std::move(mesh);
}

void add_loose_points(TriangleMesh& mesh) {
    std::vector<bool> used(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
        for (const std::int32_t i : t) used[static_cast<std::size_t>(i)] = true;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (!used[i]) mesh.triangles.push_back(point_element(static_cast<std::int32_t>(i)));
}

Vec3 scale_to(const TriangleMesh& mesh, const Vec3& dimensions) {
    const Vec3 size = extent(bounding_box(mesh));
    const auto ratio = [](double wanted, double there) { return wanted / (there > 0 ? there : 1); };
    return {ratio(dimensions.x, size.x), ratio(dimensions.y, size.y), ratio(dimensions.z, size.z)};
}

std::vector<TriangleMesh> components(const TriangleMesh& mesh) {
    // The lowest triangle of a component stands for it: a link always goes to a lower one.
    std::vector<std::size_t> link(mesh.triangles.size());
    std::iota(link.begin(), link.end(), std::size_t{0});
    const auto root = [&](std::size_t t) {
        while (link[t] != t) t = link[t] = link[link[t]];
        return t;
    };
    std::map<Edge, std::size_t> first; ///< triangle of an edge
    for (std::size_t t = 0; t < link.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
            const std::size_t one = root(first.try_emplace(Edge{a, b}, t).first->second), other = root(t);
            link[std::max(one, other)] = std::min(one, other);
        }
    std::map<std::size_t, TriangleMesh> parts;
    for (std::size_t t = 0; t < link.size(); ++t) parts[root(t)].triangles.push_back(mesh.triangles[t]);
    std::vector<TriangleMesh> list;
    for (auto& [lowest, part] : parts) {
        part.vertices = mesh.vertices;
        list.push_back(without_unused_vertices(part));
    }
    return list;
}

} // namespace flotilla::io
