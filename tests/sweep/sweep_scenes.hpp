// SPDX-License-Identifier: MIT
// Small scenes with known answers, and runs of them inside the test's own process.
#pragma once

#include <string>

#include <flotilla/run.hpp>
#include <flotilla/scene_file.hpp>
#include <flotilla/sweep.hpp>

#include "support/temporary_folder.hpp"

namespace flotilla::test {

/// A cube of edge 1 m and 500 kg, its centre at height `z`, above a ground at height 0.
inline std::string cube_scene(double z, const std::string& velocity = "[0, 0, 0]", bool ground = true) {
    return R"({"flotilla_scene": 1, "gravity": [0, 0, -10], "settings": {"time_step": 0.02, "restitution": 0},
        "shapes": [{"name": "cube", "density": 500, "vertices": [[-0.5,-0.5,-0.5],[0.5,-0.5,-0.5],[-0.5,0.5,-0.5],
          [0.5,0.5,-0.5],[-0.5,-0.5,0.5],[0.5,-0.5,0.5],[-0.5,0.5,0.5],[0.5,0.5,0.5]],
          "triangles": [[0,2,1],[1,2,3],[4,5,6],[5,7,6],[0,1,4],[1,5,4],[2,6,3],[3,6,7],[0,4,2],[2,4,6],[1,3,5],
            [3,7,5]]},
         {"name": "ground", "vertices": [[-9,-9,0],[9,-9,0],[0,9,0]], "triangles": [[0,1,2]]}],
        "bodies": [{"name": "cube", "shape": "cube", "position": [0, 0, )" +
           std::to_string(z) + R"(], "velocity": )" + velocity + "}" +
           (ground ? R"(, {"name": "ground", "shape": "ground", "type": "static"})" : "") + "]}";
}

/// Runs into `folder`, a frame per step, and returns the scene as it ran.
inline SceneDescription run_into(const std::filesystem::path& folder, const std::string& json, std::int64_t steps,
                                 const std::vector<std::pair<std::string, std::string>>& set = {}) {
    SceneDescription scene = parse_scene(json, "scene", ".", {"balanced", set});
    RunOptions options;
    options.output = folder;
    options.steps = steps;
    options.world.threads = 1;
    (void)run_scene(scene, "scene", options);
    return scene;
}

/// SweepOptions::run without a process.
inline SweepOutcome run_here(const SweepMember& member) {
    RunOptions options;
    options.output = member.folder;
    options.steps = member.steps;
    options.frame_every = member.frame_every;
    options.world.threads = member.threads;
    options.resume = true;
    (void)run_scene(read_scene(member.scene, {member.preset, member.overrides}), member.name, options);
    return {0, "", 1e9};
}

} // namespace flotilla::test
