// SPDX-License-Identifier: MIT
// Names of the files in a run folder, and the two small ones that describe the run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "run_folder/run_folder.hpp"

namespace flotilla::io {

inline constexpr std::string_view kRunJson = "run.json";
inline constexpr std::string_view kSceneJson = "scene.json";
inline constexpr std::string_view kEditsJson = "edits.json";
inline constexpr std::string_view kMeshes = "meshes.h5";
inline constexpr std::string_view kStepsCsv = "steps.csv";

/// Eight digits or more, so that names sort like numbers.
[[nodiscard]] std::string padded(std::int64_t value);
[[nodiscard]] std::filesystem::path segment_path(const std::filesystem::path& folder, std::int64_t first,
                                                 std::int64_t last);
/// The segments in the folder by their names, in frame order; where two overlap (a crash while one replaced the other)
/// the longer one.
[[nodiscard]] std::vector<SegmentFile> list_segments(const std::filesystem::path& folder);
/// Everything in the folder that a run wrote, temporary files included; other people's files are not touched.
void remove_run_files(const std::filesystem::path& folder);

[[nodiscard]] std::string run_json_text(const RunInfo& info, std::size_t bodies, const std::string& started,
                                        const std::string& status, std::int64_t frames);
/// `earlier`, a JSON array, with an entry for the process that goes on after step `step`.
[[nodiscard]] std::string resumed_json(const std::string& earlier, const RunInfo& info, std::int64_t step);
[[nodiscard]] RunInfo parse_run_json(const std::filesystem::path& path, const std::string& text);
/// As the system calls it.
[[nodiscard]] std::string processor_name();
/// Now, UTC, ISO 8601.
[[nodiscard]] std::string utc_now();

void write_meshes(const std::filesystem::path& path, const RunScene& scene);
[[nodiscard]] RunScene read_meshes(const std::filesystem::path& path);

} // namespace flotilla::io
