// SPDX-License-Identifier: MIT
// Clusters of the failsafe where coordinates are as coarse as the bodies' gaps: what moves in common does not keep its
// gaps there.
#include "step/audited_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(FarCluster, MembersStayApartWhereCoordinatesAreAsCoarseAsTheirGaps) {
    const double size = 1e-5, far = 9e8; // m; the rest distance is a quarter of a unit of the last place
    SceneDescription scene = empty_scene();
    scene.settings.time_step = 2e-4;
    const auto floor = add_shape(scene, make_box(20 * size, 20 * size, size));
    const auto cube = add_shape(scene, make_box(size, size, size), 1);
    add_body(scene, floor, BodyType::fixed, {0, 0, -size / 2});
    for (int i = 0; i < 3; ++i) add_body(scene, cube, BodyType::dynamic, {0.1 * i * size, 0, (0.55 + 1.1 * i) * size});
    AuditedRun run(scene, {far, far, far});
    for (int n = 0; n < 100; ++n) run.step();
    EXPECT_EQ(run.findings, 0u);
    EXPECT_GT(run.totals.merges, 0);
}

} // namespace
} // namespace flotilla::scenario
