// SPDX-License-Identifier: MIT
// Momentum of a free system, and equal bits from equal scenes.
#include "base/rotation.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

/// Bodies without gravity that all fly towards the middle, spinning.
SceneDescription imploding_cluster() {
    SceneDescription scene = empty_scene();
    scene.gravity = {};
    const std::int32_t shapes[] = {add_shape(scene, make_box(1, 0.7, 0.4), 3), add_shape(scene, make_plate(1, 1), 1),
                                   add_shape(scene, make_ring(0.6, 0.15, 10, 6), 2)};
    int k = 0;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z, ++k) {
                const Vec3 place{2.0 * x + 0.05 * y, 2.0 * y - 0.03 * z, 2.0 * z + 0.07 * x};
                BodyDescription& body = add_body(scene, shapes[k % 3], BodyType::dynamic, place, 0.3, 0.5);
                body.rotation = rotation_from_vector({0.3 * k, 0.2 * x, -0.1 * y});
                body.velocity = -1.0 * place + Vec3{0.3, -0.2, 0.1};
                body.angular_velocity = {0.5 * x, 0.3 * y, 0.7 * z};
            }
    return scene;
}

// And its centre of mass goes where that says, whatever of a blow within a step is late for some bodies of it.
TEST(Conservation, FreeClusterKeepsLinearMomentum) {
    const SceneDescription scene = imploding_cluster();
    World world(scene);
    double scale = 0; // kg m/s, sum of the magnitudes that the total is rounded from
    Vec3 momentum;
    const auto mass = [&](std::size_t i) {
        return scene.shapes[static_cast<std::size_t>(scene.bodies[i].shape)].mass_value;
    };
    double all = 0; // kg
    for (std::size_t i = 0; i < world.size(); ++i) all += mass(i);
    const auto center = [&] {
        Vec3 sum;
        for (std::size_t i = 0; i < world.size(); ++i) sum += (mass(i) / all) * world.body(i).center_of_mass;
        return sum;
    };
    for (std::size_t i = 0; i < world.size(); ++i) {
        momentum += mass(i) * world.body(i).velocity;
        scale += mass(i) * length(world.body(i).velocity);
    }
    RunTotals totals;
    double worst = 0, strayed = 0; // of the momentum; m
    int quiet = 0;
    for (int n = 0; n < 120; ++n) {
        const Vec3 before = center();
        const StepReport r = world.step();
        totals.add(r);
        if (r.merges + r.rung_changes == 0) {
            ++quiet;
            worst = std::max(worst, length(r.momentum - momentum) / scale);
            strayed = std::max(strayed, length(center() - before - (scene.settings.time_step / all) * momentum));
        }
        momentum = r.momentum; // a step with a failsafe event may change it, and reports so
    }
    std::printf("free cluster: %lld impulses, %d steps without failsafe, momentum changes by at most %.2g per step, "
                "the centre of mass strays by %.2g m\n",
                static_cast<long long>(totals.collisions), quiet, worst, strayed);
    EXPECT_GE(totals.collisions, 100);
    EXPECT_GE(quiet, 60);
    EXPECT_LE(worst, 1e-13);
    EXPECT_LE(strayed, 1e-13);
    EXPECT_EQ(count_intersections(scene, world), 0);
}

TEST(Conservation, EqualScenesGiveEqualBits) {
    SceneDescription scene = make_scene("boats-in-bowl", 12, 5);
    scene.settings.sleeping = false;
    World first(scene), second(scene);
    RunTotals totals;
    for (int n = 0; n < 60; ++n) {
        const StepReport r = first.step();
        totals.add(r);
        ASSERT_EQ(r.state_hash, second.step().state_hash) << "step " << n;
        ASSERT_EQ(first.state_hash(), second.state_hash());
    }
    EXPECT_GE(totals.collisions, 20);
    EXPECT_GE(totals.contacts, 20);
}

} // namespace
} // namespace flotilla::scenario
