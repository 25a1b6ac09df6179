// SPDX-License-Identifier: MIT
// Where the impulses of a pair act while a body rolls.
//
// Stage 7 gives the bodies the impulses of a whole step, and equation 16 counts with contacts that the motion will
// bring down in the next one. A wheel that takes several steps to a side then presses on each corner up to a step
// before that lands, ahead of the axle, and brakes itself at up to g v dt / r: 512 sides at 0.5 m/s and 1/480 s keep
// 0.978 of their speed in 2 s, due 0.992.
//
// So a corner that lands in the step takes the load to where that is in the mean of the step: on the corner that
// carries now until the other one has landed, there afterwards. Where more than one side passes in a step that is right
// below the axle, as the arcs have it.
#pragma once

#include <span>

#include "base/vec3.hpp"
#include "response/arc.hpp"
#include "state/contact.hpp"

namespace flotilla {

/// A body that rolls over another one, as the lowest of their contacts sees it.
struct RollingMotion {
    Vec3 turn;  ///< rad/s, of b relative to a
    Vec3 along; ///< unit, tangential: where the contacts move, seen from the centre of mass of the body that rolls
    double speed = 0;      ///< m/s, of that
    double arm = 0;        ///< m, from the centre of mass
    double gravity = 0;    ///< m/s^2
    double time_step = 0;  ///< s
    double band = 0;       ///< m: contacts that are at most so much higher than the lowest one carry now
    double angle_cos = -1; ///< of the normals of contacts at the same place
};

/// Where one side of a pair lands in the step, moves its contacts to the place of the mean load. `lowest`: the nearest
/// contact; `arcs`: by contact, changed.
void share_load(std::span<const Contact> pair, std::size_t lowest, const RollingMotion& motion,
                std::span<ArcContact> arcs);

} // namespace flotilla
