// SPDX-License-Identifier: MIT
// Steps that are made of inner ones: the motion of that many shorter steps, in reports and frames of the step.
#include <algorithm>

#include <flotilla/error.hpp>

#include "step/scenario.hpp"
#include "step/thread_scenes.hpp"

namespace flotilla::scenario {
namespace {

constexpr int kSubsteps = 3;

SceneDescription in_substeps(SceneDescription scene, int substeps = kSubsteps) {
    scene.settings.substeps = substeps;
    return scene;
}
SceneDescription in_short_steps(SceneDescription scene) {
    scene.settings.time_step /= kSubsteps;
    return scene;
}

/// What a step is to report whose inner steps report `parts`.
void expect_report_of(const StepReport& step, const std::vector<StepReport>& parts) {
    const auto sum = [&](auto StepReport::*field) {
        auto total = decltype(step.*field){} + parts[0].*field;
        for (std::size_t k = 1; k < parts.size(); ++k) total += parts[k].*field;
        return total;
    };
    const auto most = [&](auto StepReport::*field) {
        auto largest = parts[0].*field;
        for (const StepReport& part : parts) largest = std::max(largest, part.*field);
        return largest;
    };
    for (const auto field : {&StepReport::pairs, &StepReport::collisions, &StepReport::iterations, &StepReport::merges,
                             &StepReport::rung_changes, &StepReport::energy_corrections})
        EXPECT_EQ(step.*field, sum(field));
    for (const auto field :
         {&StepReport::held, &StepReport::kinematic_bodies, &StepReport::rigid_bodies, &StepReport::largest_cluster})
        EXPECT_EQ(step.*field, most(field));
    EXPECT_EQ(step.residual, most(&StepReport::residual));
    EXPECT_DOUBLE_EQ(step.energy_removed, sum(&StepReport::energy_removed));
    const StepReport& last = parts.back();
    for (const auto field : {&StepReport::contacts, &StepReport::sleeping, &StepReport::sleeping_contacts,
                             &StepReport::proximities, &StepReport::pruned_angle})
        EXPECT_EQ(step.*field, last.*field);
    for (const auto field : {&StepReport::energy, &StepReport::kinetic_energy, &StepReport::lift})
        EXPECT_EQ(step.*field, last.*field);
    std::uint32_t warnings = 0;
    double nearest = parts[0].min_distance;
    for (const StepReport& part : parts) warnings |= part.warnings, nearest = std::min(nearest, part.min_distance);
    EXPECT_EQ(step.warnings, warnings);
    EXPECT_EQ(step.min_distance, nearest);
    EXPECT_EQ(step.state_hash, last.state_hash);
}

void expect_way(const World& world, const std::vector<std::vector<WayPoint>>& places) {
    for (std::size_t i = 0; i < world.size(); ++i) {
        const std::vector<WayPoint> way = world.way(i);
        ASSERT_EQ(way.size(), places.size());
        for (std::size_t k = 0; k < way.size(); ++k) {
            EXPECT_EQ(way[k].position, places[k][i].position);
            EXPECT_EQ(way[k].rotation, places[k][i].rotation);
            EXPECT_EQ(way[k].turn, places[k][i].turn);
        }
        EXPECT_EQ(way.back().position, world.body(i).position);
        EXPECT_EQ(way.back().turn, world.turn(i));
    }
}

class Substeps : public testing::TestWithParam<ThreadScene> {};

TEST_P(Substeps, MakeTheMotionOfThatManyShorterSteps) {
    const SceneDescription scene = GetParam().make(false);
    World whole(in_substeps(scene), "scene", {2}), parts(in_short_steps(scene), "scene", {1});
    for (int n = 1; n <= 2 * GetParam().fast_steps / 3; ++n) {
        const StepReport step = whole.step();
        std::vector<StepReport> reports;
        std::vector<std::vector<WayPoint>> places;
        for (int k = 0; k < kSubsteps; ++k) {
            reports.push_back(parts.step());
            places.emplace_back();
            for (std::size_t i = 0; i < parts.size(); ++i) places.back().push_back(parts.way(i).back());
        }
        expect_report_of(step, reports);
        expect_way(whole, places);
        EXPECT_EQ(step.step, n);
        EXPECT_EQ(whole.steps(), n);
        EXPECT_EQ(whole.time(), n * scene.settings.time_step);
        EXPECT_EQ(step.time, whole.time());
        if (testing::Test::HasFailure()) FAIL() << "step " << n;
    }
}

TEST_P(Substeps, GoOnFromASnapshotWithTheSameBits) {
    const SceneDescription scene = in_substeps(GetParam().make(false));
    World whole(scene);
    for (int n = 0; n < 4; ++n) (void)whole.step();
    World rest(scene, whole.snapshot());
    EXPECT_EQ(rest.steps(), 4);
    for (int n = 0; n < 4; ++n) EXPECT_EQ(rest.step().state_hash, whole.step().state_hash);
    EXPECT_EQ(rest.snapshot(), whole.snapshot());
}

INSTANTIATE_TEST_SUITE_P(Scenes, Substeps, testing::ValuesIn(thread_scenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

/// A block that lies on a plate.
SceneDescription resting_block() {
    SceneDescription scene = empty_scene();
    add_body(scene, add_shape(scene, make_box(1, 1, 1), 3), BodyType::dynamic, {0, 0, 0.5 + 1e-3}, 0.5, 0);
    add_body(scene, add_shape(scene, make_box(20, 20, 1)), BodyType::fixed, {0, 0, -0.5}, 0.5, 0);
    return scene;
}

TEST(SubstepsOf, ContactImpulsesOverTheTimeStepAreForces) {
    World world(in_substeps(resting_block(), 4));
    for (int n = 0; n < 40; ++n) (void)world.step();
    Vec3 sum;
    for (const ContactState& c : world.contacts()) sum += c.body_a == 0 ? -c.impulse : c.impulse;
    EXPECT_NEAR(sum.z / world.settings().time_step, 3 * kGravity, 0.01 * 3 * kGravity);
}

/// A block on a lift that accelerates upwards by a keyframe a step: what its contacts carried in a step raised it.
TEST(SubstepsOf, ContactImpulsesAreThoseOfAllOfThem) {
    constexpr double kLift = 2; // m/s^2
    SceneDescription scene = in_substeps(resting_block(), 4);
    const double dt = scene.settings.time_step;
    scene.bodies[1].type = BodyType::kinematic;
    for (int n = 0; n <= 100; ++n)
        scene.bodies[1].keyframes.push_back({n * dt, {0, 0, -0.5 + 0.5 * kLift * n * dt * n * dt}, {}});
    World world(scene);
    const auto force = [](const World& w) { return w.contacts_of(w.id(0)).force.z; };
    double sum = 0;
    for (int n = 0; n < 60; ++n) {
        (void)world.step();
        if (n >= 20) sum += force(world);
    }
    EXPECT_NEAR(sum / 40, 3 * (kGravity + kLift), 1e-3 * 3 * kGravity);
    EXPECT_EQ(force(World(scene, world.snapshot())), force(world));
    EXPECT_EQ(force(world.clone()), force(world));
}

TEST(SubstepsOf, ContactImpulsesOfWhatWakesAreWhole) {
    SceneDescription scene = in_substeps(resting_block(), 4);
    scene.settings.sleeping = true;
    World world(scene);
    while (world.step().sleeping == 0) ASSERT_LT(world.steps(), 200);
    const double asleep = world.contacts_of(world.id(0)).force.z;
    EXPECT_NEAR(asleep, 3 * kGravity, 0.01 * 3 * kGravity);
    world.wake(world.id(0));
    EXPECT_NEAR(world.contacts_of(world.id(0)).force.z, asleep, 1e-9 * asleep);
    (void)world.step();
    EXPECT_NEAR(world.contacts_of(world.id(0)).force.z, asleep, 0.01 * asleep);
}

TEST(SubstepsOf, ABodyThatRestsCostsNothingInAnyOfThem) {
    SceneDescription scene = empty_scene();
    add_body(scene, add_shape(scene, make_box(1, 1, 1)), BodyType::fixed, {});
    add_body(scene, add_shape(scene, make_box(1, 1, 1), 1), BodyType::dynamic, {0, 0, 9});
    World world(in_substeps(scene));
    (void)world.step();
    EXPECT_EQ(world.activity()[0].cost, 0);
    EXPECT_EQ(world.activity()[1].cost, 2 * kSubsteps);
}

/// The script of a lid comes to a block in the middle of a step.
TEST(SubstepsOf, AScriptThatCannotGoOnLeavesTheWorldAsItWasBeforeTheStep) {
    SceneDescription scene = in_substeps(resting_block(), 8);
    scene.settings.unsatisfiable_script = UnsatisfiableScript::error;
    BodyDescription& lid = add_body(scene, 1, BodyType::kinematic, {0, 0, 3});
    lid.keyframes = {{0, {0, 0, 3}, {}}, {1, {0, 0, 1}, {}}};
    World world(scene);
    for (;;) {
        const std::uint64_t hash = world.state_hash();
        const std::int64_t steps = world.steps();
        const std::vector<WayPoint> way = world.way(2);
        const std::vector<BodyActivity> activity = world.activity();
        try {
            ASSERT_LT(world.step().step, 40);
        } catch (const ScriptError& e) {
            EXPECT_EQ(e.step(), steps + 1);
            EXPECT_EQ(world.state_hash(), hash);
            EXPECT_EQ(world.steps(), steps);
            ASSERT_EQ(world.way(2).size(), way.size());
            for (std::size_t k = 0; k < way.size(); ++k) EXPECT_EQ(world.way(2)[k].position, way[k].position);
            EXPECT_EQ(world.activity()[0].cost, activity[0].cost);
            return;
        }
    }
}

} // namespace
} // namespace flotilla::scenario
