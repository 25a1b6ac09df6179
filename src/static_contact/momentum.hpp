// SPDX-License-Identifier: MIT
// Nesterov's momentum for sweeps (see sweep_island.hpp).
#pragma once

#include <cstddef>
#include <span>

#include "static_contact/solve_contacts.hpp"

namespace flotilla {

/// The sequence of m.
class Momentum {
  public:
    /// The m of the next sweep: 0 after a restart.
    double next(bool restart);

  private:
    double theta_ = 1;
};

/// Remembers the velocities x of the bodies and moves them on to y.
void extrapolate(std::span<const std::int32_t> bodies, double m, ContactScratch& scratch);

/// Bodies whose parts of a sum are added up by one thread: sums are cut there, whatever the number of threads.
inline constexpr std::size_t kBodiesPerSum = 64;

/// (y - x) . (x - x_before), twice the energy of the product; a body turns with its mean inertia.
[[nodiscard]] double turned_back(std::span<const std::int32_t> bodies, const ContactScratch& scratch);

} // namespace flotilla
