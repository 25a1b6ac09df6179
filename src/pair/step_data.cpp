// SPDX-License-Identifier: MIT
#include "pair/step_data.hpp"

#include <atomic>
#include <numbers>
#include <utility>

#include "base/index.hpp"
#include "ccd/hull_gap.hpp"
#include "ccd/rigid_path.hpp"
#include "geometry/ccd_cubic.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

/// What a list of pairs is for.
enum class ListReach { separation, proximity, fall };

double largest_reach(const StepData& data, std::size_t body, ListReach reach) {
    // A pair's lengths are those of its smaller movable body, so with each body's own length as its reach the sum of
    // both is never less than the pair's.
    const PairLengths own = body_lengths(data.model, body);
    switch (reach) {
    case ListReach::separation: return own.separation;
    case ListReach::proximity: return own.proximity;
    case ListReach::fall: break;
    }
    return std::max(own.proximity, fall_in_step(data.model, body));
}

/// What the cubic compares distances with, m.
double cubic_tolerance(const Settings& s) { return s.separation > 0 ? s.separation : kCubicTolerance; }

/// The largest separation that a query with a neighbour list asks for, m.
double largest_separation(const StepData& data, const PairRecord& r) {
    const Settings& s = data.model.settings;
    const double arcs = s.trajectory == Trajectory::rigid ? kArcShare * r.lengths.rest : 0.0;
    const double chord =
        s.ccd == CcdMethod::cubic ? std::max(r.lengths.separation, cubic_tolerance(s)) : r.lengths.separation;
    return chord + arcs;
}

// Pairs that move less than this against each other in a step, in proximity distances, keep a list for many steps.
constexpr double kRestingWay = 1.0 / 16;
constexpr std::int32_t kUsesBeforeRefining = 4;
constexpr double kSlowMargin = 0.5, kSmallestMargin = 3, kLargestMargin = 6; // proximity distances

/// A bound on how far the bodies' places at the end are from those at x^n, against each other and along any axis, m.
/// Bodies that move straight are no farther in between.
double way_of(const BodyMotion& a, const BodyMotion& b) {
    return relative_displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at1), *b.shape, matrix_pose(b.at0),
                                 matrix_pose(b.at1));
}

/// How far the motion may stray from the one a new list is made for.
CandidateMargins choose_margins(const PairRecord& r, double way) {
    const double base = r.lengths.proximity;
    if (way < base) return {kSlowMargin * base, std::clamp(2 * r.candidates->last_strayed, kSlowMargin * base, base)};
    // A fast pair starts the next step elsewhere: its list serves this step only, whose start states are fixed.
    return {0, std::clamp(2 * r.candidates->last_strayed, kSmallestMargin * base, kLargestMargin * base)};
}

PairCandidates& candidates_of(PairRecord& r) {
    if (r.candidates == nullptr) r.candidates = std::make_unique<PairCandidates>();
    return *r.candidates;
}

/// A list that covers the motion, made now if that seems to pay; else null.
CoveringList candidates(const StepData& data, Worker& worker, PairRecord& r, const BodyMotion& a, const BodyMotion& b) {
    if (!data.keep_candidates) return {};
    PairCandidates& c = candidates_of(r);
    const bool first = c.step != data.state.step;
    if (first) {
        c.busy = c.queries > 1 && c.step + 1 == data.state.step;
        c.step = data.state.step;
        c.queries = 0;
    }
    ++c.queries;
    const bool live = !c.list.empty();
    const CandidateMargins strayed = live ? c.list.strayed(a, b) : CandidateMargins{};
    const bool covers = live && c.list.covers(strayed);
    if (covers && (++c.uses <= kUsesBeforeRefining || c.list.refined())) return {&c.list, strayed};
    const double way = way_of(a, b);
    const bool resting = way < kRestingWay * r.lengths.proximity;
    if (covers && !resting) return {&c.list, strayed};
    const CandidateReach reach{swept_reach(largest_separation(data, r), a, b), r.lengths.proximity};
    if (covers) {
        if (!c.list.build(a, b, reach, choose_margins(r, way), true, worker.ccd.listing)) return {};
        return {&c.list, {}};
    }
    if (live) c.paid = c.uses > 0;
    c.last_strayed = live && !first ? strayed.end : 0;
    c.uses = 0;
    const CandidateMargins margins = choose_margins(r, way);
    const bool of_leaves = margins.start == 0 && data.model.settings.ccd == CcdMethod::conservative;
    // One of leaves is made in less time than a query takes without it.
    if (!of_leaves && ((first && !c.busy && margins.start == 0) || !c.paid)) {
        c.list.drop();
        c.paid = true;
        return {};
    }
    const bool built = of_leaves ? c.list.build_of_leaves(a, b, reach, margins.end)
                                 : c.list.build(a, b, reach, margins, resting, worker.ccd.listing);
    return built ? CoveringList{&c.list, {}} : CoveringList{};
}

} // namespace

double start_distance(const StepData& data, Worker& worker, PairRecord& r) {
    if (r.start_distance < 0 || r.doubt > 0) { // paths that turn are cut by it: it must be exact
        const ProximityResult result =
            find_proximities(data.trajectories.at_start(at(r.a)), data.trajectories.at_start(at(r.b)),
                             r.lengths.proximity, data.angle_cos, {}, worker.proximity);
        r.start_distance = result.near ? result.distance : std::numeric_limits<double>::infinity();
        r.doubt = 0;
    }
    return r.start_distance;
}

namespace {

constexpr double kRoundingRoom = 0x1p-20;   // of lengths compared, far above the rounding of either
constexpr double kVertexRounding = 0x1p-40; // of the largest coordinate: far above that of world vertices
constexpr double kClearOfSeparation = 2;

/// Of bodies that turn on the way, in arc_gap(1) of both: points leave the chords by one, a query cuts the paths, which
/// brings its chords nearer by one, and adds one to the separation, which counts kClearOfSeparation times.
constexpr double kArcRoom = 2 + kClearOfSeparation;

/// A bound on how much the distance of the bodies changes from x^n to the end, m. In between as well where they move
/// straight.
double change_of_distance(const BodyMotion& a, const BodyMotion& b) {
    return (1 + kRoundingRoom) * std::numbers::sqrt3 * way_of(a, b) +
           kVertexRounding * std::max(a.max_abs(), b.max_abs());
}

/// Whether the bodies, whose distance at x^n is known, move too little to come near the separation at any time: a proof
/// of the same thing as the query's, which then has nothing to find.
bool stay_apart(const StepData& data, const PairRecord& r, const BodyMotion& a, const BodyMotion& b) {
    if (!data.keep_candidates || r.start_distance < 0) return false;
    const double from = std::min(r.start_distance - r.doubt, r.lengths.proximity); // infinite: beyond that
    const double change = change_of_distance(a, b) + kArcRoom * (a.arc_gap(1) + b.arc_gap(1));
    return (1 - kRoundingRoom) * from - change > kClearOfSeparation * r.lengths.separation;
}

/// Whether a plane is found that keeps the bodies farther apart than `reach`, m, all the time. Where it keeps them
/// beyond the proximity distance at the end, that is remembered.
bool plane_between(const StepData& data, PairRecord& r, const BodyMotion& a, const BodyMotion& b, double reach) {
    // Hulls that overlap are likely to do so again, and a failed search costs a sixth of a query: with none left out
    // detection in the impact of 252 boats costs 13 % more, with one 4 %.
    constexpr std::int32_t kLeftOut = 8;
    if (!data.keep_candidates || !a.straight() || !b.straight()) return false;
    // Slow pairs have lists that last, and know how far they are from each other.
    if (way_of(data.trajectories.motion(at(r.a)), data.trajectories.motion(at(r.b))) < r.lengths.proximity)
        return false;
    PairCandidates& c = candidates_of(r);
    if (c.no_plane > 0) {
        --c.no_plane;
        return false;
    }
    const HullGap gap = find_hull_gap(a, b, r.lengths.proximity, c.apart);
    if (gap.end > r.lengths.proximity) {
        c.far_a = data.trajectories.version(at(r.a));
        c.far_b = data.trajectories.version(at(r.b));
        c.far_gap = gap.end;
    }
    if (std::min(gap.start, gap.end) > reach) return true;
    if (!(gap.end > 0)) {
        c.apart = {};
        c.no_plane = kLeftOut;
    }
    return false;
}

/// Whether the bodies move less against each other in the step than the record's slack, along any axis: then they do
/// not come near the separation, and at the end they are nearer than the proximity distance if and only if they were so
/// at x^n.
bool stay_by_bounds(const StepData& data, const PairRecord& r) {
    const std::vector<BodyBounds>& bounds = data.lists.bounds;
    return data.keep_candidates && (1 + kRoundingRoom) * (bounds[at(r.a)].way + bounds[at(r.b)].way) < r.slack;
}

/// Does what the operation of a listed pair would do, where bounds say that it would find nothing.
bool prove_by_bounds(const StepData& data, PairRecord& r, bool with_proximity) {
    if (!stay_by_bounds(data, r)) return false;
    if (with_proximity) { // stage 1: a cubic's miss proves nothing, and it looks for proximities that approach
        const std::vector<BodyBounds>& bounds = data.lists.bounds;
        const double speed = (1 + kRoundingRoom) * (bounds[at(r.a)].speed + bounds[at(r.b)].speed);
        const Settings& s = data.model.settings;
        if (s.ccd == CcdMethod::cubic || s.collision_pair_iterations == 0)
            return false; // without iterations it does nothing
        if (!(speed < (1 - kRoundingRoom) * data.approach)) return false;
        r.assumed = !r.processed && r.start_distance < r.lengths.proximity;
        r.processed = r.processed || r.assumed;
    }
    r.proved_a = data.trajectories.version(at(r.a));
    r.proved_b = data.trajectories.version(at(r.b));
    return true;
}

PairHit search(const StepData& data, Worker& worker, PairRecord& r, CcdMethod method) {
    if (data.model.ignores(r.a, r.b)) return {}; // members of clusters meet in no list
    // Two bodies bitwise at x^n stand where the last step left them, apart (way d).
    if (data.trajectories.still(at(r.a)) && data.trajectories.still(at(r.b))) return {};
    const BodyMotion a = data.trajectories.motion(at(r.a)), b = data.trajectories.motion(at(r.b));
    if (method == CcdMethod::conservative && stay_apart(data, r, a, b)) return {};
    const Stopwatch watch(worker.counters.detection_ms); // reading the clock costs as much as what comes before
    if (method == CcdMethod::conservative && plane_between(data, r, a, b, kClearOfSeparation * r.lengths.separation))
        return {};
    const double separation = method == CcdMethod::cubic ? cubic_tolerance(data.model.settings) : r.lengths.separation;
    const bool turns = !a.straight() || !b.straight();
    const PathCut cut = turns ? cut_path(a, b, {r.lengths.rest, start_distance(data, worker, r)}) : PathCut{};
    return earliest_hit_on_path(a, b, {separation, CcdStart::relaxed, method}, cut,
                                cut.segments == 1 ? candidates(data, worker, r, a, b) : CoveringList{}, worker.ccd);
}

constexpr std::size_t kBodyGrain = 128, kPairGrain = 256; // items of a task

constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// For slacks, which are compared as change_of_distance() compares.
double way_of(const BodyMotion& body) {
    const double ends = displacement(*body.shape, matrix_pose(body.at0), matrix_pose(body.at1));
    return body.straight() ? ends : ends + kArcRoom / std::numbers::sqrt3 * body.arc_gap(1);
}

double speed_of(const StepData& data, std::size_t body) {
    const Impulsive mover = data.clusters.impulsive(data.clusters.of(body));
    return length(mover.velocity) + length(mover.angular_velocity) * data.model.shape_of(body).radius;
}

void set_bounds(StepData& data, std::size_t body, const Box& box, ListReach reach, bool with_speed) {
    const bool movable = data.model.bodies[body].movable();
    data.lists.swept[body] = {box, movable ? largest_reach(data, body, reach) : 0.0, movable};
    data.lists.bounds[body] = {way_of(data.trajectories.motion(body)), with_speed ? speed_of(data, body) : kUnknown};
}

/// Boxes and bounds of the bodies that stand still, once for as long as the same ones do.
void place_still(StepData& data) {
    ListBuffers& l = data.lists;
    if (l.still_placed == l.still_version) return;
    const std::size_t n = data.model.size();
    l.swept.resize(n);
    l.bounds.resize(n);
    data.team.for_each("bounds of still bodies", n, kBodyGrain, [&](std::size_t i, int) {
        const Body& body = data.model.bodies[i];
        if (body.movable() || body.scripted()) return;
        const double waking = body.dynamic() ? largest_reach(data, i, ListReach::proximity) : 0.0;
        l.swept[i] = {data.trajectories.at_start(i).swept(), 0, false, waking, body.present};
        l.bounds[i] = {};
    });
    l.still_placed = l.still_version;
}

PairSearch search_of(const StepData& data, bool wakes = false) {
    return {data.lists.swept,
            data.model.active,
            data.lists.still_version,
            wakes,
            data.savings,
            data.model.filter.empty() ? nullptr : &data.model};
}

/// Candidate pairs of bodies with the given boxes.
template <class BoxOf>
const std::vector<CandidatePair>& find_pairs(StepData& data, const char* name, ListReach reach, bool with_speed,
                                             bool wakes, BoxOf&& box_of) {
    place_still(data);
    const std::vector<std::int32_t>& active = data.model.active;
    data.team.for_each(name, active.size(), kBodyGrain, [&](std::size_t k, int) {
        set_bounds(data, at(active[k]), box_of(at(active[k])), reach, with_speed);
    });
    return data.broadphase.find(data.team, search_of(data, wakes));
}

Box swept_box(const StepData& data, std::size_t body) { return data.trajectories.motion(body).swept(); }

ListReach reach_of(bool with_proximity) { return with_proximity ? ListReach::proximity : ListReach::separation; }

/// The same of swept boxes, where the last list was made of them and only some bodies changed since then.
const std::vector<CandidatePair>& update_pairs(StepData& data, std::span<const std::int32_t> changed,
                                               bool with_proximity) {
    for (const std::int32_t i : changed)
        set_bounds(data, at(i), swept_box(data, at(i)), reach_of(with_proximity), with_proximity);
    return data.broadphase.update(data.team, search_of(data), changed);
}

/// Those of the pairs that `wanted(pair, record)` wants, the record being null where there is none yet; all of them get
/// one.
template <class Wanted>
const std::vector<ListedPair>& list_pairs(StepData& data, const std::vector<CandidatePair>& pairs, Wanted&& wanted) {
    ListBuffers& l = data.lists;
    l.record.resize(pairs.size());
    l.wanted.resize(pairs.size());
    const auto find = [&](std::size_t begin, std::size_t end) {
        const std::size_t count = end - begin;
        data.pairs.find(std::span(pairs).subspan(begin, count), std::span(l.record).subspan(begin, count));
        std::size_t found = 0;
        for (std::size_t i = begin; i < end; ++i) {
            if (l.record[i] != nullptr) data.pairs.use(*l.record[i]);
            l.wanted[i] = wanted(pairs[i], l.record[i]) ? 1 : 0;
            found += l.wanted[i];
        }
        return found;
    };
    const auto keep = [&](std::size_t begin, std::size_t end, std::size_t place) {
        for (std::size_t i = begin; i < end; ++i)
            if (l.wanted[i] != 0) l.listed[place++] = {pairs[i], l.record[i]};
    };
    const auto resize = [&](std::size_t total) { l.listed.resize(total); };
    compact({&data.team, "pair records", kPairGrain, l.chunk_places}, pairs.size(), find, resize, keep);
    for (ListedPair& p : l.listed) // one thread alone may make records
        if (p.record == nullptr) p.record = &data.pairs.get(data.model, data.state, p.pair.a, p.pair.b);
    return l.listed;
}

} // namespace

void collect(StepData& data, StageCounters& counters) {
    for (const auto& worker : data.workers) {
        StageCounters& c = worker->counters;
        counters.pairs += c.pairs;
        counters.impulses += c.impulses;
        counters.left += c.left;
        counters.detection_ms += c.detection_ms;
        counters.response_ms += c.response_ms;
        c = {};
    }
}

namespace {

/// PairRecord::slack of bodies whose distance, m, is at least `least` and at most `most`.
double slack_of(const StepData& data, const PairRecord& r, double least, double most) {
    const BodyMotion a = data.trajectories.at_end(at(r.a)), b = data.trajectories.at_end(at(r.b));
    const double proximity = r.lengths.proximity;
    // As stay_apart() and near_at_end() compare, with the rounding of vertices one proximity distance farther on at
    // most.
    const double rounding = 2 * kVertexRounding * (std::max(a.max_abs(), b.max_abs()) + proximity);
    const double apart = (1 - kRoundingRoom) * std::min(least, proximity) - kClearOfSeparation * r.lengths.separation;
    const double inside = most < proximity ? (1 - kRoundingRoom) * proximity - most : apart;
    return (1 - kRoundingRoom) * (std::min(apart, inside) - rounding) / ((1 + kRoundingRoom) * std::numbers::sqrt3);
}

/// The same of what it takes to come within the proximity distance from `least`, m.
double slack_of_far(const StepData& data, const PairRecord& r, double least) {
    const BodyMotion a = data.trajectories.at_end(at(r.a)), b = data.trajectories.at_end(at(r.b));
    const double rounding = 2 * kVertexRounding * (std::max(a.max_abs(), b.max_abs()) + r.lengths.proximity);
    return ((1 - kRoundingRoom) * least - r.lengths.proximity - rounding) / ((1 + kRoundingRoom) * std::numbers::sqrt3);
}

} // namespace

void record_distance(const StepData& data, PairRecord& r, const ProximityResult& found, const CoveringList& list) {
    r.end_distance = found.near ? found.distance : std::numeric_limits<double>::infinity();
    r.doubt = 0;
    r.slack = slack_of(data, r, r.end_distance, r.end_distance);
    if (!found.near) r.slack = std::min(r.slack, list.list != nullptr ? list.list->room_at_end(list.strayed.end) : -1);
    if (r.candidates == nullptr) return;
    PairCandidates& c = *r.candidates;
    c.searched_distance = found.near ? found.distance : -1;
    if (!found.near) return;
    c.searched_a = matrix_pose(data.trajectories.at_end(at(r.a)).at0);
    c.searched_b = matrix_pose(data.trajectories.at_end(at(r.b)).at0);
}

void record_renewed_distance(const StepData& data, PairRecord& r, double distance) {
    r.end_distance = r.slack = -1; // where nothing is known
    r.doubt = 0;
    if (r.candidates == nullptr || r.candidates->searched_distance < 0) return;
    const PairCandidates& c = *r.candidates;
    const BodyMotion a = data.trajectories.at_end(at(r.a)), b = data.trajectories.at_end(at(r.b));
    const double moved = (1 + kRoundingRoom) * std::numbers::sqrt3 *
                             relative_displacement(*a.shape, c.searched_a, matrix_pose(a.at0), *b.shape, c.searched_b,
                                                   matrix_pose(b.at0)) +
                         kVertexRounding * std::max(a.max_abs(), b.max_abs());
    const double least = std::min(distance, (1 - kRoundingRoom) * c.searched_distance - moved);
    r.end_distance = distance;
    r.doubt = std::nextafter(static_cast<float>(distance - least), std::numeric_limits<float>::infinity());
    r.slack = slack_of(data, r, least, distance);
}

bool far_by_bounds(const StepData& data, PairRecord& r) {
    if (!(r.start_distance > r.lengths.proximity) || !stay_by_bounds(data, r)) return false;
    r.end_distance = std::numeric_limits<double>::infinity();
    r.slack -= (1 + kRoundingRoom) * (data.lists.bounds[at(r.a)].way + data.lists.bounds[at(r.b)].way);
    return true;
}

bool far_at_end(const StepData& data, const PairRecord& r) {
    return r.candidates != nullptr && r.candidates->far_a == data.trajectories.version(at(r.a)) &&
           r.candidates->far_b == data.trajectories.version(at(r.b));
}

bool far_by_plane(const StepData& data, PairRecord& r) {
    if (!far_at_end(data, r)) {
        const BodyMotion a = data.trajectories.at_end(at(r.a)), b = data.trajectories.at_end(at(r.b));
        if (!plane_between(data, r, a, b, r.lengths.proximity)) return false;
    }
    PairCandidates& c = *r.candidates;
    c.searched_distance = -1;
    r.end_distance = std::numeric_limits<double>::infinity();
    r.doubt = 0;
    r.slack = std::min(slack_of(data, r, c.far_gap, c.far_gap), slack_of_far(data, r, c.far_gap));
    return true;
}

CoveringList end_candidates(const StepData& data, const PairRecord& record) {
    if (!data.keep_candidates || record.candidates == nullptr || record.candidates->list.empty()) return {};
    const CandidateList& list = record.candidates->list;
    const BodyMotion a = data.trajectories.motion(at(record.a)), b = data.trajectories.motion(at(record.b));
    const CandidateMargins strayed{0, list.strayed_at_end(a, b)};
    return list.covers(strayed) ? CoveringList{&list, strayed} : CoveringList{};
}

CoveringList kept_candidates(const StepData& data, Worker& worker, PairRecord& r) {
    const BodyMotion a = data.trajectories.motion(at(r.a)), b = data.trajectories.motion(at(r.b));
    // Bodies that turn so far that queries cut their paths have no use for a list.
    const bool whole = a.arc_gap(1) + b.arc_gap(1) < kArcShare * r.lengths.rest;
    return whole ? candidates(data, worker, r, a, b) : end_candidates(data, r);
}

bool near_at_end(const StepData& data, Worker& worker, const PairRecord& r) {
    const BodyMotion a = data.trajectories.motion(at(r.a)), b = data.trajectories.motion(at(r.b));
    if (data.keep_candidates && r.start_distance >= 0 && r.start_distance < r.lengths.proximity &&
        r.start_distance + change_of_distance(a, b) < (1 - kRoundingRoom) * r.lengths.proximity)
        return true;
    const Stopwatch watch(worker.counters.detection_ms);
    return any_proximity(data.trajectories.at_end(at(r.a)), data.trajectories.at_end(at(r.b)), r.lengths.proximity,
                         end_candidates(data, r), worker.proximity);
}

const std::vector<CandidatePair>& swept_pairs(StepData& data, bool with_proximity) {
    constexpr std::size_t kFew = 64; // a body in so many
    FrozenBounds& frozen = data.lists.frozen;
    const bool known = frozen.pairs != nullptr && frozen.with_proximity == with_proximity;
    frozen.version.resize(data.model.size());
    frozen.changed.clear();
    for (const std::int32_t i : data.model.active) {
        const std::uint64_t version = data.trajectories.version(at(i));
        if (std::exchange(frozen.version[at(i)], version) != version) frozen.changed.push_back(i);
    }
    if (known && frozen.changed.empty()) return *frozen.pairs;
    frozen.with_proximity = with_proximity;
    if (known && frozen.changed.size() * kFew <= data.model.active.size())
        frozen.pairs = &update_pairs(data, frozen.changed, with_proximity);
    else
        frozen.pairs = &find_pairs(data, "swept bounds", reach_of(with_proximity), with_proximity, false,
                                   [&](std::size_t i) { return swept_box(data, i); });
    return *frozen.pairs;
}

const std::vector<CandidatePair>& waking_pairs(StepData& data) {
    data.lists.frozen.pairs = nullptr;
    return find_pairs(data, "waking bounds", ListReach::proximity, true, true,
                      [&](std::size_t i) { return swept_box(data, i); });
}

const std::vector<ListedPair>& freeze(StepData& data, bool with_proximity) {
    std::atomic<std::size_t> by_bounds = 0;
    const auto wanted = [&](const CandidatePair& p, PairRecord* r) {
        if (data.clusters.of(at(p.a)) == data.clusters.of(at(p.b))) return false;
        if (r == nullptr) return true;
        r->assumed = false;
        if (proved(data, *r)) return false;
        const bool by_turns = with_proximity && !data.savings.calm_pairs;
        if (!by_turns && prove_by_bounds(data, *r, with_proximity)) by_bounds.fetch_add(1, std::memory_order_relaxed);
        return true;
    };
    const std::vector<ListedPair>& listed = list_pairs(data, swept_pairs(data, with_proximity), wanted);
    data.lists.num_open = listed.size() - by_bounds;
    return listed;
}

const std::vector<ListedPair>& end_pairs(StepData& data) {
    data.lists.frozen.pairs = nullptr;
    const auto& pairs = find_pairs(data, "end bounds", ListReach::fall, false, false,
                                   [&](std::size_t i) { return data.trajectories.at_end(i).swept(); });
    return list_pairs(data, pairs, [](const CandidatePair&, PairRecord*) { return true; });
}

bool proved(const StepData& data, const PairRecord& r) {
    return r.proved_a == data.trajectories.version(at(r.a)) && r.proved_b == data.trajectories.version(at(r.b));
}

bool missed(const StepData& data, const PairRecord& r) {
    return r.missed_a == data.trajectories.version(at(r.a)) && r.missed_b == data.trajectories.version(at(r.b));
}

bool left(const StepData& data, const PairRecord& r) {
    return r.left_a == data.trajectories.version(at(r.a)) && r.left_b == data.trajectories.version(at(r.b));
}

PairHit query(const StepData& data, Worker& worker, PairRecord& r) {
    const PairHit hit = search(data, worker, r, CcdMethod::conservative);
    if (!hit.hit) {
        r.proved_a = data.trajectories.version(at(r.a));
        r.proved_b = data.trajectories.version(at(r.b));
    }
    return hit;
}

PairHit query_collision(const StepData& data, Worker& worker, PairRecord& r) {
    if (data.model.settings.ccd == CcdMethod::conservative) return query(data, worker, r);
    const PairHit hit = search(data, worker, r, CcdMethod::cubic);
    if (!hit.hit) {
        r.missed_a = data.trajectories.version(at(r.a));
        r.missed_b = data.trajectories.version(at(r.b));
    }
    return hit;
}

ClusterHit query_clusters(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b) {
    ClusterHit best;
    const auto look = [&](PairRecord& r) {
        if (proved(data, r)) return;
        const PairHit hit = query(data, worker, r);
        if (hit.hit && (!best.hit.hit || hit.toi < best.hit.toi)) best = {hit, r.a, r.b};
    };
    for (std::int32_t i : data.clusters[a].members) {
        const Box box_i = data.trajectories.motion(at(i)).swept();
        for (std::int32_t j : data.clusters[b].members) {
            const double reach =
                largest_reach(data, at(i), ListReach::separation) + largest_reach(data, at(j), ListReach::separation);
            if (!boxes_overlap(box_i, data.trajectories.motion(at(j)).swept(), reach)) continue; // way a
            const std::int32_t low = std::min(i, j), high = std::max(i, j);
            if (PairRecord* r = data.pairs.find(low, high)) {
                look(*r);
            } else {
                PairRecord forgotten;
                forgotten.a = low;
                forgotten.b = high;
                forgotten.lengths = pair_lengths(data.model, data.state, low, high);
                look(forgotten);
            }
        }
    }
    return best;
}

SweptContact swept_contact(const StepData& data, const ClusterHit& h) {
    const FeaturePoints p =
        closest_points(data.trajectories.motion(at(h.a)), data.trajectories.motion(at(h.b)), h.hit.features, h.hit.toi);
    const auto arm = [&](std::int32_t body, const Vec3& point) {
        const Cluster& c = data.clusters[data.clusters.of(at(body))];
        const Vec3 com =
            c.infinite() ? data.trajectories.start_pose(at(body)).com : c.com0 + (h.hit.toi * data.dt) * c.velocity;
        return point - com;
    };
    const Vec3 relative = ((p.b1 - p.b0) - (p.a1 - p.a0)) / data.dt;
    return {{h.hit.normal, arm(h.a, p.a), arm(h.b, p.b), relative, pair_friction(data.model, h.a, h.b)},
            dot(h.hit.normal, p.b0 - p.a0)};
}

double pair_friction(const Model& model, std::int32_t a, std::int32_t b) {
    return std::sqrt(model.bodies[at(a)].friction * model.bodies[at(b)].friction);
}

double pair_restitution(const Model& model, std::int32_t a, std::int32_t b) {
    return std::max(model.bodies[at(a)].restitution, model.bodies[at(b)].restitution);
}

void apply_impulse(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
                   const Vec3& impulse) {
    ++worker.counters.impulses;
    if (worker.pushed.empty() || worker.pushed.back() != CandidatePair{a, b}) worker.pushed.push_back({a, b});
    if (data.clusters[a].infinite()) data.clusters.add_work(b, dot(impulse, data.clusters.velocity_at(a, point.arm_a)));
    if (data.clusters[b].infinite())
        data.clusters.add_work(a, -dot(impulse, data.clusters.velocity_at(b, point.arm_b)));
    data.clusters.apply(a, point.arm_a, -impulse);
    data.clusters.apply(b, point.arm_b, impulse);
}

void push(const StepData& data, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
          const Vec3& impulse) {
    const Stopwatch watch(worker.counters.response_ms);
    apply_impulse(data, worker, a, b, point, impulse);
    data.clusters.evolve(a, data.dt, data.trajectories);
    data.clusters.evolve(b, data.dt, data.trajectories);
}

} // namespace flotilla
