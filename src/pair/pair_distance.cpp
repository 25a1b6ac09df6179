// SPDX-License-Identifier: MIT
#include "pair/pair_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "ccd/hull_gap.hpp"
#include "ccd/separation.hpp"
#include "geometry/rounding.hpp"
#include "pair/neighbour_lists.hpp"

namespace flotilla {
namespace {

constexpr double kLess = 1 - kLengthRounding, kMore = 1 + kLengthRounding;

/// Of bodies that turn on the way, in arc_gap(1) of both: points leave the chords by one, a query cuts the paths, which
/// brings its chords nearer by one, and adds one to the separation, which counts kClear times.
constexpr double kArcRoom = 2 + kClear;

constexpr double kFar = std::numeric_limits<double>::infinity();

double clearance(const PairRecord& pair) { return kClear * pair.lengths.separation; }

double rounding_of(const BodyMotion& a, const BodyMotion& b) {
    return place_rounding(std::max(a.max_abs(), b.max_abs()));
}

/// A bound on how much the distance of the bodies changes from x^n to the end, m. In between as well where they move
/// straight.
double change_of_distance(const BodyMotion& a, const BodyMotion& b) {
    return kMore * std::numbers::sqrt3 * displacement_of(a, b) + rounding_of(a, b);
}

/// The displacement bounds of both bodies together, m.
double displacement_by_bounds(const StepView& view, const PairRecord& pair) {
    return kMore * (view.bounds[at(pair.a)].displacement + view.bounds[at(pair.b)].displacement);
}

/// The bodies at the end of the step, for the slack with which the next one begins.
struct Ends {
    BodyMotion a, b;
    double proximity, clear; ///< m

    Ends(const StepView& view, const PairRecord& pair)
        : a(view.trajectories.at_end(at(pair.a))),
          b(view.trajectories.at_end(at(pair.b))),
          proximity(pair.lengths.proximity),
          clear(clearance(pair)) {}

    /// Of vertices one proximity distance farther on at most, before and after the move.
    [[nodiscard]] double rounding() const { return 2 * place_rounding(std::max(a.max_abs(), b.max_abs()) + proximity); }
    /// PairCache::slack of bodies whose distance, m, is at least `least` and at most `most`: what keeps the answers of
    /// apart_by_distance() and near_at_end().
    [[nodiscard]] double slack(double least, double most) const {
        const double apart = kLess * std::min(least, proximity) - clear;
        const double inside = most < proximity ? kLess * proximity - most : apart;
        return kLess * (std::min(apart, inside) - rounding()) / (kMore * std::numbers::sqrt3);
    }
    /// The same of what it takes to come within the proximity distance from `least`, m.
    [[nodiscard]] double slack_of_far(double least) const {
        return (kLess * least - proximity - rounding()) / (kMore * std::numbers::sqrt3);
    }
};

} // namespace

double displacement_of(const BodyMotion& a, const BodyMotion& b) {
    return relative_displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at1), *b.shape, matrix_pose(b.at0),
                                 matrix_pose(b.at1));
}

double displacement_of(const BodyMotion& body) {
    const double ends = displacement(*body.shape, matrix_pose(body.at0), matrix_pose(body.at1));
    return body.straight() ? ends : ends + kArcRoom / std::numbers::sqrt3 * body.arc_gap(1);
}

double start_distance(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache) {
    if (cache.start_distance < 0 || cache.doubt > 0) { // paths that turn are cut by it: it must be exact
        const ProximityResult result =
            find_proximities(view.trajectories.at_start(at(pair.a)), view.trajectories.at_start(at(pair.b)),
                             pair.lengths.proximity, view.angle_cos, {}, worker.proximity);
        cache.start_distance = result.near ? result.distance : kFar;
        cache.doubt = 0;
    }
    return cache.start_distance;
}

bool stays_by_bounds(const StepView& view, const PairRecord& pair) {
    return view.keep_candidates && displacement_by_bounds(view, pair) < pair.cache.slack;
}

bool apart_by_distance(const StepView& view, const PairRecord& pair, const BodyMotion& a, const BodyMotion& b) {
    const PairCache& known = pair.cache;
    if (!view.keep_candidates || known.start_distance < 0) return false;
    const double from = std::min(known.start_distance - known.doubt, pair.lengths.proximity); // infinite: beyond that
    const double change = change_of_distance(a, b) + kArcRoom * (a.arc_gap(1) + b.arc_gap(1));
    return kLess * from - change > clearance(pair);
}

namespace {

bool is_convex(const BodyMotion& a, const BodyMotion& b) { return a.shape->convex && b.shape->convex; }

/// Whether a plane is found that keeps the bodies farther apart than `reach`, m, all the time.
bool plane_between(const StepView& view, const PairRecord& pair, PairCache& cache, const BodyMotion& a,
                   const BodyMotion& b, double reach) {
    // Hulls that overlap are likely to do so again, and a failed search costs a sixth of a query: with none left out
    // detection in the impact of 252 boats costs 13 % more, with one 4 %.
    constexpr std::int32_t kLeftOut = 8;
    if (!view.keep_candidates || !a.straight() || !b.straight()) return false;
    const bool far = cache.start_distance > pair.lengths.proximity, convex = is_convex(a, b);
    // Slow pairs have lists that last, and know how far they are from each other. Where both are convex the plane of
    // their contact costs less still; but near ones have none that makes them far.
    const bool hopeful = convex && (far || reach < pair.lengths.proximity);
    if (!hopeful && displacement_of(view.trajectories.motion(at(pair.a)), view.trajectories.motion(at(pair.b))) <
                        pair.lengths.proximity)
        return false;
    PairCandidates& c = candidates_of(cache);
    if (c.no_plane > 0) {
        --c.no_plane;
        return false;
    }
    const HullGap gap = find_hull_gap(a, b, convex && !far ? reach : pair.lengths.proximity, c.plane_normal);
    if (gap.end > pair.lengths.proximity) {
        c.far_a = view.trajectories.version(at(pair.a));
        c.far_b = view.trajectories.version(at(pair.b));
        c.far_gap = gap.end;
    }
    if (std::min(gap.start, gap.end) > reach) return true;
    // Of convex bodies it is the best there is to slice by, and once they are apart again there is a plane.
    if (!(gap.end > 0) && !worth_slicing(a, b)) {
        c.plane_normal = {};
        c.no_plane = kLeftOut;
    }
    return false;
}

} // namespace

bool apart_by_plane(const StepView& view, const PairRecord& pair, PairCache& cache, const BodyMotion& a,
                    const BodyMotion& b) {
    return plane_between(view, pair, cache, a, b, clearance(pair));
}

bool near_at_end(const StepView& view, Worker& worker, const PairRecord& pair) {
    const BodyMotion a = view.trajectories.motion(at(pair.a)), b = view.trajectories.motion(at(pair.b));
    const double from = pair.cache.start_distance, proximity = pair.lengths.proximity;
    if (view.keep_candidates && from >= 0 && from < proximity && from + change_of_distance(a, b) < kLess * proximity)
        return true;
    const Stopwatch watch(worker.counters.detection_ms);
    return any_proximity(view.trajectories.at_end(at(pair.a)), view.trajectories.at_end(at(pair.b)), proximity,
                         end_aid(view, pair), worker.proximity);
}

bool far_by_bounds(const StepView& view, PairRecord& pair) {
    if (!(pair.cache.start_distance > pair.lengths.proximity) || !stays_by_bounds(view, pair)) return false;
    pair.cache.end_distance = kFar;
    pair.cache.slack -= displacement_by_bounds(view, pair);
    return true;
}

bool far_by_known_plane(const StepView& view, const PairRecord& pair) {
    const PairCandidates* c = pair.cache.candidates.get();
    return c != nullptr && c->far_a == view.trajectories.version(at(pair.a)) &&
           c->far_b == view.trajectories.version(at(pair.b));
}

bool far_by_plane(const StepView& view, PairRecord& pair) {
    PairCache& cache = pair.cache;
    const bool known = far_by_known_plane(view, pair);
    // Bodies that were not far are near, most likely, and where a plane is known slices tell sooner that they are not.
    if (!known && cache.start_distance < pair.lengths.proximity && end_aid(view, pair).direction != Vec3{})
        return false;
    const Ends ends(view, pair);
    if (!known && !plane_between(view, pair, cache, ends.a, ends.b, ends.proximity)) return false;
    PairCandidates& c = *cache.candidates;
    c.searched_distance = -1;
    cache.end_distance = kFar;
    cache.doubt = 0;
    cache.slack = std::min(ends.slack(c.far_gap, c.far_gap), ends.slack_of_far(c.far_gap));
    return true;
}

void record_distance(const StepView& view, PairRecord& pair, const ProximityResult& found, const CoveringList& list) {
    PairCache& cache = pair.cache;
    cache.end_distance = found.near ? found.distance : kFar;
    cache.doubt = 0;
    const Ends ends(view, pair);
    cache.slack = ends.slack(cache.end_distance, cache.end_distance);
    if (!found.near)
        cache.slack = std::min(cache.slack, list.list != nullptr ? list.list->room_at_end(list.strayed.end) : -1);
    if (cache.candidates == nullptr) return;
    PairCandidates& c = *cache.candidates;
    c.searched_distance = found.near ? found.distance : -1;
    if (!found.near) return;
    c.searched_a = matrix_pose(ends.a.at0);
    c.searched_b = matrix_pose(ends.b.at0);
}

void record_plane(const BodyMotion& a, const BodyMotion& b, std::span<const ProximityPoint> points, PairRecord& pair) {
    if (points.empty() || !is_convex(a, b)) return;
    const auto nearest = std::ranges::min_element(points, {}, &ProximityPoint::distance);
    PairCandidates& c = candidates_of(pair.cache);
    c.plane_normal = nearest->normal;
    c.no_plane = 0;
}

void record_renewed_distance(const StepView& view, PairRecord& pair, double distance) {
    PairCache& cache = pair.cache;
    cache.end_distance = cache.slack = -1; // where nothing is known
    cache.doubt = 0;
    if (cache.candidates == nullptr || cache.candidates->searched_distance < 0) return;
    const PairCandidates& c = *cache.candidates;
    const Ends ends(view, pair);
    const double moved = kMore * std::numbers::sqrt3 *
                             relative_displacement(*ends.a.shape, c.searched_a, matrix_pose(ends.a.at0), *ends.b.shape,
                                                   c.searched_b, matrix_pose(ends.b.at0)) +
                         rounding_of(ends.a, ends.b);
    const double least = std::min(distance, kLess * c.searched_distance - moved);
    cache.end_distance = distance;
    cache.doubt = std::nextafter(static_cast<float>(distance - least), std::numeric_limits<float>::infinity());
    cache.slack = ends.slack(least, distance);
}

} // namespace flotilla
