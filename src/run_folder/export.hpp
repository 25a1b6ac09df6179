// SPDX-License-Identifier: MIT
// A run in the formats of other programs. Whole files are written, replaced only once they are complete.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include <flotilla/export.hpp>

#include "run_folder/run_folder.hpp"

namespace flotilla::io {

/// The part of the range that the run has, with the last frame that is one of it. InputError where there is none, or
/// `every` < 1.
[[nodiscard]] FrameRange frames_of(const RunReader& run, const FrameRange& range);
[[nodiscard]] inline std::int64_t count(const FrameRange& r) { return (r.last - r.first) / r.every + 1; }

/// Bytes of a format, from the numbers that it writes for a body and a vertex, a triangle or a name, to within a third.
/// How long they are as text is seen in the first, middle and last frame. `range` is one of frames_of().
[[nodiscard]] std::uintmax_t export_bytes(RunReader& run, ExportFormat format, const FrameRange& range);

// All of the following write the frames of `range`, which is one of frames_of(); frames keep their numbers in the run.

/// The contract's CSV (run_folder/poses_csv.hpp), handed to `write` frame by frame.
void export_csv(RunReader& run, const FrameRange& range, const std::function<void(std::string_view)>& write);

/// frame-<k>.obj: all bodies in world coordinates, one object each.
void export_obj(RunReader& run, const FrameRange& range, const std::filesystem::path& folder);

// What an edit removed, or will add, is in none of them, but for the CSV (run_folder/run_bodies.hpp).

/// For ParaView: bodies.pvd, the collection over time of frames/bodies-<k>.vtp with one point per body, at the mesh's
/// origin; point data body, shape, type, quaternion (w x y z), velocity, angular_velocity, speed, and
/// where the run records them contacts, cluster (0 free, 1 kinematic, 2 rigid, 3 held, 4 asleep) and cost.
/// meshes/<k>-<name>.vtp are the shapes in mesh coordinates, for glyphs turned by the quaternion.
void export_vtp(RunReader& run, const FrameRange& range, const std::filesystem::path& folder);

/// Binary glTF 2.0: one node per body with keyframes of every frame; single precision; z becomes up through the root
/// node. Bodies have the colours of pictures (run_folder/body_colour.hpp): a material for each, and a mesh for each
/// shape and colour. A body that is not there has scale 0, step by step, at the place where it comes or went
/// (run_folder/held_poses.hpp).
void export_glb(RunReader& run, const FrameRange& range, const std::filesystem::path& file);

/// USD as text (.usda), z up, metres: /run/bodies is a UsdGeomPointInstancer with an instance per body and a prototype
/// mesh per shape; time samples of positions, orientations (in half and single precision), velocities and
/// angularVelocities (degrees/s); time code k is frame k. ids are body numbers, primvars:name their names; invisibleIds
/// names those that are not there, which stand where they come or went.
void export_usd(RunReader& run, const FrameRange& range, const std::filesystem::path& file);

} // namespace flotilla::io
