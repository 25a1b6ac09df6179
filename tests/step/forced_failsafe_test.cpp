// SPDX-License-Identifier: MIT
// The failsafe alone: stage 1 and dynamic contact get no sweeps, or one, and nothing solves hits together.
#include "step/scenario.hpp"
#include "support/random.hpp"

namespace flotilla::scenario {
namespace {

/// Figure 9: a ball hits a stack of blocks.
SceneDescription ball_and_stack(Rigidification kind, int iterations) {
    SceneDescription scene = make_scene("stack", 9);
    scene.settings.sleeping = false;
    scene.settings.rigidification = kind;
    scene.settings.collision_iterations = iterations;
    scene.settings.dynamic_iterations = iterations;
    scene.settings.contact_solver = ContactSolver::pgs;
    const auto ball = add_shape(scene, make_sphere(0.6, 1), 800);
    add_body(scene, ball, BodyType::dynamic, {-3, 0.1, 3.2}).velocity = {12, 0, 0};
    return scene;
}

struct Outcome {
    RunTotals totals;
    double broken = 0;     ///< m, at figure 9's step: largest change of the distance of two neighbours in the stack
    double ball_speed = 0; ///< m/s, along x, at that step
    double torn = 0;       ///< m, largest change of such a distance in a step in which ball and stack were one cluster
    std::int64_t together = 0; ///< most bodies that moved as one cluster
};

constexpr std::size_t kBlocks = 8, kBall = 9; // the ground is 8
constexpr int kFigureStep = 13;

Outcome run_stack(Rigidification kind, int iterations, int steps) {
    const SceneDescription scene = ball_and_stack(kind, iterations);
    World world(scene);
    const auto neighbours = [&](std::size_t i) {
        return length(world.body(i + 1).center_of_mass - world.body(i).center_of_mass);
    };
    const auto distances = [&] {
        std::vector<double> all;
        for (std::size_t i = 0; i + 1 < kBlocks; ++i) all.push_back(neighbours(i));
        return all;
    };
    const auto most_changed = [](const std::vector<double>& a, const std::vector<double>& b) {
        double most = 0;
        for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
        return most;
    };
    const std::vector<double> start = distances();
    std::vector<double> before = start;
    Outcome out;
    for (int n = 0; n < steps; ++n) {
        const StepReport r = world.step();
        out.totals.add(r);
        out.together = std::max(out.together, r.largest_cluster);
        expect_ladder_bounds(r, world.size());
        EXPECT_EQ(count_intersections(scene, world), 0) << "step " << n;
        const std::vector<double> now = distances();
        if (r.largest_cluster == static_cast<std::int64_t>(kBlocks) + 1)
            out.torn = std::max(out.torn, most_changed(now, before));
        before = now;
        if (r.step != kFigureStep) continue;
        out.broken = most_changed(now, start);
        out.ball_speed = world.body(kBall).velocity.x;
    }
    return out;
}

// The paper's stack freezes because it becomes rigid together with the ground. Here clusters never take the ground in,
// and as section 5 says of that case the ball's momentum goes to the whole stack, which tips over as one body. With a
// sweep of collisions and one of dynamic contact the hits of the first steps are solved, and blocks slide on each other
// before the failsafe has anything to do: what it then moves as one it moves rigidly.
TEST(ForcedFailsafe, KinematicLetsAStackBreakUpAndRigidMovesItAsOne) {
    for (const int iterations : {0, 1}) {
        const Outcome kinematic = run_stack(Rigidification::kinematic, iterations, 36);
        const Outcome rigid = run_stack(Rigidification::rigid, iterations, 36);
        for (const Outcome* o : {&kinematic, &rigid})
            std::printf(
                "figure 9, limit %d, %s: neighbours moved apart by %.3f m, in a step as one by %.1e m, ball %.2f m/s, "
                "at most %lld bodies in a cluster, %lld merges, %lld rung changes\n",
                iterations, o == &rigid ? "rigid" : "kinematic", o->broken, o->torn, o->ball_speed,
                static_cast<long long>(o->together), static_cast<long long>(o->totals.merges),
                static_cast<long long>(o->totals.rung_changes));
        EXPECT_GE(kinematic.totals.merges, 10);
        EXPECT_GE(rigid.totals.merges, 5);
        EXPECT_EQ(rigid.together, 9); // ball and stack
        EXPECT_LT(rigid.torn, 1e-12);
        EXPECT_GT(kinematic.broken, 0.5);
        if (iterations > 0) continue;
        EXPECT_LT(rigid.broken, 0.1);
        EXPECT_LT(rigid.ball_speed, 0.6 * kinematic.ball_speed);
    }
}

void expect_no_energy_growth(std::uint64_t seed, int iterations) {
    SceneDescription scene = make_scene("boats-in-bowl", 52, seed);
    scene.settings.sleeping = false;
    scene.settings.collision_iterations = iterations;
    scene.settings.dynamic_iterations = iterations;
    scene.settings.contact_solver = ContactSolver::pgs;
    World world(scene);
    RunTotals totals;
    double last = 1e300, start = 0, growth = 0;
    for (int n = 0; n < 100; ++n) {
        const StepReport r = world.step();
        totals.add(r);
        expect_ladder_bounds(r, world.size());
        if (n == 0) start = r.energy;
        if (n > 0) growth = std::max(growth, r.energy - r.lift - last); // G5: what is booked as lift may come back
        last = r.energy - r.lift;
        if (n % 10 == 9) {
            ASSERT_EQ(count_intersections(scene, world), 0) << "step " << n;
        }
    }
    std::printf(
        "50 boats, seed %d, limit %d, failsafe in %lld of 100 steps: energy %.6g J to %.6g J, largest growth in a step "
        "%.3g J\n",
        static_cast<int>(seed), iterations, static_cast<long long>(totals.failsafe_steps), start, last, growth);
    EXPECT_GE(totals.failsafe_steps, iterations == 0 ? 50 : 10); // from a limit of 1 on dynamic contact may go on
    EXPECT_LT(growth, 1e-9 * start);
}

TEST(ForcedFailsafe, EnergyOfFiftyBoatsDoesNotGrow) {
    for (const std::uint64_t seed : {1u, 2u, 3u})
        for (const int iterations : {0, 1}) expect_no_energy_growth(seed, iterations);
}

std::int64_t count_merges(std::uint64_t seed, int limit) {
    SceneDescription scene = make_scene("boats-in-bowl", 52, seed);
    scene.settings.sleeping = false;
    scene.settings.collision_iterations = 2;
    scene.settings.dynamic_iterations = limit;
    scene.settings.contact_solver = ContactSolver::pgs;
    World world(scene);
    std::int64_t merges = 0;
    for (int n = 0; n < 80; ++n) merges += world.step().merges;
    return merges;
}

// 258 to 295 merges a seed where four sweeps were the end of dynamic contact. Where it goes on, 0 to 277 of ten seeds,
// 113 in the mean, by the order in which few boats meet.
TEST(ForcedFailsafe, DynamicContactGoesOnWhileFewerPairsHit) {
    constexpr int kSeeds = 10;
    std::int64_t merges = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const std::int64_t count = count_merges(seed, 4);
        std::printf("50 boats, seed %d, limit 4: %lld merges\n", static_cast<int>(seed), static_cast<long long>(count));
        merges += count;
    }
    EXPECT_GE(merges, 3 * kSeeds); // the failsafe is there
    EXPECT_LE(merges, 150 * kSeeds);
}

/// Blocks that fly into each other, nothing else there.
SceneDescription flying_blocks(std::uint64_t seed) {
    constexpr int kSide = 3;
    SceneDescription scene;
    scene.gravity = {};
    scene.settings.sleeping = false;
    scene.settings.collision_iterations = 0;
    scene.settings.dynamic_iterations = 1;
    scene.settings.contact_solver = ContactSolver::pgs;
    scene.settings.time_step = 1.0 / 24;
    scene.settings.seed = seed;
    const auto block = add_shape(scene, make_box(0.6, 0.4, 0.5), 800);
    test::Random random(seed);
    for (int x = 0; x < kSide; ++x)
        for (int y = 0; y < kSide; ++y)
            for (int z = 0; z < kSide; ++z) {
                const Vec3 at{x - 1.0, y - 1.0, z - 1.0};
                BodyDescription& body = add_body(scene, block, BodyType::dynamic, at);
                body.velocity = Vec3{1, 0, 0} - 12 * at + random.vec(1);
                body.angular_velocity = random.vec(12);
            }
    return scene;
}

// A merged cluster takes the motion that it made, which blocks around it gave impulses to that their velocities know
// nothing of.
TEST(ForcedFailsafe, MergesKeepTheMomentumOfAll) {
    std::int64_t merges = 0;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        World world(flying_blocks(seed));
        const Vec3 start = world.step().momentum;
        double changed = 0;
        for (int n = 0; n < 24; ++n) {
            const StepReport r = world.step();
            merges += r.merges;
            EXPECT_EQ(r.held, 0);
            changed = std::max(changed, length(r.momentum - start));
        }
        std::printf("27 blocks, seed %d: momentum of %.3g kg m/s changed by %.2g of it\n", static_cast<int>(seed),
                    length(start), changed / length(start));
        EXPECT_LT(changed, 1e-12 * length(start));
    }
    EXPECT_GE(merges, 8);
}

} // namespace
} // namespace flotilla::scenario
