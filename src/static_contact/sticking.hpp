// SPDX-License-Identifier: MIT
// Which contacts stick, of `tangents: random`.
//
// A friction pyramid of random direction holds more along its diagonals than along its sides. Drawn anew in every step
// it therefore cuts the friction of contacts that stick, a different part of them each time, and the sweeps of a pile
// at rest do little but hand their load to others. What the paper's random tangents are for, that no direction is
// preferred, needs new ones in every step only where bodies slide. So contacts keep theirs that slid by less than a
// tenth of what gravity adds in a step, nor more than the rest distance in a step.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "state/contact.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

/// By body: velocities of the last step, and of bodies whose motion is prescribed those of this one.
struct LastVelocities {
    std::vector<Vec3> linear, angular; ///< m/s, rad/s

    /// `last_motion`: at x^n.
    void load(Team* team, const Model& model, const VelocityArrays& bodies, std::span<const Motion> last_motion);
};

/// Whether a contact slid by less than `limit`, m/s, in the last step.
[[nodiscard]] bool sticks(const Contact& contact, double limit, const VelocityArrays& bodies,
                          const LastVelocities& last);

} // namespace flotilla
