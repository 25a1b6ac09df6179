// SPDX-License-Identifier: MIT
// Pictures of a scene without a display: a software renderer for surfaces without thickness.
//
// Visible surfaces come from a z-buffer that keeps the triangle of each sample (deferred shading). Light comes from
// many parallel lights, each with its own shadow map: a few across the sun's disc and a few dozen over the sky. Summing
// them gives soft shadows that harden at contacts, and real sky occlusion inside a pile, at a cost linear in the number
// of triangles. A fixed body that encloses the dynamic ones (a bowl) is cut open: its triangles that stand between the
// camera and the dynamic bodies are drawn as glass.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <flotilla/types.hpp>

#include "io/image.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla {

struct PictureOptions {
    int width = 1600, height = 1000; ///< pixels, 16 to 16384 each
    int supersampling = 2;           ///< samples per pixel and axis, 1 to 4
    double azimuth = -60;            ///< degrees, of the camera seen from the scene, from +x towards +y
    double elevation = 38;           ///< degrees above the horizon, -89.9 to 89.9
    double field_of_view = 28;       ///< degrees, of the longer side, 1 to 120
    double zoom = 1;                 ///< 1: everything just fits; above 1: closer
    std::optional<Vec3> target;      ///< point at the middle of the picture, m; default: chosen so that everything fits
    int sun_samples = 8;    ///< shadow maps over the sun's disc, 1 to 64; cost: one pass over all triangles each
    int sky_samples = 36;   ///< shadow maps over the sky, 1 to 256; cost as above
    double outlines = 0.55; ///< strength of dark lines between bodies, 0 (none) to 1
};

struct PictureBody {
    const TriangleMesh* mesh = nullptr; ///< bodies may share one
    Vec3 position;                      ///< of the mesh's origin, m
    Quat rotation;                      ///< unit
    bool fixed = false;                 ///< drawn in a neutral colour; may be cut open
    std::uint32_t colour = 0;           ///< any number; equal numbers give equal colours
};

/// Deterministic: the same input gives the same bytes. Throws InputError for options out of range, bad meshes and poses
/// that are not finite, all of them in one message.
[[nodiscard]] Image render(std::span<const PictureBody> bodies, const PictureOptions& options = {});

} // namespace flotilla
