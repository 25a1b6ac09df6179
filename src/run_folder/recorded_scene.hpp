// SPDX-License-Identifier: MIT
// The scene that a run was made of, from what its folder keeps.
#pragma once

#include <flotilla/scene.hpp>

#include "run_folder/run_folder.hpp"

namespace flotilla::io {

/// The scene's text with the settings that the run had. Meshes that it names, as in folders of older versions, are
/// looked for beside the folder's own files. Throws InputError where the folder has no text, or where that is no valid
/// scene there.
[[nodiscard]] SceneDescription recorded_scene(const RunReader& run);

} // namespace flotilla::io
