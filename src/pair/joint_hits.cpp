// SPDX-License-Identifier: MIT
#include "pair/joint_hits.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/index.hpp"
#include "base/stopwatch.hpp"

namespace flotilla {
namespace {

/// Rounds in a row without a solution.
constexpr int kMostFailures = 2;

bool in_order_of_bodies(const MetHit& x, const MetHit& y) {
    return std::tuple(x.contact.a, x.contact.b) < std::tuple(y.contact.a, y.contact.b);
}

} // namespace

JointHits::JointHits(const StepView& view, Movers movers, Workers& workers, JointSolve& joint, std::ptrdiff_t most_hits,
                     StageCounters& counters)
    : view_(view),
      movers_(movers),
      workers_(workers),
      joint_(joint),
      most_hits_(most_hits),
      counters_(counters),
      motion_(view.clusters.motion()) {
    joint_.left.resize(view.model.size());
    before_.resize(view.model.size());
    for (const std::int32_t body : view.model.active) before_[at(body)] = view.clusters.change(body);
}

void JointHits::leave(std::int32_t a, std::int32_t b) {
    for (const std::int32_t body : {a, b})
        if (!view_.clusters[body].infinite()) joint_.left[at(body)] = 1;
}

Impulsive JointHits::before(std::int32_t body) const {
    Impulsive out = view_.clusters.impulsive(body);
    if (view_.clusters[body].infinite()) return out;
    out.velocity = motion_[at(body)].velocity;
    out.angular_velocity = out.inverse_inertia * motion_[at(body)].momentum;
    return out;
}

int JointHits::tries(std::int32_t a, std::int32_t b) const {
    MetHit of_pair;
    of_pair.contact.a = a, of_pair.contact.b = b;
    const auto known = kept_.begin() + static_cast<std::ptrdiff_t>(known_);
    const auto [first, last] = std::equal_range(kept_.begin(), known, of_pair, in_order_of_bodies);
    return static_cast<int>(last - first);
}

Vec3 JointHits::impulse(std::size_t hit) const { return share_[at(island_[hit])] * kept_[hit].impulse; }

/// Fills island_.
void JointHits::find_islands_of_hits() {
    bodies_of_.clear();
    movable_.resize(view_.model.size());
    for (const MetHit& hit : kept_) {
        bodies_of_.push_back({hit.contact.a, hit.contact.b});
        for (const std::int32_t body : {hit.contact.a, hit.contact.b})
            movable_[at(body)] = view_.clusters[body].infinite() ? 0 : 1;
    }
    island_.resize(kept_.size());
    const auto islands = at(find_islands(bodies_of_, movable_, graph_, island_));
    changed_.assign(islands, 0);
    share_.assign(islands, 1);
}

/// Marks islands of one body that others of infinite mass hold between them: impulses make no room there, and what is
/// found takes it out sideways.
void JointHits::mark_pinched() {
    constexpr std::int32_t kNone = -1, kSeveral = -2;
    std::vector<std::int32_t> alone(changed_.size(), kNone);
    for (std::size_t i = 0; i < kept_.size(); ++i)
        for (const std::int32_t body : {kept_[i].contact.a, kept_[i].contact.b}) {
            std::int32_t& of_island = alone[at(island_[i])];
            if (movable_[at(body)] != 0) of_island = of_island == kNone || of_island == body ? body : kSeveral;
        }
    const auto towards = [](const Contact& c, std::int32_t body) { return c.b == body ? c.normal : -c.normal; };
    places_.clear(); // of hits on one body alone, by island
    for (std::size_t i = 0; i < kept_.size(); ++i)
        if (alone[at(island_[i])] >= 0) places_.push_back(i);
    std::ranges::stable_sort(places_, {}, [&](std::size_t i) { return island_[i]; });
    for (std::size_t first = 0, i = 0; i < places_.size(); ++i) {
        const std::int32_t island = island_[places_[i]], body = alone[at(island)];
        if (island_[places_[first]] != island) first = i;
        const Vec3 normal = towards(kept_[places_[i]].contact, body);
        for (std::size_t k = first; k < i; ++k)
            if (dot(towards(kept_[places_[k]].contact, body), normal) < kOpposed) changed_[at(island)] = 1;
    }
}

/// Pinched bodies, islands of too many hits, and those that have a body which is left: all of their bodies move as
/// before.
void JointHits::leave_islands() {
    mark_pinched();
    std::vector<std::ptrdiff_t> hits(changed_.size(), 0);
    for (const std::int32_t i : island_) ++hits[at(i)];
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        const Contact& c = kept_[i].contact;
        if (hits[at(island_[i])] > most_hits_ || is_left(c.a) || is_left(c.b)) changed_[at(island_[i])] = 1;
    }
    leave_changed();
}

void JointHits::leave_changed() {
    if (std::ranges::find(changed_, 1) == changed_.end()) return;
    move_islands(false);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        if (changed_[at(island_[i])] != 0)
            leave(kept_[i].contact.a, kept_[i].contact.b);
        else
            island_[kept] = island_[i], kept_[kept++] = kept_[i];
    }
    kept_.resize(kept), island_.resize(kept);
    std::ranges::fill(changed_, std::uint8_t{0});
}

/// Moves the bodies of islands that changed, by their impulses or as before all of it.
void JointHits::move_islands(bool by_impulses) {
    moved_.clear();
    for (std::size_t i = 0; i < kept_.size(); ++i)
        for (const std::int32_t body : {kept_[i].contact.a, kept_[i].contact.b})
            if (changed_[at(island_[i])] != 0 && movable_[at(body)] != 0) moved_.push_back(body);
    std::sort(moved_.begin(), moved_.end());
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
    for (const std::int32_t body : moved_) {
        movers_.clusters().take(body, before_[at(body)]);
        movers_.clusters().take_motion(at(body), motion_[at(body)]);
    }
    for (std::size_t i = 0; by_impulses && i < kept_.size(); ++i) {
        const MetHit& hit = kept_[i];
        const Contact& c = hit.contact;
        if (changed_[at(island_[i])] != 0)
            apply_impulse(movers_.clusters(), workers_[0], c.a, c.b, {c.normal, hit.arm_a, hit.arm_b, {}, c.friction},
                          impulse(i));
    }
    collect(workers_, counters_);
    for (const std::int32_t body : moved_) movers_.evolve(body);
}

/// Fills share_: as energy_clamp() has it for one impulse.
void JointHits::clamp_energy() {
    std::vector<double> slope(changed_.size(), 0), curvature(changed_.size(), 0);
    std::vector<Impulsive>& by_body = gained_;
    by_body.resize(view_.model.size());
    for (const MetHit& hit : kept_)
        for (const std::int32_t body : {hit.contact.a, hit.contact.b}) {
            by_body[at(body)] = before(body);
            by_body[at(body)].velocity = by_body[at(body)].angular_velocity = {};
        }
    for (const MetHit& hit : kept_) {
        Impulsive &a = by_body[at(hit.contact.a)], &b = by_body[at(hit.contact.b)];
        a.velocity -= velocity_change(a, hit.impulse);
        a.angular_velocity -= a.inverse_inertia * cross(hit.arm_a, hit.impulse);
        b.velocity += velocity_change(b, hit.impulse);
        b.angular_velocity += b.inverse_inertia * cross(hit.arm_b, hit.impulse);
    }
    const auto between = [&](const Impulsive& a, const Impulsive& b, const MetHit& hit) {
        return dot(hit.impulse, point_velocity(b, hit.arm_b) - point_velocity(a, hit.arm_a));
    };
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        const Contact& c = kept_[i].contact;
        slope[at(island_[i])] += between(before(c.a), before(c.b), kept_[i]);
        curvature[at(island_[i])] += between(by_body[at(c.a)], by_body[at(c.b)], kept_[i]);
    }
    for (std::size_t i = 0; i < share_.size(); ++i)
        share_[i] = !(slope[i] < 0) ? 0 : curvature[i] > -2 * slope[i] ? -2 * slope[i] / curvature[i] : 1;
}

void JointHits::solve(bool clamps) {
    std::stable_sort(kept_.begin(), kept_.end(), in_order_of_bodies);
    find_islands_of_hits();
    leave_islands();
    contacts_.clear(), impulses_.clear();
    const auto start_of = [&](std::int32_t body) { return view_.trajectories.start_pose(at(body)).com; };
    for (const MetHit& hit : kept_) {
        Contact c = hit.contact;
        c.point = start_of(c.a) + hit.arm_a;
        c.across = start_of(c.b) + hit.arm_b - c.point;
        contacts_.push_back(c), impulses_.push_back(hit.impulse);
    }
    const Stopwatch watch(workers_[0].counters.response_ms);
    const std::span<const std::uint8_t> unsolved = joint_.solve(contacts_, motion_, impulses_);
    for (std::size_t i = 0; i < kept_.size(); ++i) {
        kept_[i].changed = std::exchange(kept_[i].impulse, impulses_[i]) != impulses_[i];
        const Contact& c = kept_[i].contact;
        const bool failed = unsolved[at(c.a)] != 0 || unsolved[at(c.b)] != 0;
        kept_[i].failures = failed ? kept_[i].failures + 1 : 0;
        if (kept_[i].failures >= kMostFailures) changed_[at(island_[i])] = 1;
    }
    leave_changed();
    for (std::size_t i = 0; i < kept_.size(); ++i)
        if (kept_[i].changed) changed_[at(island_[i])] = 1;
    if (clamps) clamp_energy();
    move_islands(true);
    known_ = kept_.size();
    ++counters_.sweeps;
}

} // namespace flotilla
