// SPDX-License-Identifier: MIT
#include "pair/step_data.hpp"

#include "ccd/rigid_path.hpp"
#include "geometry/ccd_cubic.hpp"

namespace flotilla {
namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

double largest_reach(const StepData& data, std::size_t body, bool with_proximity) {
    // A pair's lengths are those of its smaller movable body, so with each body's own length as its reach the sum of both is
    // never less than the pair's.
    const Settings& s = data.model.settings;
    const double rest = s.rest_distance > 0 ? s.rest_distance : data.model.bodies[body].size / 330;
    const double proximity = s.proximity_distance > 0 ? s.proximity_distance : 2 * rest;
    const double separation = s.separation > 0 ? s.separation : rest / 50;
    return with_proximity ? proximity : separation;
}

/// What the cubic compares distances with, m.
double cubic_tolerance(const Settings& s) { return s.separation > 0 ? s.separation : kCubicTolerance; }

/// The largest separation that a query with a candidate list asks for, m.
double largest_separation(const StepData& data, const PairRecord& r) {
    const Settings& s = data.model.settings;
    const double arcs = s.trajectory == Trajectory::rigid ? kArcShare * r.lengths.rest : 0.0;
    const double chord =
        s.ccd == CcdMethod::cubic ? std::max(r.lengths.separation, cubic_tolerance(s)) : r.lengths.separation;
    return chord + arcs;
}

constexpr double kSlowMargin = 0.5, kSmallestMargin = 3, kLargestMargin = 6; // proximity distances

/// How far the motion may stray from the one a new list is made for.
CandidateMargins choose_margins(const PairRecord& r, const BodyMotion& a, const BodyMotion& b) {
    const double base = r.lengths.proximity;
    const bool slow = relative_displacement(*a.shape, matrix_pose(a.at0), matrix_pose(a.at1), *b.shape,
                                            matrix_pose(b.at0), matrix_pose(b.at1)) < base;
    if (slow) return {kSlowMargin * base, std::clamp(2 * r.candidates.last_strayed, kSlowMargin * base, base)};
    // A fast pair starts the next step elsewhere: its list serves this step only, whose start states are fixed.
    return {0, std::clamp(2 * r.candidates.last_strayed, kSmallestMargin * base, kLargestMargin * base)};
}

/// A list that covers the motion, made now if that seems to pay; else null.
const CandidateList* candidates(StepData& data, PairRecord& r, const BodyMotion& a, const BodyMotion& b) {
    if (!data.keep_candidates) return nullptr;
    PairCandidates& c = r.candidates;
    const bool first = c.step != data.state.step;
    if (first) {
        c.busy = c.queries > 1 && c.step + 1 == data.state.step;
        c.step = data.state.step;
        c.queries = 0;
    }
    ++c.queries;
    const CandidateMargins strayed = c.list.strayed(a, b);
    if (c.list.covers(strayed)) {
        ++c.uses;
        return &c.list;
    }
    const bool live = !c.list.empty();
    if (live) c.paid = c.uses > 0;
    c.last_strayed = live && !first ? strayed.end : 0;
    c.uses = 0;
    const CandidateMargins margins = choose_margins(r, a, b);
    if ((first && !c.busy && margins.start == 0) || !c.paid) {
        c.list.drop();
        c.paid = true;
        return nullptr;
    }
    const CandidateReach reach{swept_reach(largest_separation(data, r), a, b), r.lengths.proximity};
    c.list.build(a, b, reach, margins);
    return &c.list;
}

/// The distance of the bodies at x^n, from the last contact search where that looked at the pair.
double start_distance(StepData& data, PairRecord& r) {
    if (r.start_distance < 0) {
        const ProximityResult result =
            find_proximities(data.trajectories.at_start(at(r.a)), data.trajectories.at_start(at(r.b)),
                             r.lengths.proximity, data.angle_cos, nullptr, data.proximity);
        r.start_distance = result.near ? result.distance : std::numeric_limits<double>::infinity();
    }
    return r.start_distance;
}

PairHit search(StepData& data, PairRecord& r, CcdMethod method) {
    // Two bodies bitwise at x^n stand where the last step left them, apart (way d).
    if (data.trajectories.still(at(r.a)) && data.trajectories.still(at(r.b))) return {};
    const BodyMotion a = data.trajectories.motion(at(r.a)), b = data.trajectories.motion(at(r.b));
    const double separation = method == CcdMethod::cubic ? cubic_tolerance(data.model.settings) : r.lengths.separation;
    const bool turns = !a.straight() || !b.straight();
    const PathCut cut = turns ? cut_path(a, b, {r.lengths.rest, start_distance(data, r)}) : PathCut{};
    return earliest_hit_on_path(a, b, {separation, CcdStart::relaxed, method}, cut,
                                cut.segments == 1 ? candidates(data, r, a, b) : nullptr, data.ccd);
}

} // namespace

const CandidateList* end_candidates(const StepData& data, const PairRecord& record) {
    const CandidateList& list = record.candidates.list;
    const BodyMotion a = data.trajectories.motion(at(record.a)), b = data.trajectories.motion(at(record.b));
    return data.keep_candidates && list.covers({0, list.strayed(a, b).end}) ? &list : nullptr;
}

const std::vector<CandidatePair>& swept_pairs(StepData& data, bool with_proximity) {
    const std::size_t n = data.model.size();
    data.swept.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const bool movable = data.model.bodies[i].movable();
        const double reach = movable ? largest_reach(data, i, with_proximity) : 0.0;
        data.swept[i] = {data.trajectories.motion(i).swept(), reach, movable};
    }
    return data.broadphase.find(data.swept);
}

const std::vector<CandidatePair>& freeze(StepData& data, bool with_proximity) {
    data.stale.clear();
    for (const CandidatePair& p : swept_pairs(data, with_proximity))
        if (data.clusters.of(at(p.a)) != data.clusters.of(at(p.b)) && !proved(data, p.a, p.b)) data.stale.push_back(p);
    return data.stale;
}

const std::vector<CandidatePair>& end_pairs(StepData& data) {
    const std::size_t n = data.model.size();
    data.swept.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const bool movable = data.model.bodies[i].movable();
        data.swept[i] = {data.trajectories.at_end(i).swept(), movable ? largest_reach(data, i, true) : 0.0, movable};
    }
    return data.broadphase.find(data.swept);
}

bool proved(const StepData& data, std::int32_t a, std::int32_t b) {
    const PairRecord* r = data.pairs.find(a, b);
    return r != nullptr && r->proved_a == data.trajectories.version(at(a)) &&
           r->proved_b == data.trajectories.version(at(b));
}

bool missed(const StepData& data, std::int32_t a, std::int32_t b) {
    const PairRecord* r = data.pairs.find(a, b);
    return r != nullptr && r->missed_a == data.trajectories.version(at(a)) &&
           r->missed_b == data.trajectories.version(at(b));
}

bool left(const StepData& data, std::int32_t a, std::int32_t b) {
    const PairRecord* r = data.pairs.find(a, b);
    return r != nullptr && r->left_a == data.trajectories.version(at(a)) &&
           r->left_b == data.trajectories.version(at(b));
}

PairHit query(StepData& data, std::int32_t a, std::int32_t b, StageCounters& counters) {
    const Stopwatch watch(counters.detection_ms);
    PairRecord& r = data.pairs.get(data.model, data.state, a, b);
    const PairHit hit = search(data, r, CcdMethod::conservative);
    if (!hit.hit) {
        r.proved_a = data.trajectories.version(at(a));
        r.proved_b = data.trajectories.version(at(b));
    }
    return hit;
}

PairHit query_collision(StepData& data, std::int32_t a, std::int32_t b, StageCounters& counters) {
    if (data.model.settings.ccd == CcdMethod::conservative) return query(data, a, b, counters);
    const Stopwatch watch(counters.detection_ms);
    PairRecord& r = data.pairs.get(data.model, data.state, a, b);
    const PairHit hit = search(data, r, CcdMethod::cubic);
    if (!hit.hit) {
        r.missed_a = data.trajectories.version(at(a));
        r.missed_b = data.trajectories.version(at(b));
    }
    return hit;
}

ClusterHit query_clusters(StepData& data, std::int32_t a, std::int32_t b, StageCounters& counters) {
    ClusterHit best;
    for (std::int32_t i : data.clusters[a].members) {
        const Box box_i = data.trajectories.motion(at(i)).swept();
        for (std::int32_t j : data.clusters[b].members) {
            const std::int32_t low = std::min(i, j), high = std::max(i, j);
            if (proved(data, low, high)) continue;
            PairRecord& r = data.pairs.get(data.model, data.state, low, high);
            if (!boxes_overlap(box_i, data.trajectories.motion(at(j)).swept(), r.lengths.separation)) {
                r.proved_a = data.trajectories.version(at(low)); // way a
                r.proved_b = data.trajectories.version(at(high));
                continue;
            }
            const PairHit hit = query(data, low, high, counters);
            if (hit.hit && (!best.hit.hit || hit.toi < best.hit.toi)) best = {hit, low, high};
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

void push(StepData& data, std::int32_t a, std::int32_t b, const ContactPoint& point, const Vec3& impulse,
          StageCounters& counters) {
    const Stopwatch watch(counters.response_ms);
    ++counters.impulses;
    data.clusters.apply(a, point.arm_a, -impulse);
    data.clusters.apply(b, point.arm_b, impulse);
    data.clusters.evolve(a, data.dt, data.trajectories);
    data.clusters.evolve(b, data.dt, data.trajectories);
}

} // namespace flotilla
