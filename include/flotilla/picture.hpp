// SPDX-License-Identifier: MIT
// Pictures of runs and scenes, rendered in software: no display, no graphics card.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>

#include <flotilla/types.hpp>

namespace flotilla {

struct PictureOptions {
    int width = 1600, height = 1000; ///< pixels, 16 to 16384 each
    int supersampling = 2;           ///< samples per pixel and axis, 1 to 4
    double azimuth = -60;            ///< degrees, of the camera seen from the scene, from +x towards +y
    double elevation = 38;           ///< degrees above the horizon, -89.9 to 89.9
    double field_of_view = 28;       ///< degrees, of the longer side, 1 to 120
    double zoom = 1;                 ///< 1: everything just fits; above 1: closer; 0.001 to 1000
    std::optional<Vec3> target;      ///< point at the middle of the picture, m; default: chosen so that everything fits
    /// The frame that the camera is fitted to, so that pictures of a run make a film; default: the one shown.
    std::optional<std::int64_t> camera_frame;
    int sun_samples = 8;    ///< shadow maps over the sun's disc, 1 to 64; cost: one pass over all triangles each
    int sky_samples = 36;   ///< shadow maps over the sky, 1 to 256; cost as above
    double outlines = 0.55; ///< strength of dark lines between bodies, 0 (none) to 1
};

/// What a picture shows.
struct PictureReport {
    std::int64_t frame = 0, frames = 1; ///< index from 0, and how many there are
    double time = 0;                    ///< s
    std::size_t bodies = 0;
};

/// Writes a PNG of frame `frame` (default: the last one) of a run folder, or of the initial state of a scene file. The
/// same input gives the same bytes. Throws InputError (bad options, scene or frame number) and IoError.
PictureReport write_picture(const std::filesystem::path& source, const std::filesystem::path& output,
                            const PictureOptions& options = {}, std::optional<std::int64_t> frame = {});

} // namespace flotilla
