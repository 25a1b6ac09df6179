// SPDX-License-Identifier: MIT
// What stage 1 finds of a pair: its earliest hit, or where there is none a fast proximity at the end of the step, with
// what hits at the same time.
#pragma once

#include <optional>

#include "pair/step_data.hpp"

namespace flotilla {

/// m/s: what approaches slower is left to static contact. Without gravity that is what brings the bodies no nearer in a
/// step than static contact leaves undone (Settings::static_tolerance), or bodies that slide in a joint would hit each
/// other at the speed of rounding. Of bodies with loads of their own it is half of what those add in a step, if that is
/// more than gravity. `rest`: m, distance of the pair.
[[nodiscard]] double least_approach(const StepData& data, std::int32_t a, std::int32_t b, double rest);

/// The nearest contact point at the end of the step that approaches too fast to be left to static contact, with rigid
/// velocities and arms at the end (section 3.2). Closer than the rest distance that is faster than the threshold.
/// Farther away, up to the proximity distance, it is also fast enough to come below the rest distance within one more
/// step: stage 7 would cut exactly these approaches to (d_rest - d)/dt, and a fast body that happens to end a step
/// there would lose its rebound. Of a point on its way down an arc (arc.hpp) the speed counts with which it arrives:
/// those ahead of the contact of a wheel come down fast, and a wheel that sinks by the little that a facet makes it
/// sink would collide with the ground at all of them.
std::optional<ContactPoint> end_proximity(const StepData& data, Worker& worker, PairRecord& record);

/// Fills worker.hits with the hits of the pair's present motion, the earliest one first. None: false, and its contact,
/// if there is any, is left to later stages.
bool find_hits(const StepData& data, Worker& worker, PairRecord& record);

} // namespace flotilla
