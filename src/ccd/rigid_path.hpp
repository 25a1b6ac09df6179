// SPDX-License-Identifier: MIT
// Earliest collision of a body pair along the turning paths of both bodies (`trajectory: rigid`).
//
// The centre of mass moves on a straight line, the orientation is R(t w) q with the rotation vector w of the whole
// step. The step is cut into k = 1, 2, 4, ... segments of equal angle. In each, the chords of the vertices go through
// the linear query, with the separation s + g, where g bounds how far the vertices of both bodies together are from
// their chords: what the linear query proves apart by s + g is apart by s on the arcs. k grows until g is below a tenth
// of min(d0, d_rest), d0 being the distance at the start, so that the detour costs no more room than that.
//
// Bodies that start nearer than s + g: as for straight paths, the separation becomes 0.95 d0, less g on the arcs. All
// segments use the same one. d0 is a guide: were it wrong, more hits would be reported, never fewer. Where 64 segments
// leave too little of it, the motion cannot be proved and is a hit.
#pragma once

#include "ccd/pair_query.hpp"

namespace flotilla {

inline constexpr int kMaxSegments = 64;

struct PathLengths {
    double rest = 0;           ///< d_rest, m
    double start_distance = 0; ///< d0, m; infinite where it is beyond the proximity distance
};

/// How a pair's paths are cut.
struct PathCut {
    int segments = 1;
    double gap = 0;            ///< g, m; zero where no body turns
    double start_distance = 0; ///< d0, m
};
[[nodiscard]] PathCut cut_path(const BodyMotion& a, const BodyMotion& b, const PathLengths& lengths);

/// As earliest_hit, which it is where no body turns. "No hit" of the conservative method proves both bodies farther
/// apart than min(separation, 0.95 d0 - g) on their paths. The cubic tests the chords with its own tolerance. `aid`:
/// only where there is one segment; a list must reach swept_reach(separation + kArcShare * rest).
[[nodiscard]] PairHit earliest_hit_on_path(const BodyMotion& a, const BodyMotion& b, const HitOptions& options,
                                           const PathCut& cut, const QueryAid& aid, CcdScratch& scratch);

} // namespace flotilla
