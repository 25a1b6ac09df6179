// SPDX-License-Identifier: MIT
// Hits solved together as stage 3 solves contacts (pair/joint_hits.hpp).
#pragma once

#include "pair/joint_hits.hpp"
#include "static_contact/solve_contacts.hpp"
#include "static_contact/velocity_arrays.hpp"
#include "support/stage_world.hpp"

namespace flotilla::test {

struct JointSolver {
    explicit JointSolver(StageWorld& world)
        : joint{
              [this, &world](std::span<const Contact> hits, std::span<const Motion> motion, std::span<Vec3> impulses) {
                  velocities.load(nullptr, world.model(), 1, world.starts(), motion);
                  ContactSolveOptions options;
                  options.exact = true;
                  (void)solve_contacts(hits, velocities.bodies(), options, impulses, scratch);
                  return std::span<const std::uint8_t>(scratch.unsolved);
              },
              {}} {}

    VelocityArrays velocities;
    ContactScratch scratch;
    JointSolve joint;
};

} // namespace flotilla::test
