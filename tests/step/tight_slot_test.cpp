// SPDX-License-Identifier: MIT
// A cube in one step over the mouth of a slot that leaves less than a rest distance on either side of it. No velocity
// brings it to the rest distance from both walls; it is held by none of them (Stepper::slow_down).
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kEdge = 0.5, kSpeed = 2;                  // m, m/s
const double kRestDistance = std::sqrt(3.0) * kEdge / 330; // m

void expect_way_through(const Settings& settings, double play, double friction) {
    SceneDescription scene = empty_scene(settings);
    scene.gravity = {};
    const auto cube = add_shape(scene, make_box(kEdge, kEdge, kEdge), 125);
    const auto wall = add_shape(scene, make_box(6, 2, 0.2));
    for (const double side : {-1, 1})
        add_body(scene, wall, BodyType::fixed, {3.5, 0, side * (0.5 * kEdge + play * kRestDistance + 0.1)}, friction,
                 0);
    add_body(scene, cube, BodyType::dynamic, {-0.3, 0, 0}, friction, 0).velocity = {kSpeed, 0, 0};
    World world(scene);
    std::int64_t held = 0;
    for (int n = 0; n < 40; ++n) held += world.step().held;
    const BodyState s = world.body(2);
    EXPECT_EQ(held, 0);
    EXPECT_NEAR(s.position.x, -0.3 + kSpeed * 40 * settings.time_step, 1e-3);
    EXPECT_NEAR(s.velocity.x, kSpeed, 1e-4);
}

TEST(TightSlot, HoldsNothing) {
    for (const char* name : {"preview", "balanced"})
        for (const double play : {0.1, 0.2, 0.5})
            for (const double friction : {0.0, 0.5}) {
                SCOPED_TRACE(testing::Message() << name << ", play " << play << ", friction " << friction);
                expect_way_through(preset(name), play, friction);
            }
}

} // namespace
} // namespace flotilla::scenario
