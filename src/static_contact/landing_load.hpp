// SPDX-License-Identifier: MIT
// Who carries a body that rolls from one corner to the next within a step (rolling.hpp).
//
// A polygon that rolls stands on a corner until the next one lands, which takes all impulses from then on: that of the
// landing, and the load of the rest of the step. A contact solve knows of one time a step. It finds the landing, and
// gives the corner ahead the load of the whole step, as if it had carried from the beginning: a brake of the order of
// the step at each landing. Moved to where the load is in the mean, the landing is moved as well, and a prism of 16
// sides loses a half to all of what it should. So both corners are given their shares of the load beforehand, where
// they are while they carry, and the solve finds the landing alone, where it happens.
//
// Where the corner that is left stands (rolling.hpp) it alone has its share, and the solve finds the rest where the
// next one lands.
//
// The load is the body's own weight, at most what it rested on carried in the step before, shared as that was. What
// presses on a body many times lighter goes through that at once: at its other side the solve has to find it, and to
// take back what the one side alone would make of the light body. So that has a bound (kMostHeavier).
#pragma once

#include <span>
#include <vector>

#include "static_contact/targets.hpp"

namespace flotilla {

/// Impulses that contacts have before the solve.
struct LandingLoads {
    std::vector<std::size_t> contacts;
    std::vector<Vec3> impulses;     ///< N s, on b
    std::vector<std::size_t> pairs; ///< scratch: a contact of each pair
    std::vector<double> carried;    ///< scratch: N s, by body
    std::vector<double> taken;      ///< scratch: N s, by contact of a pair
};

/// Gives contacts their shares (ArcContact::carries): changes the velocities, and takes them from `impulses` (N s, on
/// b, by contact), the warm start. `accelerated`: s, for which loads have acted on the velocities.
void give_landing_loads(const Model& model, const ContactTargets& targets, double accelerated, std::span<Vec3> impulses,
                        VelocityArrays& bodies, LandingLoads& out);

/// Adds them to what a solve found.
void add_landing_loads(const LandingLoads& given, std::span<Vec3> impulses);

} // namespace flotilla
