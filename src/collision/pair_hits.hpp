// SPDX-License-Identifier: MIT
// What stage 1 finds of a pair: its earliest hit, or where there is none a fast proximity at the end of the step, with
// what hits at the same time.
#pragma once

#include <optional>

#include "collision/grounds.hpp"
#include "pair/examine.hpp"
#include "pair/pair_table.hpp"
#include "pair/step_view.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// m/s: what approaches slower is left to static contact. Without gravity that is what brings the bodies no nearer in a
/// step than static contact leaves undone (Settings::static_tolerance), or bodies that slide in a joint would hit each
/// other at the speed of rounding. Of bodies with loads of their own it is half of what those add in a step, if that is
/// more than gravity. `rest`: m, distance of the pair.
[[nodiscard]] double least_approach(const StepView& view, std::int32_t a, std::int32_t b, double rest);

/// The nearest contact point at the end of the step that approaches too fast to be left to static contact, with rigid
/// velocities and arms at the end (section 3.2). Closer than the rest distance that is faster than the threshold.
/// Farther away, up to the proximity distance, it is also fast enough to come below the rest distance within one more
/// step: stage 7 would cut exactly these approaches to (d_rest - d)/dt, and a fast body that happens to end a step
/// there would lose its rebound. Of a point on its way down an arc (arc.hpp) the speed counts with which it arrives:
/// those ahead of the contact of a wheel come down fast, and a wheel that sinks by the little that a facet makes it
/// sink would collide with the ground at all of them.
struct EndProximity {
    std::optional<ContactPoint> point;
    std::optional<Landing> landing{}; ///< of the point
    bool near = false;                ///< some features are within the proximity distance, whether they approach or not
};
[[nodiscard]] EndProximity end_proximity(const StepView& view, Worker& worker, const PairRecord& pair);

/// What stage 1 finds of the present motion of a pair.
struct CollisionFinding {
    PairHit hit;                        ///< the earliest, if there is any
    Verdict verdict = Verdict::open;    ///< of the continuous query
    bool processed = false;             ///< it hits, or is near at its end: stage 7 acts on it
    std::optional<ContactPoint> urgent; ///< of the hit, or else the end proximity: what calls for an impulse
    std::optional<Landing> landing{};   ///< of that
};
/// By the setting `ccd`. A function of the motion alone, as examine(): `cache` saves work, and nothing is recorded.
[[nodiscard]] CollisionFinding find_collision(const StepView& view, Worker& worker, const PairRecord& pair,
                                              PairCache& cache);

/// find_collision(), recorded; fills worker.hits with what calls for an impulse, the earliest first, and what hits at
/// the same time, and worker.landing. Returns whether there is any. `grounds`: to a hit on one of these is added what
/// hits the others at the same time; null: nothing is.
/// `known`: what find_collision() returns of the present motion; null: it is asked.
bool find_hits(const StepView& view, Worker& worker, PairRecord& pair, const Grounds* grounds = nullptr,
               const CollisionFinding* known = nullptr);

/// find_collision() ahead of the pair's turn, recorded where nothing calls for an impulse: what its turn would do if it
/// came now.
CollisionFinding look_at(const StepView& view, Worker& worker, PairRecord& pair);

} // namespace flotilla
