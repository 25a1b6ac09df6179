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
#include <span>

#include <flotilla/picture.hpp>
#include <flotilla/types.hpp>

#include "mesh/triangle_mesh.hpp"
#include "picture/image.hpp"
#include "picture/overlay.hpp"

namespace flotilla {

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
/// The same, seen by the camera that fits `seen`. The frames of the options mean nothing here.
[[nodiscard]] Image render(std::span<const PictureBody> bodies, std::span<const PictureBody> seen,
                           const PictureOptions& options);
/// The first, with an overlay over it.
[[nodiscard]] Image render(std::span<const PictureBody> bodies, const PictureOptions& options, const Overlay& overlay);

} // namespace flotilla
