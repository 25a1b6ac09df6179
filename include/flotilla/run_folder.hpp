// SPDX-License-Identifier: MIT
// What can be done with the folder of a finished or running simulation, apart from verifying it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include <flotilla/export.hpp>
#include <flotilla/report.hpp>
#include <flotilla/types.hpp>

namespace flotilla {

struct RunSummary {
    std::string status; ///< "running", "complete" or why it ended
    std::string version, commit, compiler, processor, started, updated;
    std::vector<std::string> command_line;
    int threads = 0;
    double time_step = 0; ///< s
    int substeps = 1;     ///< inner ones of a step
    std::int64_t bodies = 0, dynamic_bodies = 0, shapes = 0;
    std::int64_t triangles = 0; ///< of all bodies
    std::int64_t frames = 0;
    std::int64_t last_step = 0;
    double last_time = 0; ///< s
    std::uintmax_t frame_bytes = 0;
    std::int64_t checkpoint_step = -1; ///< -1: no valid checkpoint
    std::vector<std::string> problems; ///< files that are damaged or missing
    std::string settings_json;
};
/// IoError where `folder` is not a run folder.
[[nodiscard]] RunSummary summarize_run(const std::filesystem::path& folder);

/// Poses of a run over time. Every array of bodies is [frames][bodies], in scene order.
struct RunFrames {
    std::vector<std::string> bodies;    ///< names
    std::vector<std::int64_t> frame;    ///< numbers in the run
    std::vector<std::int64_t> step;     ///< that ended at the frame
    std::vector<double> time;           ///< s
    std::vector<Vec3> position;         ///< of the meshes' own origins, m
    std::vector<Quat> rotation;         ///< mesh axes to world
    std::vector<Vec3> velocity;         ///< of the centres of mass, m/s
    std::vector<Vec3> angular_velocity; ///< rad/s, world axes
    std::vector<BodyActivity> activity; ///< of the steps that ended there; empty where a frame of the range has none
};

/// Reads frames of a run, also of one that goes on; 13 doubles and an activity for every body and frame. InputError
/// where the run has no frame of the range, IoError where one cannot be read.
[[nodiscard]] RunFrames read_frames(const std::filesystem::path& folder, const FrameRange& range = {});

/// Writes a CSV to a stream. InputError where the run has no frame of the range.
void export_csv(const std::filesystem::path& folder, std::ostream& out, const FrameRange& range = {});
/// Writes `output`: a file for csv, glb and usd, a folder for vtp and obj. Existing files are replaced. InputError
/// where the run has no frame of the range, IoError where something cannot be read or written.
void export_run(const std::filesystem::path& folder, ExportFormat format, const std::filesystem::path& output,
                const FrameRange& range = {});

/// How much export_run writes, to within a third, by the bodies, the shapes and three frames. Errors as there.
[[nodiscard]] ExportSize estimate_export(const std::filesystem::path& folder, ExportFormat format,
                                         const FrameRange& range = {});

} // namespace flotilla
