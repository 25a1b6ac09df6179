// SPDX-License-Identifier: MIT
#include "pair/neighbour_lists.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "ccd/rigid_path.hpp"
#include "pair/pair_distance.hpp"

namespace flotilla {
namespace {

// Pairs that move less than this against each other in a step, in proximity distances, keep a list for many steps.
constexpr double kRestingWay = 1.0 / 16;
constexpr std::int32_t kUsesBeforeRefining = 4;
constexpr double kSlowMargin = 0.5, kSmallestMargin = 3, kLargestMargin = 6; // proximity distances

/// How far the motion may stray from the one a new list is made for, of a pair whose displacements add up to
/// `displacement`.
CandidateMargins choose_margins(const PairCandidates& c, double proximity, double displacement) {
    const double base = proximity;
    if (displacement < base) return {kSlowMargin * base, std::clamp(2 * c.last_strayed, kSlowMargin * base, base)};
    // A fast pair starts the next step elsewhere: its list serves this step only, whose start states are fixed.
    return {0, std::clamp(2 * c.last_strayed, kSmallestMargin * base, kLargestMargin * base)};
}

/// Counts a query of the step; whether it is the first.
bool count_query(PairCandidates& c, std::int64_t step) {
    const bool first = c.step != step;
    if (first) {
        c.busy = c.queries > 1 && c.step + 1 == step;
        c.step = step;
        c.queries = 0;
    }
    ++c.queries;
    return first;
}

/// The making of a list for the present motion of a pair.
struct Making {
    const StepView& view;
    const PairRecord& pair;
    const BodyMotion &a, &b;
    double displacement = displacement_of(a, b); ///< m

    [[nodiscard]] bool resting() const { return displacement < kRestingWay * pair.lengths.proximity; }
    [[nodiscard]] CandidateReach reach() const {
        const double separation = largest_query_separation(view.model.settings, pair.lengths);
        return {swept_reach(separation, a, b), pair.lengths.proximity};
    }
    [[nodiscard]] CandidateMargins margins(const PairCandidates& c) const {
        return choose_margins(c, pair.lengths.proximity, displacement);
    }
};

/// Makes the list of a resting pair again, by the distances of its features: one that covered the motion often.
CoveringList refine(const Making& making, PairCandidates& c, ListingScratch& scratch) {
    if (!c.list.build(making.a, making.b, making.reach(), making.margins(c), true, scratch)) return {};
    return {&c.list, {}};
}

/// Makes a list where there is none that covers the motion, if that seems to pay. `first`: of the queries of the step.
CoveringList make_list(const Making& making, PairCandidates& c, bool first, ListingScratch& scratch) {
    const CandidateMargins margins = making.margins(c);
    const bool of_leaves = margins.start == 0 && making.view.model.settings.ccd == CcdMethod::conservative;
    // One of leaves is made in less time than a query takes without it.
    if (!of_leaves && ((first && !c.busy && margins.start == 0) || !c.paid)) {
        c.list.drop();
        c.paid = true;
        return {};
    }
    const bool built = of_leaves ? c.list.build_of_leaves(making.a, making.b, making.reach(), margins.end, scratch)
                                 : c.list.build(making.a, making.b, making.reach(), margins, making.resting(), scratch);
    return built ? CoveringList{&c.list, {}} : CoveringList{};
}

/// A plane that was found between convex bodies of few vertices. By now it may be none, which slice_features() tells.
QueryAid plane_aid(const StepView& view, const PairRecord& pair, const PairCache& cache) {
    const PairCandidates* c = cache.candidates.get();
    if (!view.keep_candidates || c == nullptr || c->plane_normal == Vec3{}) return {};
    const auto worth = [&](std::int32_t body) { return worth_slicing(view.model.shape_of(at(body))); };
    return worth(pair.a) && worth(pair.b) ? QueryAid(c->plane_normal) : QueryAid();
}

/// A list that covers the motion, made now if that seems to pay; else null.
CoveringList covering_list(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache,
                           const BodyMotion& a, const BodyMotion& b) {
    if (!view.keep_candidates) return {};
    PairCandidates& c = candidates_of(cache);
    const bool first = count_query(c, view.state.step);
    const bool live = !c.list.empty();
    const CandidateMargins strayed = live ? c.list.strayed(a, b) : CandidateMargins{};
    const bool covers = live && c.list.covers(strayed);
    if (covers && (++c.uses <= kUsesBeforeRefining || c.list.refined())) return {&c.list, strayed};
    const Making making{view, pair, a, b};
    if (covers) return making.resting() ? refine(making, c, worker.ccd.listing) : CoveringList{&c.list, strayed};
    if (live) c.paid = c.uses > 0;
    c.last_strayed = live && !first ? strayed.end : 0;
    c.uses = 0;
    return make_list(making, c, first, worker.ccd.listing);
}

CoveringList end_list(const StepView& view, const PairRecord& pair) {
    const PairCandidates* c = pair.cache.candidates.get();
    if (!view.keep_candidates || c == nullptr || c->list.empty()) return {};
    const BodyMotion a = view.trajectories.motion(at(pair.a)), b = view.trajectories.motion(at(pair.b));
    const CandidateMargins strayed{0, c->list.strayed_at_end(a, b)};
    return c->list.covers(strayed) ? CoveringList{&c->list, strayed} : CoveringList{};
}

} // namespace

QueryAid swept_aid(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache, const BodyMotion& a,
                   const BodyMotion& b, CcdMethod method) {
    const QueryAid plane = method == CcdMethod::conservative ? plane_aid(view, pair, cache) : QueryAid();
    return plane.direction != Vec3{} ? plane : QueryAid(covering_list(view, worker, pair, cache, a, b));
}

QueryAid end_aid(const StepView& view, const PairRecord& pair) {
    const QueryAid plane = plane_aid(view, pair, pair.cache);
    return plane.direction != Vec3{} ? plane : QueryAid(end_list(view, pair));
}

QueryAid kept_aid(const StepView& view, Worker& worker, PairRecord& pair) {
    const QueryAid plane = plane_aid(view, pair, pair.cache);
    if (plane.direction != Vec3{}) return plane;
    const BodyMotion a = view.trajectories.motion(at(pair.a)), b = view.trajectories.motion(at(pair.b));
    // Bodies that turn so far that queries cut their paths have no use for a list.
    const bool whole = a.arc_gap(1) + b.arc_gap(1) < kArcShare * pair.lengths.rest;
    return whole ? covering_list(view, worker, pair, pair.cache, a, b) : end_list(view, pair);
}

} // namespace flotilla
