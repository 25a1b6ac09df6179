// SPDX-License-Identifier: MIT
// Files of edits of a small scene. What was read is written and read again to the same, and made of a World before and
// between its first steps: an edit is made or refused, every step keeps its promise, and a snapshot of the edited
// World goes on with the same bits.
#include <sstream>

#include <flotilla/edit_file.hpp>
#include <flotilla/world.hpp>

#include "fuzz/checks.hpp"
#include "fuzz/small_scene.hpp"

namespace {

using namespace flotilla;

constexpr std::int64_t kSteps = 2;
constexpr std::size_t kMostEdits = 16, kMostTriangles = 100; // of a step, and of a shape that comes

std::string written_edits(const std::vector<Edit>& edits, const SceneDescription& scene) {
    std::ostringstream out;
    write_edits(out, edits, scene);
    return out.str();
}

bool is_small(const Edit& edit) {
    const auto* shape = std::get_if<edits::AddShape>(&edit.change);
    return shape == nullptr || shape->shape.triangles.size() <= kMostTriangles;
}

/// What cannot be done is refused, and then nothing has changed.
void make(World& world, const Edit& edit) {
    const std::uint64_t before = world.state_hash();
    try {
        (void)world.apply(edit);
        return;
    } catch (const InputError&) {
    } catch (const OverlapError&) {
    }
    fuzz::require(world.state_hash() == before, "a refused edit changes nothing");
}

void go_on(World& world, const SceneDescription& scene) {
    World again(scene, world.snapshot(), "scene", {.threads = 1});
    fuzz::require(again.state_hash() == world.state_hash(), "a snapshot of an edited World has its state");
    const std::uint64_t hash = world.step().state_hash;
    fuzz::require(again.step().state_hash == hash, "a snapshot of an edited World goes on with its bits");
}

void make_all(const std::vector<Edit>& edits, const SceneDescription& scene) {
    World world(scene, "scene", {.threads = 1});
    for (std::int64_t step = 0; step < kSteps; ++step) {
        std::size_t made = 0;
        for (const Edit& edit : edits)
            if (edit.step == step && is_small(edit) && ++made <= kMostEdits) make(world, edit);
        go_on(world, scene);
    }
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const SceneDescription scene = fuzz::small_pile();
    std::vector<Edit> edits;
    const auto parse = [](const std::string& text) {
        return parse_edits(text, "edits.json", FLOTILLA_SOURCE_DIR "/bench/meshes", scene);
    };
    if (!fuzz::accepted("edits.json", [&] { edits = parse(fuzz::text_of(data, size)); })) return 0;
    const std::string once = written_edits(edits, scene);
    fuzz::require(written_edits(parse(once), scene) == once, "written edits read back to the same");
    make_all(edits, scene);
    return 0;
}
