// SPDX-License-Identifier: MIT
// Runs with `trajectory: rigid`: the audit follows the turning paths themselves.
#include "step/audited_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(RigidTrajectory, SpinningBoatsStayApartOnTheirTurningPaths) {
    SceneDescription scene = make_scene("boats-in-bowl", 12, 5);
    scene.settings.sleeping = false;
    scene.settings.trajectory = Trajectory::rigid;
    for (std::size_t i = 0; i < 10; ++i) { // 10 .. 55 rad/s
        const double s = 10 + 5 * static_cast<double>(i);
        scene.bodies[i].angular_velocity = i % 2 == 0 ? Vec3{0.6 * s, 0, 0.8 * s} : Vec3{0, -0.8 * s, 0.6 * s};
    }
    AuditedRun run(scene);
    for (int n = 0; n < 48; ++n) expect_ladder_bounds(run.step(), scene.bodies.size());
    const QueryCounters& queries = run.stepper().query_counters();
    std::printf(
        "%lld collisions, %lld merges, %lld held; largest turn %.2f rad; %lld segments in %lld queries; %lld triangle "
        "pairs audited\n",
        static_cast<long long>(run.totals.collisions), static_cast<long long>(run.totals.merges),
        static_cast<long long>(run.totals.held), run.largest_turn, static_cast<long long>(queries.segments),
        static_cast<long long>(queries.pair_queries), static_cast<long long>(run.audited_pairs));
    EXPECT_EQ(run.findings, 0u);
    EXPECT_GE(run.totals.collisions, 100);
    EXPECT_GE(run.largest_turn, 2);
    EXPECT_GE(queries.segments, 1000);
    EXPECT_GE(run.audited_pairs, 1000);
}

/// A plate that turns several times in a step, thrown on the ground.
TEST(RigidTrajectory, PlateOfSeveralTurnsAStepStaysAboveTheGround) {
    for (const double speed : {5.0, 500.0}) {
        SceneDescription scene = make_scene("fast-plate");
        scene.settings.sleeping = false;
        scene.settings.trajectory = Trajectory::rigid;
        scene.bodies[0].velocity = {0, 0, -speed};
        scene.bodies[0].angular_velocity = {300, 180, -90}; // of its turns a hit at 500 m/s may leave half
        AuditedRun run(scene);
        for (int n = 0; n < 24; ++n) {
            run.step();
            const Vec3 p = run.stepper().state().pose[0].com;
            if (std::abs(p.x) < 4 && std::abs(p.y) < 4) {
                ASSERT_GT(p.z, 0) << "speed " << speed << ", step " << n;
            }
        }
        EXPECT_EQ(run.findings, 0u) << "speed " << speed;
        EXPECT_GE(run.totals.collisions, 1);
        EXPECT_GE(run.largest_turn, 2 * kPi);
    }
}

/// The failsafe alone: clusters that turn move their members' centres straight.
TEST(RigidTrajectory, ForcedFailsafeKeepsMembersOfTurningClustersApart) {
    for (const auto rigidification : {Rigidification::kinematic, Rigidification::rigid}) {
        SceneDescription scene = make_scene("boats-in-bowl", 10, 2);
        scene.settings.sleeping = false;
        scene.settings.trajectory = Trajectory::rigid;
        scene.settings.rigidification = rigidification;
        scene.settings.collision_iterations = scene.settings.dynamic_iterations = 0;
        for (std::size_t i = 0; i < 8; ++i) scene.bodies[i].angular_velocity = {3, -2, 1};
        AuditedRun run(scene);
        for (int n = 0; n < 40; ++n) expect_ladder_bounds(run.step(), scene.bodies.size());
        std::printf("%lld merges, %lld rung changes\n", static_cast<long long>(run.totals.merges),
                    static_cast<long long>(run.totals.rung_changes));
        EXPECT_EQ(run.findings, 0u);
        EXPECT_GE(run.totals.merges, 10);
    }
}

TEST(RigidTrajectory, AccuratePresetComesToRest) {
    constexpr int kSteps = 200, kQuiet = 180; // a boat of its own slides for 7 s, with 16 and 64 substeps as well
    SceneDescription scene = make_scene("boats-in-bowl", 8, 1);
    scene.settings = preset("accurate");
    AuditedRun run(scene);
    double fastest = 0;
    StepReport last;
    for (int n = 0; n < kSteps; ++n) {
        last = run.step();
        if (n < kQuiet) continue;
        for (std::size_t i = 0; i < 6; ++i)
            fastest = std::max(fastest, length(run.stepper().state().motion[i].velocity));
    }
    std::printf("fastest %.3g m/s, %lld contacts, %lld collisions, smallest distance %.3g m\n", fastest,
                static_cast<long long>(last.contacts), static_cast<long long>(run.totals.collisions),
                last.min_distance);
    EXPECT_EQ(run.findings, 0u);
    EXPECT_LT(fastest, 0.05);
    EXPECT_GE(last.contacts, 18);
    EXPECT_GE(run.totals.collisions, 50);
}

} // namespace
} // namespace flotilla::scenario
