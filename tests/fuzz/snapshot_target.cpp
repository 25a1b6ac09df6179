// SPDX-License-Identifier: MIT
// Snapshots: bytes as they are, a whole one with some words changed, or that of a state with some parts changed and a
// hash that fits. A World takes them up and goes on, or refuses them.
#include <flotilla/world.hpp>

#include <array>
#include <vector>

#include "fuzz/checks.hpp"
#include "fuzz/input.hpp"
#include "fuzz/small_scene.hpp"
#include "state/build_model.hpp"
#include "state/snapshot.hpp"
#include "step/stepper.hpp"

namespace {

using namespace flotilla;

struct Start {
    SceneDescription description = fuzz::small_pile();
    Model model = make_model(build_scene(description));
    State state = initial_state(build_scene(description), model);
    std::uint64_t scene = scene_hash(model, state);

    Start() {
        Stepper stepper(model, state, {});
        for (int i = 0; i < 4; ++i) (void)stepper.step();
        state = stepper.state();
    }
};

/// Arrays of an element per body keep their size: the hash could not be written otherwise.
template <class T>
void change(fuzz::Input& input, std::vector<T>& values, bool may_resize = false) {
    if (input.below(4) == 0 && may_resize) return values.resize(input.below(9));
    if (values.empty()) return;
    auto* bytes = reinterpret_cast<unsigned char*>(values.data() + input.below(values.size()));
    const std::size_t at = 4 * input.below(sizeof(T) / 4);
    for (std::size_t i = 0; i < std::min<std::size_t>(8, sizeof(T) - at); ++i)
        bytes[at + i] = input.take<std::uint8_t>();
}

void change(fuzz::Input& input, State& s) {
    switch (input.below(14)) {
    case 0: s.step = input.take<std::int64_t>(); break;
    case 1: s.time = input.take<double>(); break;
    case 2: change(input, s.pose); break;
    case 3: change(input, s.motion); break;
    case 4: change(input, s.sleep); break;
    case 5: change(input, s.script_clock); break;
    case 6: change(input, s.lift); break;
    case 7: change(input, s.rest_distances, true); break;
    case 8: change(input, s.warm[ContactStage::kept], true); break;
    case 9: change(input, s.warm[ContactStage::final], true); break;
    case 10: change(input, s.waiting[ContactStage::half], true); break;
    case 11: change(input, s.squeezed, true); break;
    case 12: change(input, s.searched); break;
    default: change(input, s.earlier, true); break;
    }
}

std::vector<std::byte> raw(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// A number at one of the first places of 8 bytes: sizes of arrays are among them.
void change_word(fuzz::Input& input, std::vector<std::byte>& bytes) {
    const std::size_t at = 8 * (input.take<std::uint16_t>() % (bytes.size() / 8));
    const auto value = static_cast<std::uint64_t>(input.take<std::uint16_t>());
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

void go_on(const SceneDescription& scene, std::span<const std::byte> bytes) {
    World world(scene, bytes, "scene", {.threads = 1});
    const std::vector<std::byte> once = world.snapshot();
    const World again(scene, once, "scene", {.threads = 1});
    fuzz::require(again.snapshot() == once, "a World writes what it read");
    try {
        for (int i = 0; i < 2; ++i) (void)world.step();
    } catch (const BrokenPromise&) { // bodies that were put into each other
    }
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const Start start;
    fuzz::Input input(data, size);
    std::vector<std::byte> bytes;
    switch (input.below(3)) {
    case 0: bytes = raw(input.remaining()); break;
    case 1: {
        State state = start.state;
        for (int i = 0; i < 8 && !input.empty(); ++i) change(input, state);
        bytes = write_snapshot(state, start.scene);
        break;
    }
    default:
        bytes = write_snapshot(start.state, start.scene);
        for (int i = 0; i < 8 && !input.empty(); ++i) change_word(input, bytes);
    }
    fuzz::accepted("snapshot", [&] { go_on(start.description, bytes); });
    return 0;
}
