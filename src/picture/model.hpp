// SPDX-License-Identifier: MIT
// The scene as the renderer sees it: world vertices of all bodies about the middle of the picture, in units of the
// scene's radius (so that single precision serves at any scale and place), normals, and which triangles are cut open.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "picture/float3.hpp"
#include "picture/render.hpp"

namespace flotilla::picture {

/// What all bodies of one mesh share.
struct MeshData {
    const TriangleMesh* mesh = nullptr;
    std::shared_ptr<const TriangleMesh> drawn; ///< what `mesh` is, where segments and points were made visible
    std::vector<Float3> corner_normals; ///< [triangles][3], unit, mesh axes; smooth across edges below the crease angle
    Vec3 center;                        ///< middle of the bounding box, mesh coordinates
    double radius = 0;                  ///< about center, m
    bool inside_out = false;            ///< triangles wind the other way round: their fronts look towards the center
};

struct BodyData {
    std::uint32_t mesh = 0;         ///< index into Model::meshes
    std::uint32_t first_vertex = 0; ///< into Model::vertices
    Quat rotation;
    Float3 center; ///< of the bounding sphere
    float radius = 0;
    bool fixed = false;
    bool in_focus = false; ///< part of what the picture is about: the camera and the shadow maps are fitted to it
    Float3 colour;         ///< linear albedo
    std::vector<std::uint8_t> glass; ///< per triangle, 1: drawn as glass; empty: none is
};

struct Model {
    std::vector<MeshData> meshes;
    std::vector<BodyData> bodies;
    std::vector<Float3> vertices;
    Vec3 origin;      ///< world point at the model's (0, 0, 0), m
    double scale = 1; ///< metres per model unit
    Float3 dynamic_center;
    float dynamic_radius = 1; ///< of the dynamic bodies in focus, model units
    float focus_radius = 1;   ///< of everything in focus about (0, 0, 0)
    float floor = 0;          ///< lowest z in focus

    [[nodiscard]] const TriangleMesh& mesh(const BodyData& body) const { return *meshes[body.mesh].mesh; }
    [[nodiscard]] std::span<const Float3> vertices_of(const BodyData& body) const {
        return std::span(vertices).subspan(body.first_vertex, mesh(body).vertices.size());
    }
};

/// Precondition: meshes and poses are valid (render checks).
[[nodiscard]] Model build_model(std::span<const PictureBody> bodies);

/// Marks the triangles of enclosing fixed bodies that stand between `eye` and the dynamic bodies.
void cut_open(Model& model, Float3 eye);

} // namespace flotilla::picture
