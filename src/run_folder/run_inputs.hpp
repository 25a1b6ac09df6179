// SPDX-License-Identifier: MIT
// What two run folders say about where they come from.
#pragma once

#include <string>
#include <vector>

#include "run_folder/run_folder.hpp"

namespace flotilla::io {

struct RecordDifference {
    std::string name; ///< path in run.json, or "scene.json" and a path in it
    std::string a, b; ///< empty where a run does not have it
    bool input;       ///< the bits of a run depend on it
};
/// Differences of run.json and scene.json, in the order of the first. Not compared: what changes while a run is written
/// (dates, counts of frames), and of scene.json the settings (run.json holds the resolved ones) and the paths of meshes
/// (the meshes themselves count).
[[nodiscard]] std::vector<RecordDifference> record_differences(const RunReader& a, const RunReader& b);

/// The same bodies by name and type, and bit for bit the same meshes and centres of mass.
[[nodiscard]] bool same_bodies(const RunScene& a, const RunScene& b);

} // namespace flotilla::io
