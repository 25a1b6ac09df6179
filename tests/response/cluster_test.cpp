// SPDX-License-Identifier: MIT
// What a turning rigid cluster proves about its members depends on how they move on the way (step/certificate.hpp, c).
#include <gtest/gtest.h>

#include "mesh/primitives.hpp"
#include "response/cluster.hpp"

namespace flotilla {
namespace {

/// Two spheres merged into a rigid cluster that turns by about `angle` rad, or only moves.
bool members_proved(Trajectory trajectory, double angle) {
    Model model;
    model.settings.trajectory = trajectory;
    RigidShape shape;
    shape.mesh = make_sphere(0.5, 0);
    shape.topology = build_topology(shape.mesh);
    shape.bvh = build_bvh(shape.mesh);
    shape.box = bounding_box(shape.mesh);
    shape.radius = bounding_radius(shape.mesh, {});
    shape.mass = 1;
    shape.inertia = {{0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1}};
    shape.principal = {{}, {0.1, 0.1, 0.1}, {10, 10, 10}};
    model.shapes.push_back(shape);
    model.bodies.resize(2);
    for (Body& b : model.bodies) b.mass = b.inverse_mass = 1;
    const std::vector<Pose> poses{make_pose(shape, {-0.6, 0, 0}, {}), make_pose(shape, {0.6, 0, 0}, {})};
    Trajectories trajectories;
    trajectories.start(model, poses);
    const double dt = 0.1, omega = angle / dt; // about z
    const std::vector<Motion> motion{{{1, -0.6 * omega, 0}, {0, 0, 0.1 * omega}},
                                     {{1, 0.6 * omega, 0}, {0, 0, 0.1 * omega}}};
    Clusters clusters;
    clusters.start(model, trajectories, motion);
    const std::int32_t id = clusters.merge(0, 1, true, dt, trajectories);
    clusters.evolve(id, dt, trajectories);
    EXPECT_NEAR(length(trajectories.turn(0)), angle, 0.01 * angle);
    EXPECT_NEAR(length(trajectories.end_pose(1).com - trajectories.end_pose(0).com), 1.2, 1e-12);
    return clusters[id].internal_proved;
}

TEST(RigidCluster, KeepsMembersApartOnStraightLinesBelowTwoRadians) {
    EXPECT_TRUE(members_proved(Trajectory::linear, 0));
    EXPECT_TRUE(members_proved(Trajectory::linear, 1.9));
    EXPECT_FALSE(members_proved(Trajectory::linear, 2.1));
}

TEST(RigidCluster, NeedsProofsOfItsMembersOnTurningPaths) {
    EXPECT_TRUE(members_proved(Trajectory::rigid, 0));
    EXPECT_FALSE(members_proved(Trajectory::rigid, 0.01));
    EXPECT_FALSE(members_proved(Trajectory::rigid, 1.9));
}

} // namespace
} // namespace flotilla
