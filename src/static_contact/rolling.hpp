// SPDX-License-Identifier: MIT
// Arcs of the contacts of a pair (response/arc.hpp), and where its impulses act while a body rolls.
//
// Stage 7 gives the bodies the impulses of a whole step, and equation 16 counts with contacts that the motion will
// bring down in the next one. A wheel that takes several steps to a side then presses on each corner up to a step
// before that lands, ahead of the axle, and brakes itself at up to g v dt / r: 512 sides at 0.5 m/s and 1/480 s keep
// 0.978 of their speed in 2 s, due 0.992.
//
// So where a corner lands in the step, the one that carries now has the load until then, and the other one the landing
// and the load afterwards (landing_load.hpp). A corner that the axle has passed lets the body down along its arc, by
// the end of the step and not a step later. A prism of 16 sides and 1 m, let go at 0.8 m/s on a corner, ends up where
// plastic impacts say, 17.5 sides on, at 1/480 s, and a side short of it at 1/120 s; with the load where it is in the
// mean, and the landing with it, each of them took half to all of what it should.
//
// Where a side takes less than four steps, and there are contacts enough for a surface through them, the body rolls as
// if it were round, without the impacts of its sides: the load is right below the middle of its curvature, and what
// comes down next is left to the next step. At the places to which arcs bring the points the load is ahead of that by
// up to the way of the step, in stages 3 and 7 alike: no matter where the axle is above it, but a body that is heavy on
// one side and swings on its round one loses half the square of its frequency times the step in each. A cylinder of
// 2,048 sides and 0.3 m, its mass 0.1 m below the middle, let go at 0.4 rad, came back to 0.11 in the third half swing
// at 1/24 s, to 0.23 at 1/60 s and to 0.31 at 1/120 s, and comes back to 0.397 and more at each.
//
// A side of eight steps and more needs no mean: its corner stands (standing.hpp) until the step in which the next one
// lands. Stage 7 of the step before leaves that to come, and what it brings is taken where it lands. As its load then
// acts half at either end of the step, the corner that is left has twice its share of the first half. A prism of 32
// sides loses 0.97 of what plastic impacts take at 1/480 s and 0.89 at 1/120 s; turned by arcs alone it gained energy
// on the way up.
//
// A disk that rolls around its own middle turns about the line to its contact: no arc takes the points ahead up again,
// what does is the load itself, which goes round. Stages 3 and 7 both had it on the point where the *next* step ends,
// ahead of the mean by more than half of the step's way: a brake of first order. Where a body tips over several sides
// in a step, stage 3, whose half of the impulse moves it there, has the load half way to the point that it asks it of,
// and stage 7 leaves the points ahead to the next step. A disk of 1 m tilted by 0.3 rad keeps 0.95 of its energy in
// 0.5 s at 1/480 s, 0.83 without, and at 1/120 s 0.58, 0.34 without.
//
// The contact of such a body goes on much faster than its points do, as seen from its centre of mass. Where it does not
// the body rolls, whatever its radius of gyration and its width: by those alone a wide roller whose turns are
// prescribed, and an axle with heavy discs, tipped, and what slid on them had no friction from some fineness of their
// sides on.
//
// What slides, and no other point of the pair follows it in the step, does not roll: it carries from one end of it to
// the other, and its load is where it is at each, as RATTLE has it. The place to which its arc leads belongs to the end
// of the step, the normal to its start: on a flat side such a load brakes, in a hollow, where the normal turns with the
// body, it drives. A stick without friction that swings across a round trough by 0.02 rad came to 0.055 rad in 20 s at
// 1/60 s.
#pragma once

#include <span>

#include "response/arc.hpp"
#include "state/contact.hpp"
#include "static_contact/standing.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

/// What rolls, and which of its contacts carry.
struct RollingBands {
    double still = 0;      ///< m: what moves along the other body by no more in the step does not roll
    double carries = 0;    ///< m: contacts that are at most so much higher than the lowest one carry now
    double angle_cos = -1; ///< of the normals of contacts at the same place
    bool at_end = false;   ///< of the step: stage 7
    bool thin = false;     ///< a body is thinner than the rest distance
};

/// Sets the arcs of the contacts of one pair, and where one of its bodies rolls over the other moves those that land in
/// the step to the place of the mean load. Whether it rolls.
bool arcs_of_pair(const Model& model, std::span<const Contact> pair, const RollingBands& bands,
                  const VelocityArrays& bodies, const TurningBodies& turning, std::span<ArcContact> arcs);

/// Whether two bodies turn so little that their contacts have no arcs. `still` (m): what static contact leaves undone.
[[nodiscard]] bool turn_little(const Model& model, std::int32_t a, std::int32_t b, const VelocityArrays& bodies,
                               double still);

} // namespace flotilla
