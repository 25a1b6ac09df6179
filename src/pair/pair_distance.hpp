// SPDX-License-Identifier: MIT
// What is known of the distance of two bodies, from the last search for their contacts and from bounds on how far they
// moved since then, and the queries that this saves (README.md). Each question is answered as the query would answer.
#pragma once

#include "pair/pair_table.hpp"
#include "pair/step_view.hpp"
#include "pair/worker.hpp"

namespace flotilla {

/// A bound on how far the bodies' places at the end are from those at x^n, against each other and along any axis, m.
/// Bodies that move straight are no farther in between.
[[nodiscard]] double displacement_of(const BodyMotion& a, const BodyMotion& b);
/// The same of one body against what stands still, with room for the arcs of one that turns on the way: what
/// stays_by_bounds() compares with a slack.
[[nodiscard]] double displacement_of(const BodyMotion& body);

/// The distance of the bodies at x^n, m, from the last contact search where that searched the pair; infinite beyond the
/// proximity distance.
double start_distance(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache);

// Apart: no hit on the whole way.

/// Whether the displacement bounds of both bodies together are below the pair's slack: then they do not come near the
/// separation, and at the end they are nearer than the proximity distance if and only if they were so at x^n.
[[nodiscard]] bool stays_by_bounds(const StepView& view, const PairRecord& pair);
/// Whether the bodies, whose distance at x^n is known, move too little to come near the separation at any time: a proof
/// of the same thing as the query's, which then has nothing to find.
[[nodiscard]] bool apart_by_distance(const StepView& view, const PairRecord& pair, const BodyMotion& a,
                                     const BodyMotion& b);
/// Whether a plane is found that keeps the bodies apart all the time. Where it keeps them beyond the proximity distance
/// at the end, the cache has that for far_by_plane().
[[nodiscard]] bool apart_by_plane(const StepView& view, const PairRecord& pair, PairCache& cache, const BodyMotion& a,
                                  const BodyMotion& b);

// Near and far: within and beyond the proximity distance at the end of the step.

/// Whether features of the bodies come within the proximity distance at the end of the step.
[[nodiscard]] bool near_at_end(const StepView& view, Worker& worker, const PairRecord& pair);
/// Whether bodies that were beyond the proximity distance at x^n still are at the end of the step, by bounds alone.
/// Then there is nothing to search for, and the cache has it for the next step.
[[nodiscard]] bool far_by_bounds(const StepView& view, PairRecord& pair);
/// Whether a plane that is known keeps the bodies beyond the proximity distance at the end of the step.
[[nodiscard]] bool far_by_known_plane(const StepView& view, const PairRecord& pair);
/// Whether there is such a plane, known or found now: then there is nothing to search for, and the cache has it for the
/// next step.
[[nodiscard]] bool far_by_plane(const StepView& view, PairRecord& pair);

/// Keeps what the contact search found of the pair, for the next step.
void record_distance(const StepView& view, PairRecord& pair, const ProximityResult& found, const CoveringList& list);
/// And the plane of the nearest of their contact points, where both bodies are convex.
void record_plane(const BodyMotion& a, const BodyMotion& b, std::span<const ProximityPoint> points, PairRecord& pair);
/// The same where there was no search: the bodies are at most `distance` (m) apart, which is within the proximity
/// distance.
void record_renewed_distance(const StepView& view, PairRecord& pair, double distance);

} // namespace flotilla
