// SPDX-License-Identifier: MIT
// Piles of boats in a bowl come to rest in every preset.
#include "physics/physics.hpp"

namespace flotilla::physics {
namespace {

/// A boat alone may slide or spin for longer than `time`: friction of 0.1 takes little away.
void pile_rests(const std::string& preset, int bodies, std::uint64_t seed, double time = 8.3) {
    SceneDescription scene = make_scene("boats-in-bowl", bodies, seed);
    scene.settings = Run{preset, 24}.settings();
    Motion motion(scene);
    motion.run(time);
    std::size_t fastest = 0;
    for (std::size_t i = 0; i < motion.world().size(); ++i)
        if (length(motion.body(i).velocity) > length(motion.body(fastest).velocity)) fastest = i;
    motion.print("fastest is body %zu", fastest);
    expect_rest(motion);
    expect_no_rise(motion);
    EXPECT_EQ(motion.outcome().held, 0);
}

[[maybe_unused]] const bool registered = [] {
    for (const char* preset : {"balanced", "accurate", "reference"}) {
        const auto add = [&](int bodies, std::uint64_t seed, Slice slice) {
            add_test("Piles", std::string(preset) + "_boats" + std::to_string(bodies) + "_seed" + std::to_string(seed),
                     slice, [=, preset = std::string(preset)] { pile_rests(preset, bodies, seed); });
        };
        add_test("Piles", std::string(preset) + "_boats22_seed0",
                 preset == std::string("balanced") ? Slice::fast : Slice::full,
                 [preset = std::string(preset)] { pile_rests(preset, 22, 0, 12.5); });
        for (std::uint64_t seed = 0; seed < 10; ++seed) add(102, seed, Slice::full);
        add(252, 1, Slice::full);
    }
    return true;
}();

} // namespace
} // namespace flotilla::physics
