// SPDX-License-Identifier: MIT
// Pictures of what a step found: contact points with their normals and impulses, and the pairs of bodies near each
// other. src/run/README.md says how to read one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>

#include <flotilla/picture.hpp>
#include <flotilla/world.hpp>

namespace flotilla {

/// What a picture of a step shows. A pair is counted once, by the first of these that it is.
struct StepPictureReport {
    std::int64_t step = 0;
    double time = 0; ///< s
    std::size_t bodies = 0;
    std::size_t contacts = 0;       ///< points, those of sleeping bodies included
    std::size_t loaded_pairs = 0;   ///< contacts, one of them with an impulse in the last step
    std::size_t sleeping_pairs = 0; ///< contacts, but neither body moves
    std::size_t touching_pairs = 0; ///< contacts, but no impulse
    std::size_t near_pairs = 0;     ///< boxes that meet, and no contact; one of the bodies is dynamic
    double largest_impulse = 0;     ///< N s, of one contact point

    // The same pairs by how the last step, or the last of its inner ones, proved them apart (src/pair/README.md).
    std::size_t proved_by_query = 0;   ///< the continuous detection, or bounds that save it, found no hit
    std::size_t proved_by_boxes = 0;   ///< the boxes of both whole ways are apart
    std::size_t proved_by_cluster = 0; ///< both moved as one, or by a common motion
    std::size_t proved_by_rest = 0;    ///< neither moved: they stand where the step before proved them apart
    std::size_t not_proved = 0;        ///< neither could move, or the World stands where no step of it ended
};

/// What the colours of lines tell of pairs.
enum class PairLines {
    contacts, ///< what is between the bodies
    proofs,   ///< how they were proved apart
};

struct StepPictureOptions {
    PairLines lines = PairLines::contacts;
    /// Called after every step that is made on the way, with how many there are; may be empty.
    std::function<void(std::int64_t done, std::int64_t total)> progress = {};
};

/// Writes a PNG of a World as it stands. `camera_frame` means nothing here. The same state gives the same bytes. Throws
/// InputError (bad options) and IoError.
StepPictureReport write_step_picture(const World& world, const std::filesystem::path& output,
                                     const PictureOptions& options = {}, PairLines lines = PairLines::contacts);

/// The same of a scene file after `step` steps; or of a run folder, whose scene is stepped again, with its edits, from
/// its last checkpoint where that is not later, otherwise from the start. Throws InputError where the folder's scene
/// alone does not make the run again (meshes that it names are elsewhere, another version of the solver made it), and
/// what World throws.
StepPictureReport write_step_picture(const std::filesystem::path& source, std::int64_t step,
                                     const std::filesystem::path& output, const PictureOptions& options = {},
                                     const StepPictureOptions& step_options = {});

} // namespace flotilla
