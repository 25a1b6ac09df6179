// SPDX-License-Identifier: MIT
// What a step leaves out because the scene does not need it changes no bit (state/savings.hpp).
#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include <flotilla/scene_library.hpp>

#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

struct Totals {
    std::int64_t collisions = 0, contacts = 0, sleeping = 0;
    std::size_t lone = 0; ///< bodies, all steps together
};

/// Runs a scene with a saving and without it. Every state must be the same.
Totals run_both(const SceneDescription& description, bool Savings::*saving, int steps) {
    const Model model = make_model(build_scene(description));
    const State start = initial_state(build_scene(description), model);
    StepperOptions off;
    off.savings.*saving = false;
    Stepper with(model, start), without(model, start, off);
    Totals totals;
    for (int n = 0; n < steps; ++n) {
        const StepReport r = with.step(), s = without.step();
        EXPECT_EQ(r.state_hash, s.state_hash) << "step " << n + 1;
        EXPECT_EQ(r.warnings, s.warnings) << "step " << n + 1;
        if (testing::Test::HasFailure()) return totals;
        totals.collisions += r.collisions;
        totals.contacts += r.contacts;
        totals.sleeping += r.sleeping;
        totals.lone += with.lone_bodies();
    }
    return totals;
}

SceneDescription frictionless_boats() {
    SceneDescription scene = make_scene("boats-in-bowl", 14, 3);
    for (BodyDescription& body : scene.bodies) body.friction = 0;
    return scene;
}

/// m/s: how much velocities differ at most after a step with all rows from the state of each step with normal rows
/// alone, in 160 steps.
double loss_of_friction_rows(ContactSolver solver) {
    SceneDescription boats = frictionless_boats();
    boats.settings.contact_solver = solver;
    const Scene scene = build_scene(boats);
    const Model model = make_model(scene);
    StepperOptions off;
    off.savings.normal_rows = false;
    Stepper with(model, initial_state(scene, model));
    std::int64_t contacts = 0;
    double largest = 0;
    for (int n = 0; n < 160; ++n) {
        Stepper without(model, with.state(), off);
        contacts += with.step().contacts;
        (void)without.step();
        for (std::size_t i = 0; i < model.size(); ++i)
            largest = std::max(largest, length(with.state().motion[i].velocity - without.state().motion[i].velocity));
    }
    EXPECT_GE(contacts, 1000);
    return largest;
}

// Sweeps see the same numbers but for the sign of zeros. Exact solves, whose cones have another shape, end elsewhere
// below what a solve may leave undone.
TEST(Savings, RowsOfFrictionAreNotMissedWithoutFriction) {
    const Settings s = frictionless_boats().settings;
    const double gravity = length(frictionless_boats().gravity) * s.time_step;
    EXPECT_LE(loss_of_friction_rows(ContactSolver::pgs), 1e-12 * gravity);
    EXPECT_LE(loss_of_friction_rows(s.contact_solver), ContactTuning{}.of_gravity * gravity);
}

TEST(Savings, SweepsOverCalmPairsAreNotMissed) {
    for (const double restitution : {0.0, 0.3}) {
        SceneDescription scene = make_scene("boats-in-bowl", 14, 3);
        for (BodyDescription& body : scene.bodies) body.restitution = restitution;
        const Totals t = run_both(scene, &Savings::calm_pairs, 120);
        EXPECT_GE(t.collisions, 100);
        EXPECT_GE(t.contacts, 500);
    }
}

TEST(Savings, KeptPairsAreThoseOfNewSearches) {
    for (const char* name : {"boats-in-bowl", "household"}) {
        const Totals t = run_both(make_scene(name, 14, 3), &Savings::kept_pairs, 100);
        EXPECT_GE(t.contacts, 100) << name;
        EXPECT_GE(t.lone, 10u) << name;
    }
    SceneDescription turning = make_scene("boats-in-bowl", 14, 3);
    turning.settings.trajectory = Trajectory::rigid;
    turning.settings.substeps = 2;
    EXPECT_GE(run_both(turning, &Savings::kept_pairs, 60).collisions, 100);
}

TEST(Savings, LargeBodiesMeetOthersWithoutCells) {
    for (const char* name : {"boats-in-bowl", "triangles-on-pegs", "stack"}) {
        const Totals t = run_both(make_scene(name, 24, 3), &Savings::large_bodies, 100);
        EXPECT_GE(t.contacts, 100) << name;
    }
}

TEST(Savings, LargeMeshesThatStandStillFillNoCells) {
    const Scene scene = build_scene(make_scene("boats-in-bowl", 14, 3));
    const Model model = make_model(scene);
    StepperOptions off;
    off.savings.large_bodies = false;
    Stepper with(model, initial_state(scene, model)), without(model, initial_state(scene, model), off);
    (void)with.step(), (void)without.step();
    std::vector<std::int32_t> still;
    for (std::size_t i = 0; i < model.size(); ++i)
        if (model.bodies[i].type == BodyType::fixed) still.push_back(static_cast<std::int32_t>(i));
    EXPECT_EQ(with.large_still(), still);
    EXPECT_TRUE(without.large_still().empty());
}

TEST(Savings, CodeOfScriptsIsNotMissedWithoutScripts) {
    SceneDescription scene = make_scene("boats-in-bowl", 14, 3);
    for (const UnsatisfiableScript policy : {UnsatisfiableScript::hold, UnsatisfiableScript::error}) {
        scene.settings.unsatisfiable_script = policy;
        EXPECT_GE(run_both(scene, &Savings::scripts, 120).contacts, 500);
    }
    const Scene scripted = build_scene(make_scene("closing-walls", 3, 1)), plain = build_scene(scene);
    EXPECT_TRUE(Stepper(make_model(scripted), initial_state(scripted, make_model(scripted))).has_scripts());
    EXPECT_FALSE(Stepper(make_model(plain), initial_state(plain, make_model(plain))).has_scripts());
}

TEST(Savings, NothingIsFoundAheadOfLargeBodies) {
    SceneDescription scene = make_scene("boats-in-bowl", 14, 3);
    EXPECT_GE(run_both(scene, &Savings::look_ahead, 120).contacts, 500);
}

// Every body with a mesh of its own, against one for all.
TEST(Savings, SharedShapesAreAsGoodAsOnesOwn) {
    const Scene scene = build_scene(make_scene("boats-in-bowl", 14, 3));
    const Model shared = make_model(scene);
    Model own = shared;
    own.shapes.clear();
    for (std::size_t i = 0; i < own.size(); ++i) {
        own.shapes.push_back(shared.shape_of(i));
        own.bodies[i].shape = static_cast<std::int32_t>(i);
    }
    ASSERT_LT(shared.shapes.size(), own.shapes.size());
    Stepper a(shared, initial_state(scene, shared)), b(own, initial_state(scene, own));
    std::int64_t contacts = 0;
    for (int n = 0; n < 120; ++n) {
        const StepReport r = a.step();
        ASSERT_EQ(r.state_hash, b.step().state_hash) << n;
        contacts += r.contacts;
    }
    EXPECT_GE(contacts, 500);
}

/// A stack of boxes, and far from it, if asked, so many others that soon sleep.
SceneDescription stacks(int far) {
    SceneDescription scene = make_scene("stack", 4, 1);
    const std::size_t n = scene.bodies.size();
    for (int k = 1; k <= far; ++k)
        for (std::size_t i = 0; i < n; ++i) {
            BodyDescription body = scene.bodies[i];
            body.name += " of " + std::to_string(k);
            body.position.x += 1000.0 * k;
            scene.bodies.push_back(body);
        }
    return scene;
}

// While one stack is awake because a box falls on it, others sleep: they cost no pair and no contact, and change no bit
// of it.
TEST(Savings, BodiesAsleepCostNothingAndChangeNothing) {
    const auto start = [](int far, std::vector<std::unique_ptr<Stepper>>& steppers) {
        SceneDescription description = stacks(far);
        BodyDescription falling = description.bodies[1];
        falling.name = "falling";
        falling.position.z += 40;
        description.bodies.push_back(falling);
        const Scene scene = build_scene(description);
        const Model model = make_model(scene);
        steppers.push_back(std::make_unique<Stepper>(model, initial_state(scene, model)));
        return static_cast<std::int32_t>(description.bodies.size()) - 1;
    };
    std::vector<std::unique_ptr<Stepper>> steppers;
    const auto alone = static_cast<std::size_t>(start(0, steppers)),
               among = static_cast<std::size_t>(start(9, steppers));
    std::int64_t asleep = 0, slept = 0; // slept: in the step before
    for (int n = 0; n < 80; ++n) {
        const StepReport a = steppers[0]->step(), b = steppers[1]->step();
        const auto pose = [&](std::size_t k, std::size_t i) { return steppers[k]->state().pose[i]; };
        ASSERT_EQ(pose(0, alone), pose(1, among)) << n;
        for (std::size_t i = 0; i < alone; ++i) ASSERT_EQ(pose(0, i), pose(1, i)) << n << ' ' << i;
        if (a.sleeping > 0 && a.sleeping == slept && b.sleeping == 10 * slept) {
            asleep += b.sleeping;
            EXPECT_EQ(a.pairs, b.pairs) << n;
            EXPECT_EQ(a.contacts, b.contacts) << n;
            EXPECT_EQ(steppers[0]->contact_visits(), steppers[1]->contact_visits()) << n;
        }
        slept = a.sleeping;
    }
    EXPECT_GE(asleep, 100);
}

} // namespace
} // namespace flotilla
