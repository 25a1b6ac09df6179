// SPDX-License-Identifier: MIT
#include "pair/examine.hpp"

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "ccd/rigid_path.hpp"
#include "pair/neighbour_lists.hpp"
#include "pair/pair_distance.hpp"

namespace flotilla {
namespace {

PairHit earliest_hit_of(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache,
                        CcdMethod method) {
    if (view.model.ignores(pair.a, pair.b)) return {}; // members of clusters meet in no list
    // Two bodies bitwise at x^n stand where the last step left them, apart (way d).
    if (view.trajectories.still(at(pair.a)) && view.trajectories.still(at(pair.b))) return {};
    const BodyMotion a = view.trajectories.motion(at(pair.a)), b = view.trajectories.motion(at(pair.b));
    const bool conservative = method == CcdMethod::conservative;
    if (conservative && apart_by_distance(view, pair, a, b)) return {};
    const Stopwatch watch(worker.counters.detection_ms); // reading the clock costs as much as what comes before
    if (conservative && apart_by_plane(view, pair, cache, a, b)) return {};
    const double separation = query_separation(view.model.settings, pair.lengths, method);
    const bool turns = !a.straight() || !b.straight();
    const PathCut cut =
        turns ? cut_path(a, b, {pair.lengths.rest, start_distance(view, worker, pair, cache)}) : PathCut{};
    const QueryAid aid = cut.segments == 1 ? swept_aid(view, worker, pair, cache, a, b, method) : QueryAid{};
    return earliest_hit_on_path(a, b, {separation, CcdStart::relaxed, method}, cut, aid, worker.ccd);
}

} // namespace

PairFinding examine(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache, CcdMethod method) {
    PairFinding out{earliest_hit_of(view, worker, pair, cache, method), Verdict::open};
    // What the cubic takes for a miss proves nothing.
    if (!out.hit.hit) out.verdict = method == CcdMethod::conservative ? Verdict::apart : Verdict::settled;
    return out;
}

PairHit query(const StepView& view, Worker& worker, PairRecord& pair) {
    const PairFinding found = examine(view, worker, pair, pair.cache, CcdMethod::conservative);
    commit(view.trajectories, pair, found.verdict);
    return found.hit;
}

} // namespace flotilla
