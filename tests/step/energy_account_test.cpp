// SPDX-License-Identifier: MIT
// The account of a step's energy, on two boxes whose poses and motions are written by hand.
#include "step/energy_account.hpp"

#include <cmath>

#include "scene/scene.hpp"
#include "state/build_model.hpp"
#include "step/scenario.hpp"

namespace flotilla::scenario {
namespace {

constexpr double kMass = 3; // kg, of each box

/// Boxes 0 and 1, a fixed plate 2 and a scripted one 3.
struct Account {
    Model model;
    State state;
    Team team{{}};
    EnergyAccount account;
    std::vector<Pose> end;
    std::vector<Motion> motion;

    explicit Account(const Vec3& gravity) {
        SceneDescription scene = empty_scene();
        scene.gravity = gravity;
        const auto box = add_shape(scene, make_box(1, 0.5, 0.3), kMass), plate = add_shape(scene, make_plate(9, 9));
        add_body(scene, box, BodyType::dynamic, {0, 0, 2});
        add_body(scene, box, BodyType::dynamic, {3, 0, 2});
        add_body(scene, plate, BodyType::fixed, {});
        add_body(scene, plate, BodyType::kinematic, {0, 0, -5}).keyframes = {{0, {0, 0, -5}, {}}};
        const Scene built = build_scene(scene);
        model = make_model(built);
        state = initial_state(built, model);
        end = state.pose;
        for (std::size_t i = 0; i < 2; ++i)
            state.motion[i] = {{1.0 - 3.0 * static_cast<double>(i), -2, 0.5}, {0.1, 0.2, -0.3}};
        motion = state.motion;
        account.start(team, model, state.pose, state.motion);
    }
    double kinetic(const std::vector<Motion>& m) const {
        double sum = 0;
        for (std::size_t i = 0; i < 2; ++i)
            sum += 0.5 * kMass * length_sq(m[i].velocity) +
                   0.5 * dot(m[i].momentum, angular_velocity(model.shape_of(i), end[i].rotation, m[i].momentum));
        return sum;
    }
    void raise(double height) {
        for (std::size_t i = 0; i < 2; ++i)
            end[i] = make_pose(model.shape_of(i), end[i].com + Vec3{0, 0, height}, end[i].rotation);
    }
    void speed_up(double factor) {
        for (std::size_t i = 0; i < 2; ++i)
            motion[i] = {factor * motion[i].velocity + Vec3{0.3, 0, 0}, factor * motion[i].momentum};
    }
    EnergyCorrections settle() { return account.settle(team, model, end, motion, state.lift); }
    double rest() const { return body_lengths(model, 0).rest; }
};

TEST(EnergyAccount, WhatGainsNothingKeepsEveryBit) {
    Account a({0, 0, -9.8});
    a.account.join(a.model, 0, 1);
    const EnergyCorrections made = a.settle();
    EXPECT_EQ(made.islands, 0);
    EXPECT_EQ(made.lift, 0);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(a.motion[i].velocity, a.state.motion[i].velocity);
        EXPECT_EQ(a.motion[i].momentum, a.state.motion[i].momentum);
    }
}

TEST(EnergyAccount, AFreeIslandGivesUpExactlyItsExcessAndKeepsItsMomentum) {
    Account a({});
    a.account.join(a.model, 0, 1);
    a.speed_up(1.2);
    const Vec3 p = kMass * (a.motion[0].velocity + a.motion[1].velocity);
    const double before = a.kinetic(a.state.motion), gained = a.kinetic(a.motion);
    ASSERT_GT(gained, 1.1 * before);
    // What moves with the centre of mass cannot be given up, and is less than what the island had.
    ASSERT_LT(length_sq(p) / (4 * kMass), before);
    const EnergyCorrections made = a.settle();
    EXPECT_EQ(made.islands, 1);
    EXPECT_NEAR(made.removed, gained - before, 1e-13 * gained);
    EXPECT_NEAR(a.kinetic(a.motion), before, 1e-13 * gained);
    EXPECT_LT(length(kMass * (a.motion[0].velocity + a.motion[1].velocity) - p), 1e-14 * length(p));
}

TEST(EnergyAccount, IslandsAreJudgedApart) {
    Account a({});
    a.motion[0].velocity = 1.2 * a.motion[0].velocity; // not joined: a body alone has nothing but its centre of mass
    a.motion[1].velocity = 0.5 * a.motion[1].velocity; // what one island loses is no other's
    a.motion[0].momentum = 1.5 * a.motion[0].momentum;
    const EnergyCorrections made = a.settle();
    EXPECT_EQ(made.islands, 1);
    EXPECT_EQ(a.motion[1].velocity, 0.5 * a.state.motion[1].velocity);
    EXPECT_EQ(a.motion[1].momentum, a.state.motion[1].momentum);
    EXPECT_LT(length(a.motion[0].momentum), length(a.state.motion[0].momentum));
    EXPECT_GT(a.state.lift[0], 0) << "a debt, paid back by the steps to come";
    EXPECT_EQ(a.state.lift[1], 0);
}

TEST(EnergyAccount, AGroundedIslandGivesUpItsExcessAgainstTheWorld) {
    Account a({});
    a.account.join(a.model, 0, 1);
    a.account.join(a.model, 1, 2);
    a.speed_up(1.2);
    const std::vector<Motion> gained = a.motion;
    const double before = a.kinetic(a.state.motion);
    EXPECT_EQ(a.settle().islands, 1);
    EXPECT_NEAR(a.kinetic(a.motion), before, 1e-13 * before);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_LT(length(cross(a.motion[i].velocity, gained[i].velocity)), 1e-13);
        EXPECT_LT(length(a.motion[i].velocity), length(gained[i].velocity));
    }
}

TEST(EnergyAccount, WorkOfScriptedBodiesIsTheirs) {
    Account a({});
    a.account.join(a.model, 0, 3);
    a.account.join(a.model, 0, 1);
    a.speed_up(1.2);
    const std::vector<Motion> gained = a.motion;
    a.account.add_work(0, a.kinetic(gained) - a.kinetic(a.state.motion));
    EXPECT_EQ(a.settle().islands, 0);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(a.motion[i].velocity, gained[i].velocity);
}

TEST(EnergyAccount, LiftIsDrawnAndPaidBack) {
    Account a({0, 0, -9.8});
    a.account.join(a.model, 0, 1);
    const double height = 0.4 * a.rest(), work = 2 * kMass * 9.8 * height;
    a.raise(height);
    EnergyCorrections made = a.settle();
    EXPECT_EQ(made.islands, 0);
    EXPECT_NEAR(made.lift, work, 1e-12);
    EXPECT_EQ(a.motion[0].velocity, a.state.motion[0].velocity);
    a.account.start(a.team, a.model, a.end, a.motion); // the next step: half the way down
    a.account.join(a.model, 0, 1);
    a.raise(-0.5 * height);
    made = a.settle();
    EXPECT_EQ(made.islands, 0);
    EXPECT_NEAR(made.lift, 0.5 * work, 1e-12);
    a.account.start(a.team, a.model, a.end, a.motion); // falls by more than it was lifted
    a.account.join(a.model, 0, 1);
    a.raise(-height);
    EXPECT_NEAR(a.settle().lift, 0, 1e-12);
}

TEST(EnergyAccount, LiftEndsAtTheRestDistance) {
    Account a({0, 0, -9.8});
    a.account.join(a.model, 0, 1);
    a.account.join(a.model, 0, 2);
    const double work = 2 * kMass * 9.8 * a.rest(), before = a.kinetic(a.motion);
    a.raise(1.5 * a.rest());
    const EnergyCorrections made = a.settle();
    EXPECT_EQ(made.islands, 1);
    EXPECT_NEAR(made.lift, work, 1e-12);
    EXPECT_NEAR(made.removed, 0.5 * work, 1e-12);
    EXPECT_NEAR(a.kinetic(a.motion), before - 0.5 * work, 1e-12);
}

TEST(EnergyAccount, BodiesRaisedBeyondAllTheirEnergyAreOverdrawn) {
    for (const bool scripted : {false, true})
        for (const double part : {0.99, 1.01}) {
            Account a({0, 0, -9.8});
            a.account.join(a.model, 0, 1);
            if (scripted) a.account.join(a.model, 1, 3);
            const double height = part * (a.kinetic(a.motion) / (2 * kMass * 9.8) + a.rest());
            const std::vector<Vec3> way{{0, 0, height}, {0, 0, height}, {}, {}}, held(4);
            const auto bodies = a.account.overdrawn(a.model, way, a.state.lift);
            const bool expected = part > 1 && !scripted; // a script may raise what it likes
            EXPECT_EQ(std::vector<std::int32_t>(bodies.begin(), bodies.end()),
                      expected ? (std::vector<std::int32_t>{0, 1}) : std::vector<std::int32_t>{});
            EXPECT_TRUE(a.account.overdrawn(a.model, held, a.state.lift).empty()) << "held, it has gained nothing";
        }
}

TEST(EnergyAccount, AWayIsPaidForAsFarAsAllEnergyAndLiftGo) {
    Account a({0, 0, -9.8});
    a.account.join(a.model, 0, 1);
    const double paid = a.kinetic(a.motion) / (2 * kMass * 9.8) + a.rest();
    const std::vector<Vec3> way{{0, 0, 2 * paid}, {0, 0, 2 * paid}, {}, {}};
    for (const std::size_t body : {0u, 1u}) EXPECT_NEAR(a.account.paid(a.model, way, a.state.lift)[body], 0.5, 1e-8);
    a.account.join(a.model, 1, 3); // a script may raise what it likes
    for (const double share : a.account.paid(a.model, way, a.state.lift)) EXPECT_EQ(share, 1);
}

TEST(EnergyAccount, RaisingIsPaidByLiftAndByWhatContactDissipates) {
    Account a({0, 0, -9.8});
    a.account.join(a.model, 0, 1);
    const double dt = a.model.settings.time_step;
    const auto shares = [&](const std::vector<Motion>& kept, double height) {
        std::vector<Motion> raised = kept;
        for (std::size_t i = 0; i < 2; ++i) raised[i].velocity.z += height / dt;
        return a.account.affordable(a.model, a.state.pose, kept, raised, a.state.lift);
    };
    std::vector<Motion> flies = a.state.motion, stopped(4);
    for (std::size_t i = 0; i < 2; ++i) flies[i].velocity.z -= 0.5 * dt * 9.8;
    for (const std::size_t body : {0u, 1u})
        EXPECT_NEAR(shares(flies, 2 * a.rest())[body], 0.5, 1e-6) << "its kinetic energy is kept";
    const double left = 0.5 * kMass * std::pow(0.5 * dt * 9.8, 2); // of each, from gravity's half at the end
    const double paid = (a.kinetic(a.motion) - 2 * left) / (2 * kMass * 9.8) + a.rest();
    for (const std::size_t body : {0u, 1u}) EXPECT_NEAR(shares(stopped, 2 * paid)[body], 0.5, 1e-6);
    for (const double share : shares(stopped, -paid)) EXPECT_EQ(share, 1);
    a.account.join(a.model, 1, 3); // a script may raise what it likes
    for (const double share : shares(stopped, 2 * paid)) EXPECT_EQ(share, 1);
}

TEST(EnergyAccount, AnIslandIsSpentWhereItHasNeitherEnergyNorLiftLeft) {
    Account a({0, 0, -9.8});
    for (Motion& motion : a.state.motion) motion = {};
    a.account.start(a.team, a.model, a.state.pose, a.state.motion);
    a.account.join(a.model, 0, 1);
    EXPECT_TRUE(a.account.spent(a.model, 0.02, a.state.lift).empty());
    const double most = kMass * 9.8 * a.rest();
    a.state.lift[0] = most;
    EXPECT_TRUE(a.account.spent(a.model, 0.02, a.state.lift).empty()) << "the other one has not drawn any";
    a.state.lift[1] = 0.97 * most;
    const auto spent = a.account.spent(a.model, 0.02, a.state.lift);
    EXPECT_EQ(std::vector<std::int32_t>(spent.begin(), spent.end()), (std::vector<std::int32_t>{0, 1}));
}

} // namespace
} // namespace flotilla::scenario
