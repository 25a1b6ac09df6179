// SPDX-License-Identifier: MIT
// Figure 14: a block between two cylinders that two planes press together, held by friction alone.
#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kSlope = 60 * kPi / 180; // of both planes
constexpr double kRadius = 1, kSide = 1;  // m, of the cylinders and of the block
constexpr double kEnough = 0.1;           // m, of sinking to call it slip

// With all masses equal, from the balance of forces and torques: the least coefficients between cylinder and block and
// between cylinder and plane. Rolling without slip at all four contacts leaves one force, so the two conditions are
// necessary and together sufficient.
const double kLeastBlock = 1 / (2 * std::tan(kSlope) + (1 + std::sin(kSlope)) / std::cos(kSlope));
const double kLeastPlane = std::cos(kSlope) / (3 + std::sin(kSlope));

struct Outcome {
    double sunk = 0;                ///< m, by how much the block came down, in 10 s or until kEnough
    double fastest = 0;             ///< m/s, of any body in the last second
    std::int64_t contacts = 100000; ///< fewest of a step
};

Outcome pinch(double block_friction, double plane_friction) {
    Settings settings = preset("accurate");
    settings.trajectory = Trajectory::linear;
    SceneDescription scene = empty_scene(settings);
    const auto block = add_shape(scene, make_box(kSide, kSide, kSide), 100);
    // Of so many sides that the pressure's way across one of them, which resists rolling, changes the thresholds by 2 %
    // only.
    const auto cylinder = add_shape(scene, make_tube(kRadius, kSide, 720), 100);
    const auto plane = add_shape(scene, make_plate(8, 8));
    scene.settings.rest_distance = 2e-4;
    const double gap = 1.0001 * scene.settings.rest_distance;
    // A pair's friction is the geometric mean; the cylinders have 1.
    add_body(scene, block, BodyType::dynamic, {}, block_friction * block_friction, 0);
    for (const double side : {-1.0, 1.0}) {
        const Vec3 center{side * (kSide / 2 + gap + kRadius), 0, 0};
        add_body(scene, cylinder, BodyType::dynamic, center, 1, 0).rotation = rotation_from_vector({kPi / 2, 0, 0});
        const Vec3 up{-side * std::sin(kSlope), 0, std::cos(kSlope)}; // from the plane
        add_body(scene, plane, BodyType::fixed, center - (kRadius + gap) * up, plane_friction * plane_friction, 0)
            .rotation = rotation_from_vector({0, -side * kSlope, 0});
    }
    World world(scene);
    Outcome out;
    for (int n = 0; n < 240 && out.sunk < kEnough; ++n) {
        const StepReport r = world.step();
        out.contacts = std::min(out.contacts, r.contacts);
        out.sunk = -world.body(0).center_of_mass.z;
        if (n < 216) continue;
        for (const std::size_t i : {0u, 1u, 3u}) out.fastest = std::max(out.fastest, length(world.body(i).velocity));
    }
    EXPECT_EQ(count_intersections(scene, world), 0);
    std::printf("block %.3f, plane %.3f of the threshold: sunk %.3g m, fastest %.3g m/s, at least %lld contacts\n",
                block_friction / kLeastBlock, plane_friction / kLeastPlane, out.sunk, out.fastest,
                static_cast<long long>(out.contacts));
    return out;
}

TEST(PinchedBlock, HoldsAboveTheThresholdAndSlipsBelow) {
    const Outcome holds = pinch(1.05 * kLeastBlock, 1.05 * kLeastPlane);
    EXPECT_GE(holds.contacts, 8);
    EXPECT_LT(holds.sunk, 1e-3);
    EXPECT_LT(holds.fastest, 1e-4);
    EXPECT_GT(pinch(0.95 * kLeastBlock, 2 * kLeastPlane).sunk, kEnough);
    EXPECT_GT(pinch(2 * kLeastBlock, 0.95 * kLeastPlane).sunk, kEnough);
}

} // namespace
} // namespace flotilla::scenario
