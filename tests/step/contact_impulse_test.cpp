// SPDX-License-Identifier: MIT
// The impulses of contact points: those at a body at rest carry its weight.
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kMass = 3; // kg
constexpr double kFriction = 0.5;
const double kPyramid = std::sqrt(2.0); ///< friction is bounded by a pyramid around the cone

/// A block of edge 1 on a large plate that is tilted about the y axis by `slope` (rad).
SceneDescription block_on_slope(double slope) {
    SceneDescription scene = empty_scene();
    const auto block = add_shape(scene, make_box(1, 1, 1), kMass);
    const auto plate = add_shape(scene, make_box(20, 20, 1));
    const SinCos s = sin_cos(slope), half = sin_cos(0.5 * slope);
    const Vec3 up{s.sin, 0, s.cos};
    add_body(scene, block, BodyType::dynamic, (0.5 + 1e-4) * up, kFriction, 0).rotation = {half.cos, 0, half.sin, 0};
    add_body(scene, plate, BodyType::fixed, -0.5 * up, kFriction, 0).rotation = {half.cos, 0, half.sin, 0};
    return scene;
}

/// What the contacts did to body 0 in the last step, N s.
Vec3 impulse_on_block(const World& world) {
    Vec3 sum;
    for (const ContactState& c : world.contacts()) sum += c.body_a == 0 ? -c.impulse : c.impulse;
    return sum;
}

TEST(ContactImpulse, ThoseOfARestingBlockCarryItsWeight) {
    for (const double slope : {0.0, 0.2}) {
        SceneDescription scene = block_on_slope(slope);
        scene.settings.tangents = Tangents::aligned;
        const Vec3 up{sin_cos(slope).sin, 0, sin_cos(slope).cos};
        World world(scene);
        const double weight = kMass * kGravity * world.settings().time_step; // N s in a step
        for (int i = 0; i < 60; ++i) {
            (void)world.step();
            if (i < 20) continue;
            EXPECT_NEAR(length(impulse_on_block(world) - Vec3{0, 0, weight}), 0, 0.01 * weight) << "slope " << slope;
            double normal = 0;
            for (const ContactState& c : world.contacts()) {
                const double along = dot(c.impulse, c.normal), across = length(c.impulse - along * c.normal);
                EXPECT_GE(along, 0);
                EXPECT_LE(across, kPyramid * kFriction * along + 1e-9 * weight);
                normal += along;
            }
            EXPECT_NEAR(normal, weight * up.z, 0.01 * weight) << "slope " << slope;
        }
        EXPECT_LT(length(world.body(0).velocity), 1e-3) << "the block slides";
        std::printf("slope %g: impulse %.6g N s, weight times time step %.6g N s\n", slope,
                    length(impulse_on_block(world)), weight);
    }
}

TEST(ContactImpulse, ThereIsNoneBeforeTheFirstStep) {
    const World world(block_on_slope(0));
    EXPECT_FALSE(world.contacts().empty());
    EXPECT_EQ(impulse_on_block(world), Vec3{});
}

} // namespace
} // namespace flotilla::scenario
