// SPDX-License-Identifier: MIT
#include "collision/accumulated.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "collision/collide_together.hpp"
#include "collision/found_hits.hpp"
#include "collision/late_hits.hpp"
#include "collision/pair_hits.hpp"
#include "pair/progress.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16, kBodyGrain = 16; // items of a task

std::pair<std::int32_t, std::int32_t> bodies_of_hit(const KeptHit& hit) { return {hit.a, hit.b}; }
std::pair<std::int32_t, std::int32_t> bodies_of_found(const FoundHit& found) {
    return {found.record->a, found.record->b};
}

/// How many pairs of bodies hits have that are sorted by bodies.
template <class Hit, class Bodies>
std::size_t num_pairs(const std::vector<Hit>& hits, Bodies&& bodies) {
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < hits.size(); ++i)
        if (i == 0 || bodies(hits[i]) != bodies(hits[i - 1])) ++pairs;
    return pairs;
}

bool by_bodies(const KeptHit& x, const KeptHit& y) { return std::tuple(x.a, x.b) < std::tuple(y.a, y.b); }

class Accumulation {
  public:
    Accumulation(const StepView& view, Movers movers, PairBook& book, Workers& workers, const ContactsAtStart& known,
                 const Touching& touching, JointSolve* joint, HitLists& lists)
        : view_(view),
          movers_(movers),
          book_(book),
          workers_(workers),
          known_(known),
          touching_(touching),
          joint_(joint),
          lists_(lists) {}

    StageCounters run() {
        lists_.hits.clear();
        for (int rounds = view_.model.settings.collision_iterations;; --rounds) {
            counters_.limit = rounds <= 0 || progress_.stalled();
            if (counters_.limit) break;
            look_for_hits(view_, book_, workers_, counters_, lists_.found,
                          [&](std::int32_t a, std::int32_t b) { return !is_aside(a, b); });
            const bool hastened = hasten_parting(view_, movers_, counters_, lists_.found);
            if (lists_.found.empty() && !hastened) break;
            if (lists_.found.empty()) continue;
            keep();
            take_largest_push(workers_); // of other stages
            solve();
            set_aside();
            progress_.add(num_pairs(lists_.found, bodies_of_found), num_pairs(lists_.hits, bodies_of_hit),
                          take_largest_push(workers_));
            if (!move() && !lists_.found.empty()) break; // what is not set aside
        }
        if (!set_aside_.empty() && !collide_together(view_, movers_, book_, workers_, *joint_, touching_, set_aside_, 1,
                                                     lists_.found, counters_))
            counters_.limit = true;
        return counters_;
    }

  private:
    /// Adds what was found to the hits, where it is not one of them.
    void keep() {
        std::vector<KeptHit>& hits = lists_.hits;
        if (!std::exchange(knows_, true)) keep_known();
        const std::size_t before = hits.size();
        for (KeptHit& hit : hits) hit.found = -1;
        for (const FoundHit& f : lists_.found) {
            KeptHit hit;
            hit.a = f.record->a;
            hit.b = f.record->b;
            const auto old = hits.begin() + static_cast<std::ptrdiff_t>(before);
            const auto [begin, end] = std::equal_range(hits.begin(), old, hit, by_bodies);
            const auto same = std::find_if(begin, end, [&](const KeptHit& h) { return is_same(h, f); });
            KeptHit& to = same != end ? *same : hits.emplace_back(hit);
            to.point = f.point;
            to.restitution = pair_restitution(view_.model, hit.a, hit.b);
            to.least = least_approach(view_, hit.a, hit.b, f.record->lengths.rest);
            to.fresh = true;
            to.within = f.within;
            to.found = static_cast<std::int32_t>(&f - lists_.found.data());
        }
        std::stable_sort(hits.begin(), hits.end(), by_bodies);
    }

    [[nodiscard]] bool is_same(const KeptHit& hit, const FoundHit& found) const {
        const double reach = found.record->lengths.rest;
        return length_sq(hit.point.arm_b - found.point.arm_b) <= reach * reach &&
               dot(hit.point.normal, found.point.normal) >= view_.angle_cos;
    }

    /// Contacts at x^n wait to be hits.
    void keep_known() {
        for (std::size_t k = 0; k < known_.contacts.size(); ++k) {
            const Contact& c = known_.contacts[k];
            KeptHit hit;
            hit.a = c.a;
            hit.b = c.b;
            hit.point = {c.normal,
                         c.point - view_.trajectories.start_pose(at(c.a)).com,
                         c.point - view_.trajectories.start_pose(at(c.b)).com,
                         {},
                         c.friction};
            hit.restitution = pair_restitution(view_.model, c.a, c.b);
            hit.least = least_approach(view_, c.a, c.b, known_.rest[k]);
            hit.gap = std::max(0.0, c.distance - known_.rest[k]);
            hit.room = hit.gap / view_.dt;
            lists_.hits.push_back(hit);
        }
    }

    /// Islands of hits, side by side.
    void solve() {
        load_bodies();
        gather_islands();
        const std::size_t islands = lists_.begin.size() - 1;
        unsolved_.assign(islands, 0);
        workers_.team.for_each("solve hits", islands, 1, [&](std::size_t i, int thread) {
            const auto first = static_cast<std::size_t>(lists_.begin[i]),
                       last = static_cast<std::size_t>(lists_.begin[i + 1]);
            const auto island = std::span<const std::int32_t>(lists_.places).subspan(first, last - first);
            Worker& worker = workers_[thread];
            const Stopwatch watch(worker.counters.response_ms);
            const bool few = joint_ != nullptr && std::ssize(island) <= kMostCollisionsTogether;
            if (!solve_hits(lists_.hits, island, lists_.bodies) && few) {
                unsolved_[i] = 1;
                return;
            }
            const double late = late_share_of(island);
            for (const std::int32_t k : island) {
                const KeptHit& hit = lists_.hits[at(k)];
                if (hit.change == Vec3{}) continue;
                apply_impulse(movers_.clusters(), worker, hit.a, hit.b, hit.point, hit.change);
                if (late > 0) delay(hit, late);
            }
        });
        collect(workers_, counters_);
    }

    /// Islands that sweeps do not solve, as they were before the round: what these did to them would tilt what is to be
    /// hit flat.
    void set_aside() {
        if (std::ranges::find(unsolved_, 1) == unsolved_.end()) return;
        set_aside_.resize(view_.model.size());
        for (std::size_t k = 0; k < lists_.hits.size(); ++k) {
            const KeptHit& hit = lists_.hits[k];
            if (unsolved_[at(lists_.island[k])] == 0) continue;
            for (const std::int32_t body : {hit.a, hit.b})
                if (lists_.movable[at(body)] != 0) set_aside_[at(body)] = 1;
        }
        std::erase_if(lists_.hits, [&](const KeptHit& hit) { return is_aside(hit.a, hit.b); });
        std::erase_if(lists_.found, [&](const FoundHit& f) { return is_aside(f.record->a, f.record->b); });
    }

    [[nodiscard]] bool is_aside(std::int32_t a, std::int32_t b) const {
        return !set_aside_.empty() && (set_aside_[at(a)] | set_aside_[at(b)]) != 0;
    }

    /// An island's blows go through it at once: what is late of them is the least of what the round found.
    [[nodiscard]] double late_share_of(std::span<const std::int32_t> island) const {
        double least = 1;
        bool any = false;
        for (const std::int32_t k : island) {
            const KeptHit& hit = lists_.hits[at(k)];
            if (hit.found < 0) continue;
            const std::optional<Landing>& landing = lists_.found[at(hit.found)].landing;
            const CandidatePair pair{hit.a, hit.b};
            if (!landing) continue;
            if (const auto [a, b] = may_be_late(hit); !a && !b) continue;
            const auto change = [&](std::int32_t body, const Vec3& arm) {
                return dot(hit.point.normal, point_velocity(lists_.bodies.body[at(body)], arm) -
                                                 point_velocity(view_.clusters.impulsive(body), arm));
            };
            const OfBoth late = late_shares(view_, touching_, pair, *landing,
                                            {-change(hit.a, hit.point.arm_a), change(hit.b, hit.point.arm_b)});
            least = std::min(least, std::max(late.a, late.b));
            any = true;
        }
        return any ? least : 0;
    }

    [[nodiscard]] std::pair<bool, bool> may_be_late(const KeptHit& hit) const {
        return touching_.may_be_late(view_.clusters, hit.a, hit.b, hit.point.normal);
    }

    void delay(const KeptHit& hit, double late) {
        Clusters& clusters = movers_.clusters();
        const auto [late_a, late_b] = may_be_late(hit);
        if (late_a) clusters.delay(hit.a, hit.point.arm_a, -late * hit.change);
        if (late_b) clusters.delay(hit.b, hit.point.arm_b, late * hit.change);
    }

    void load_bodies() {
        HitBodies& bodies = lists_.bodies;
        const std::size_t n = view_.model.size();
        bodies.body.resize(n);
        bodies.before.resize(n);
        bodies.owner.resize(n);
        bodies.stamp.assign(n, 0);
        bodies.saved.assign(n, 0);
        lists_.used.assign(n, 0);
        lists_.movable.resize(n);
        for (const KeptHit& hit : lists_.hits) lists_.used[at(hit.a)] = lists_.used[at(hit.b)] = 1;
        workers_.team.for_each("bodies of hits", n, kBodyGrain, [&](std::size_t i, int) {
            if (lists_.used[i] == 0) return;
            bodies.body[i] = view_.clusters.impulsive(static_cast<std::int32_t>(i));
            lists_.movable[i] = bodies.body[i].inverse_mass > 0 ? 1 : 0;
        });
    }

    /// Fills lists_.places and begin.
    void gather_islands() {
        const std::size_t n = lists_.hits.size();
        lists_.bodies_of.clear();
        for (const KeptHit& hit : lists_.hits) lists_.bodies_of.push_back({hit.a, hit.b});
        lists_.island.resize(n);
        const int islands = find_islands(lists_.bodies_of, lists_.movable, lists_.graph, lists_.island);
        lists_.begin.assign(static_cast<std::size_t>(islands) + 2, 0);
        for (const std::int32_t i : lists_.island) ++lists_.begin[at(i) + 2];
        for (std::size_t i = 2; i < lists_.begin.size(); ++i) lists_.begin[i] += lists_.begin[i - 1];
        lists_.places.resize(n);
        for (std::size_t k = 0; k < n; ++k)
            lists_.places[at(lists_.begin[at(lists_.island[k]) + 1]++)] = static_cast<std::int32_t>(k);
        lists_.begin.pop_back();
    }

    /// Moves the bodies that the solve changed; whether there are any. What hit and was not changed is stage 5's.
    bool move() {
        std::fill(lists_.used.begin(), lists_.used.end(), std::uint8_t{0});
        for (const KeptHit& hit : lists_.hits)
            if (hit.change != Vec3{}) {
                lists_.used[at(hit.a)] = lists_.used[at(hit.b)] = 1;
            }
        const PairRecord* last = nullptr; // hits come pair by pair
        for (const FoundHit& f : lists_.found) {
            PairRecord& r = *f.record;
            if (std::exchange(last, &r) == &r) continue;
            if (lists_.used[at(r.a)] != 0 && lists_.movable[at(r.a)] != 0) continue;
            if (lists_.used[at(r.b)] != 0 && lists_.movable[at(r.b)] != 0) continue;
            commit(view_.trajectories, r, Verdict::settled);
            ++counters_.settled;
        }
        lists_.moved.clear();
        for (std::size_t i = 0; i < lists_.used.size(); ++i)
            if (lists_.used[i] != 0 && lists_.movable[i] != 0) lists_.moved.push_back(static_cast<std::int32_t>(i));
        workers_.team.for_each("move bodies", lists_.moved.size(), kBodyGrain,
                               [&](std::size_t k, int) { movers_.evolve(lists_.moved[k]); });
        return !lists_.moved.empty();
    }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    const ContactsAtStart& known_;
    const Touching& touching_;
    JointSolve* joint_; ///< may be null
    HitLists& lists_;
    StageCounters counters_;
    Progress progress_;
    bool knows_ = false;                  ///< contacts at x^n are among the hits
    std::vector<std::uint8_t> unsolved_;  ///< by island, as flags: sweeps over its hits came to their bound
    std::vector<std::uint8_t> set_aside_; ///< by body, as flags: to be solved together; empty: none
};

} // namespace

StageCounters accumulate_collisions(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                    const ContactsAtStart& known, const Touching& touching, JointSolve* joint,
                                    HitLists& lists) {
    return Accumulation(view, movers, book, workers, known, touching, joint, lists).run();
}

} // namespace flotilla
