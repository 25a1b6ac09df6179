// SPDX-License-Identifier: MIT
// Scenes, steps, edits, questions and snapshots in memory, with the core alone.
#include <cstddef>
#include <cstdio>
#include <sstream>
#include <string>
#include <vector>

#include <flotilla/build_info.hpp>
#include <flotilla/ccd.hpp>
#include <flotilla/edit_file.hpp>
#include <flotilla/error.hpp>
#include <flotilla/plan.hpp>
#include <flotilla/scene_check.hpp>
#include <flotilla/scene_file.hpp>
#include <flotilla/scene_library.hpp>
#include <flotilla/world.hpp>

namespace {

const std::string kScene = R"({"flotilla_scene": 1,
  "shapes": [{"name": "plate", "vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "mass": 2.0}],
  "bodies": [{"name": "a", "shape": "plate", "position": [0,0,1]}, {"name": "b", "shape": "plate", "type": "static"}]})";
const std::string kEdits = R"({"flotilla_edits": 1, "edits": [{"step": 0, "set_gravity": [0, 0, -1]}]})";

bool reads_and_writes_scenes() {
    const flotilla::SceneDescription scene = flotilla::parse_scene(kScene, "scene", ".");
    std::ostringstream text;
    flotilla::write_scene(text, scene);
    flotilla::World world(scene), again(flotilla::parse_scene(text.str(), "again", "."));
    for (const flotilla::Edit& edit : flotilla::parse_edits(kEdits, "edits", ".", scene)) {
        world.apply(edit);
        again.apply(edit);
    }
    for (int i = 0; i < 10; ++i) world.step(), again.step();
    return world.state_hash() == again.state_hash() && !flotilla::plan_scene(scene).empty() &&
           flotilla::check_scene(scene).intersections.empty();
}

bool steps_and_goes_back() {
    const flotilla::SceneDescription scene = flotilla::make_scene("household", 12);
    flotilla::World world(scene);
    for (int i = 0; i < 12; ++i) world.step();
    const std::vector<std::byte> snapshot = world.snapshot();
    for (int i = 0; i < 4; ++i) world.step();
    flotilla::World later(scene, snapshot);
    for (int i = 0; i < 4; ++i) later.step();
    const bool same = later.state_hash() == world.state_hash() && world.ray({0, 0, 99}, {0, 0, -1}, 999).has_value();
    std::printf("state hash: %016lx\n", static_cast<unsigned long>(world.state_hash()));
    return same;
}

bool refuses() {
    try {
        static_cast<void>(flotilla::read_scene("no_such_scene.json"));
    } catch (const flotilla::IoError& error) {
        std::printf("refused as it should be: %s\n", error.what());
        return true;
    }
    return false;
}

} // namespace

int main() { return reads_and_writes_scenes() && steps_and_goes_back() && refuses() ? 0 : 1; }
