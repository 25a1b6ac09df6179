// SPDX-License-Identifier: MIT
// Snapshots of an edited World, whose edited part holds bodies, shapes and names: with bytes changed, taken out or put
// in, and a hash that fits. A World takes them up and goes on, or refuses them.
#include <cstring>
#include <vector>

#include <flotilla/world.hpp>

#include "base/hasher.hpp"
#include "fuzz/checks.hpp"
#include "fuzz/input.hpp"
#include "fuzz/small_scene.hpp"

namespace {

using namespace flotilla;
using Bytes = std::vector<std::byte>;

/// Of every kind that a snapshot holds; some wait for the step that comes.
World edited_world(const SceneDescription& scene) {
    World world(scene, "scene", {.threads = 1});
    ShapeDescription tile;
    tile.name = "tile";
    tile.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    tile.triangles = {{0, 1, 2}};
    tile.mass_kind = MassKind::mass;
    tile.mass_value = 2;
    BodyDescription body;
    body.shape = world.add_shape(tile);
    body.name = "tile";
    body.position = {-2, 0, 0.5};
    body.group = "tiles";
    const BodyId added = world.add_body(body);
    world.set_user_data(added, 7);
    (void)world.step();
    world.remove_body(world.find("lid"));
    world.ignore_groups("tiles", "boxes");
    world.ignore_pair(added, world.find("high"));
    world.set_force(world.find("high"), {0, 1, 0}, {0, 0, 0.1});
    world.set_gravity({0, 0, -5});
    (void)world.step();
    world.set_pose(added, {-2, 0.2, 0.7}, {});
    world.apply_force(added, {1, 0, 0}, {-2, 0.3, 0.7});
    return world;
}

constexpr std::size_t kHash = 16, kSize = 24, kEdited = 32; ///< bytes before the hash, the size and the edited part

std::uint64_t word(const Bytes& bytes, std::size_t at) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

void change(fuzz::Input& input, Bytes& edited) {
    const std::size_t at = edited.empty() ? 0 : input.take<std::uint16_t>() % edited.size();
    const auto place = edited.begin() + static_cast<std::ptrdiff_t>(at);
    switch (input.below(5)) {
    case 0: edited.insert(place, 8, std::byte{input.take<std::uint8_t>()}); break;
    case 1: edited.resize(at); break;
    case 2: { // sizes of lists are among the words
        const auto value = static_cast<std::uint64_t>(input.take<std::uint16_t>());
        if (at + sizeof value <= edited.size()) std::memcpy(edited.data() + at, &value, sizeof value);
        break;
    }
    case 3: {
        const auto value = input.take<double>();
        if (at + sizeof value <= edited.size()) std::memcpy(edited.data() + at, &value, sizeof value);
        break;
    }
    default:
        if (!edited.empty()) *place = std::byte{input.take<std::uint8_t>()};
    }
}

Bytes joined(const Bytes& whole, const Bytes& edited, std::size_t state) {
    Hasher hasher;
    for (const std::byte b : edited) hasher.add(static_cast<std::uint64_t>(b));
    const std::uint64_t hash = hasher.value(), size = edited.size();
    Bytes out(whole.begin(), whole.begin() + kEdited);
    std::memcpy(out.data() + kHash, &hash, sizeof hash);
    std::memcpy(out.data() + kSize, &size, sizeof size);
    out.insert(out.end(), edited.begin(), edited.end());
    out.insert(out.end(), whole.begin() + static_cast<std::ptrdiff_t>(state), whole.end());
    return out;
}

void go_on(const SceneDescription& scene, const Bytes& bytes) {
    World world(scene, bytes, "snapshot", {.threads = 1});
    const Bytes once = world.snapshot();
    const World again(scene, once, "snapshot", {.threads = 1});
    fuzz::require(again.snapshot() == once, "a World writes what it read");
    try {
        (void)world.step();
    } catch (const BrokenPromise&) { // bodies that were put into each other
    }
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const SceneDescription scene = fuzz::small_pile();
    static const Bytes whole = edited_world(scene).snapshot();
    const std::size_t state = kEdited + word(whole, kSize);
    Bytes edited(whole.begin() + kEdited, whole.begin() + static_cast<std::ptrdiff_t>(state));
    fuzz::Input input(data, size);
    for (int i = 0; i < 8 && !input.empty(); ++i) change(input, edited);
    fuzz::accepted("snapshot", [&] { go_on(scene, joined(whole, edited, state)); });
    return 0;
}
