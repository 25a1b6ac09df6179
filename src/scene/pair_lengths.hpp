// SPDX-License-Identifier: MIT
// The three lengths of a pair of bodies, by the size that they go by (Shape::extent of the smaller movable one). All
// checks of scenes, all lists of pairs, queries and contacts have theirs from here. What is allowed beside them for
// rounding is in geometry/rounding.hpp and geometry/ccd.hpp, multiples of the separation are in ccd/separation.hpp.
#pragma once

#include <flotilla/settings.hpp>

namespace flotilla {

/// d_rest: the gap at which contacts rest (paper, section 4.3.1). 1 cm for the paper's boat of 3.3 m.
inline constexpr double kSizePerRestDistance = 330;
/// d_proximity: what is nearer is searched for contacts. 2 cm for the boat. It must exceed d_rest, or a contact would
/// be found only where it is violated; the room is for what bodies move in a step.
inline constexpr double kProximityPerRest = 2;
/// s: the least distance that continuous collision detection proves. Small beside d_rest, so that bodies at rest, which
/// static contact and rounding bring some percent nearer than d_rest, and features that slide past each other at d_rest
/// or at the play of a joint, are no hits; and large beside the rounding of coordinates, so that what is proved does
/// not drown in that: 0.2 mm for the boat, whose ccd_error() is 3e-14 m.
inline constexpr double kRestPerSeparation = 50;

struct PairLengths {
    double rest, proximity, separation; ///< m
};

/// The separation that follows from a rest distance, m.
[[nodiscard]] constexpr double derived_separation(double rest) { return (1 / kRestPerSeparation) * rest; }

/// By settings, where they fix a length, else from the size, m, or from the rest distance.
[[nodiscard]] inline PairLengths lengths_of_size(const Settings& settings, double size) {
    const double rest = settings.rest_distance > 0 ? settings.rest_distance : size * (1 / kSizePerRestDistance);
    return {rest, settings.proximity_distance > 0 ? settings.proximity_distance : kProximityPerRest * rest,
            settings.separation > 0 ? settings.separation : derived_separation(rest)};
}

} // namespace flotilla
