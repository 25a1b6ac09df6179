// SPDX-License-Identifier: MIT
// The reader of scene files, what write_scene makes of a scene that it accepts, and two steps of that.
#include <flotilla/scene_check.hpp>
#include <flotilla/scene_file.hpp>
#include <flotilla/world.hpp>

#include "fuzz/checks.hpp"

namespace {

using namespace flotilla;

/// Meshes that scenes name are those of the bench.
SceneDescription parse(const std::string& text) {
    return parse_scene(text, "scene.json", FLOTILLA_SOURCE_DIR "/bench/meshes");
}

void check_world(const SceneDescription& scene) {
    fuzz::check_steps(scene, 2);
    SceneDescription separated = scene;
    separated.settings.initial_overlap = InitialOverlap::separate;
    if (scene.bodies.size() > 8) return;
    try {
        const World world(separated, "scene.json", {.threads = 1});
        const World again(separated, world.snapshot(), "scene.json", {.threads = 1});
        fuzz::require(world.state_hash() == again.state_hash(), "a snapshot gives the same state");
    } catch (const OverlapError&) { // nothing frees them
    }
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SceneDescription scene;
    const std::string text = fuzz::text_of(data, size);
    if (!fuzz::accepted("scene.json", [&] { scene = parse(text); })) return 0;
    const std::string once = fuzz::written(scene);
    const SceneDescription again = parse(once);
    fuzz::require(fuzz::written(again) == once, "a written scene reads back to the same");
    fuzz::require(again.settings == scene.settings, "a written scene has the same settings");
    if (fuzz::accepted("scene.json", [&] { (void)check_scene(scene, "scene.json"); })) check_world(scene);
    return 0;
}
