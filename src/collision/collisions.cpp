// SPDX-License-Identifier: MIT
#include "collision/collisions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "collision/collide_together.hpp"
#include "collision/late_hits.hpp"
#include "collision/pair_hits.hpp"
#include "pair/divided_sweep.hpp"
#include "pair/progress.hpp"
#include "parallel/compact.hpp"
#include "parallel/team_sort.hpp"

namespace flotilla {
namespace {

/// Sweeps over the pairs that had an impulse which one division of the work serves.
constexpr int kSweepsAtOnce = 8;

/// The impulse of a contact with restitution, cut so that no energy is gained; nothing where it would do nothing.
std::optional<Vec3> elastic_impulse(const StepView& view, const CandidatePair& pair, const ContactPoint& point) {
    const double vn = dot(point.normal, point.relative_velocity);
    if (!(vn < 0)) return std::nullopt;
    const Impulsive a = view.clusters.impulsive(pair.a), b = view.clusters.impulsive(pair.b);
    const auto impulse = contact_impulse(a, b, point, -pair_restitution(view.model, pair.a, pair.b) * vn);
    if (!impulse) return std::nullopt;
    const double share = energy_clamp(a, b, point.arm_a, point.arm_b, *impulse);
    if (!(share > 0)) return std::nullopt;
    return share * *impulse;
}

/// m/s, by which worker.changes part the points of the hit along its normal.
OfBoth change_of_hit(const StepView& view, const Worker& worker, const CandidatePair& pair) {
    const ContactPoint& hit = worker.hits[0];
    const Impulsive a = view.clusters.impulsive(pair.a), b = view.clusters.impulsive(pair.b);
    Vec3 linear_a, angular_a, linear_b, angular_b;
    for (const PairManifold::Change& c : worker.changes) {
        linear_a -= velocity_change(a, c.impulse);
        angular_a -= a.inverse_inertia * cross(c.point.arm_a, c.impulse);
        linear_b += velocity_change(b, c.impulse);
        angular_b += b.inverse_inertia * cross(c.point.arm_b, c.impulse);
    }
    return {-dot(hit.normal, linear_a + cross(angular_a, hit.arm_a)),
            dot(hit.normal, linear_b + cross(angular_b, hit.arm_b))};
}

/// How all operations of a round take their hits.
struct HitRules {
    const Touching& touching;
    const Grounds& grounds;
    bool join = false; ///< all hits of an operation together, whenever they come
};

/// Applies worker.changes.
void push_all(const StepView& view, const Touching& touching, Movers& movers, Worker& worker,
              const CandidatePair& pair) {
    const Stopwatch watch(worker.counters.response_ms);
    const OfBoth late = late_shares(view, touching, pair, *worker.landing, change_of_hit(view, worker, pair));
    for (const PairManifold::Change& c : worker.changes) {
        apply_impulse(movers.clusters(), worker, pair.a, pair.b, c.point, c.impulse);
        if (late.a > 0) movers.clusters().delay(pair.a, c.point.arm_a, -late.a * c.impulse);
        if (late.b > 0) movers.clusters().delay(pair.b, c.point.arm_b, late.b * c.impulse);
    }
    movers.evolve(pair.a);
    movers.evolve(pair.b);
}

/// The impulses of worker.hits, together with the earlier ones of this operation that belong to the same time. False:
/// there is none, as the bodies part already or the energy clamp leaves nothing of it.
bool respond(const StepView& view, const HitRules& rules, Movers& movers, Worker& worker, const CandidatePair& pair) {
    const Landing& landing = *worker.landing; // where there are hits there is one
    if (landing.parts) {
        if (!hasten(view, movers.clusters(), pair, worker.hits[0], landing)) return false;
        movers.evolve(pair.a);
        movers.evolve(pair.b);
        return true;
    }
    const double restitution = pair_restitution(view.model, pair.a, pair.b);
    const ContactPoint first = worker.hits[0];
    const auto together = [&] {
        return rules.join || worker.manifold.simultaneous(first, landing.gap, landing.lengths.rest);
    };
    if (worker.manifold.empty() || !together())
        worker.manifold.start(view.clusters.impulsive(pair.a), view.clusters.impulsive(pair.b), landing.gap);
    const bool alone = worker.manifold.empty() && worker.hits.size() == 1;
    if (!alone && worker.manifold.resolve(worker.hits, restitution, worker.first_within, worker.changes)) {
        push_all(view, rules.touching, movers, worker, pair);
        return true;
    }
    const auto impulse = elastic_impulse(view, pair, first);
    if (!impulse) return false;
    worker.manifold.add(first, restitution, *impulse);
    worker.changes.assign(1, {first, *impulse});
    push_all(view, rules.touching, movers, worker, pair);
    return true;
}

/// The inner part of Algorithm 1: resolves the hits of one pair in consecutive order, then its fast end proximities.
/// Whether it applied an impulse. `known`: what its present motion is known to meet first, or null.
bool collide(const StepView& view, const HitRules& rules, Movers& movers, Worker& worker, const ListedPair& listed,
             const CollisionFinding* known) {
    PairRecord& record = *listed.record;
    const CandidatePair& pair = listed.pair;
    if (known == nullptr) ++worker.counters.pairs;
    record.processed.withdraw();
    worker.manifold.clear();
    for (int i = 0; i < view.model.settings.collision_pair_iterations; ++i) {
        if (!find_hits(view, worker, record, &rules.grounds, i == 0 ? known : nullptr)) return i > 0;
        if (!respond(view, rules, movers, worker, pair)) {
            commit(view.trajectories, record, Verdict::settled); // stage 5 takes it
            ++worker.counters.settled;
            return i > 0;
        }
        record.active = true;
    }
    return view.model.settings.collision_pair_iterations > 0;
}

/// `collisions: sequential`.
class SequentialCollisions {
  public:
    SequentialCollisions(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve* joint,
                         CollisionScratch& scratch)
        : view_(view), movers_(movers), book_(book), workers_(workers), joint_(joint), scratch_(scratch) {}

    /// Algorithm 1: for all pairs that may collide or come near each other, resolve their hits; again, until none hits.
    /// Between two rounds over all pairs, those that had an impulse are resolved until none of them hits: most further
    /// hits are theirs, and no list is made for them. Where that gains nothing the hits of an operation are joined, and
    /// it is tried again: a ring that hits the peg in it on one side and, on its way from the start of the step, on the
    /// other would go to and fro for ever. What sweeps do not end is solved together.
    StageCounters run() {
        scratch_.active.clear();
        scratch_.grounds.start();
        scratch_.first.start();
        while (sweeps_left() > 0 && goes_on()) {
            const FrozenList list = pairs_to_resolve();
            const FirstHits::Looked looked = scratch_.first.look(view_, workers_, list.pairs);
            counters_.pairs += static_cast<std::int64_t>(looked.examined);
            if (resolve_first() == 0) {
                // What was known of pairs, a cache, must not decide how many sweeps count: resolving in turn those that
                // were closed ahead of it would have been one.
                if (list.num_closed() + looked.closed > 0) ++counters_.sweeps;
                counters_.limit = sweeps_left() <= 0;
                return counters_;
            }
            add_active(scratch_.first.hitting());
            note_progress();
            resolve_active();
        }
        counters_.limit = joint_ == nullptr || !solve_together();
        return counters_;
    }

  private:
    [[nodiscard]] int sweeps_left() const {
        return view_.model.settings.collision_iterations - static_cast<int>(counters_.sweeps);
    }

    /// Where sweeps have used rebounds up, to a sixteenth.
    bool solve_together() {
        constexpr double kUsedUp = 1.0 / 16;
        const double most_restitution =
            std::pow(kUsedUp, 1 / static_cast<double>(std::max<std::int64_t>(1, counters_.sweeps)));
        return collide_together(view_, movers_, book_, workers_, *joint_, scratch_.touching,
                                std::vector<std::uint8_t>(view_.model.size(), 1), most_restitution, scratch_.hits.found,
                                counters_);
    }

    bool goes_on() {
        if (!progress_.stalled()) return true;
        if (join_) return false;
        join_ = true;
        progress_ = Progress();
        return true;
    }

    /// All pairs that are not proved apart.
    FrozenList pairs_to_resolve() {
        const FrozenList list = freeze(view_, book_, workers_.team, ListReach::proximity);
        counters_.pairs += static_cast<std::int64_t>(list.num_closed());
        scratch_.grounds.add(view_, list.pairs, workers_.team, book_.lists.chunk_places);
        return list;
    }

    /// Goes once over the pairs that were seen to hit, where neither of their bodies meets others first.
    std::size_t resolve_first() {
        return scratch_.first.hitting().empty() ? 0 : resolve(scratch_.first.hitting(), 1, &scratch_.first);
    }

    /// Goes `rounds` times over the pairs of a list that are open, or until none is; odd sweeps go backwards. Returns
    /// the number of sweeps that found any, and in scratch_.hitting and hardest how many pairs hit in each, and how
    /// hard.
    std::size_t resolve(std::span<const ListedPair> list, int rounds, const FirstHits* first = nullptr) {
        const auto count = at(rounds);
        for (Worker& worker : workers_.each) {
            worker.work.assign(count, 0);
            worker.hitting.assign(count, 0);
            worker.hardest.assign(count, 0);
        }
        const auto pair_of = [&](std::size_t i) { return list[i].pair; };
        const SweepPlan plan{sweep_order(view_, book_, workers_.team, list.size(), pair_of), counters_.sweeps % 2 != 0,
                             rounds};
        const SweepOperation operation{
            "collide", [&](std::size_t i) { return verdict(view_.trajectories, *list[i].record) != Verdict::open; },
            [&](std::size_t i) { fetch_record(*list[i].record); },
            [&](std::size_t i, int round, Worker& worker) {
                const std::size_t r = at(round);
                ++worker.work[r];
                if (first != nullptr && first->waits(view_, i)) return;
                take_largest_push(worker); // of operations before
                const auto* known = first != nullptr ? first->found(view_, i) : nullptr;
                if (collide(view_, {scratch_.touching, scratch_.grounds, join_}, movers_, worker, list[i], known))
                    ++worker.hitting[r];
                worker.hardest[r] = std::max(worker.hardest[r], take_largest_push(worker));
            }};
        const SharedSweep shared{movers_, [&](std::size_t i) -> PairRecord& { return *list[i].record; }};
        run_sweep(workers_, book_.lists.sweep, plan, operation, shared);
        collect(workers_, counters_);
        count_hitting(count);
        counters_.sweeps += std::ssize(scratch_.hitting);
        return scratch_.hitting.size();
    }

    /// Goes over the pairs that had an impulse until none of them is open.
    void resolve_active() {
        while (sweeps_left() > 0 && goes_on()) {
            const int rounds = std::min(kSweepsAtOnce, sweeps_left());
            const std::size_t run = resolve(scratch_.active, rounds);
            note_progress();
            if (run < at(rounds)) return;
        }
    }

    void count_hitting(std::size_t rounds) {
        scratch_.hitting.clear();
        scratch_.hardest.clear();
        for (std::size_t r = 0; r < rounds; ++r) {
            const auto worked = [&](const Worker& worker) { return worker.work[r] > 0; };
            if (std::none_of(workers_.each.begin(), workers_.each.end(), worked)) continue;
            std::size_t& hitting = scratch_.hitting.emplace_back(0);
            double& hardest = scratch_.hardest.emplace_back(0);
            for (const Worker& worker : workers_.each) {
                hitting += worker.hitting[r];
                hardest = std::max(hardest, worker.hardest[r]);
            }
        }
    }

    /// Adds the pairs of a list that had an impulse in this step to those of earlier lists.
    void add_active(std::span<const ListedPair> list) {
        constexpr std::size_t kGrain = 512;
        std::vector<ListedPair>& active = scratch_.active;
        const std::size_t before = active.size();
        const auto kept = [&](std::size_t i) { return list[i].record->active; };
        const auto item = [&](std::size_t i) { return list[i]; };
        compact_if({&workers_.team, "active pairs", kGrain, book_.lists.chunk_places}, list.size(), kept, active,
                   before, item);
        if (active.size() == before) return;
        std::vector<ListedPair>& merged = scratch_.merged;
        team_merge(workers_.team, active, before, merged, std::less<>{});
        const auto first = [&](std::size_t i) { return i == 0 || !(merged[i] == merged[i - 1]); };
        compact_if({&workers_.team, "active pairs", kGrain, book_.lists.chunk_places}, merged.size(), first, active, 0,
                   [&](std::size_t i) { return merged[i]; });
    }

    void note_progress() {
        for (std::size_t r = 0; r < scratch_.hitting.size(); ++r)
            progress_.add(scratch_.hitting[r], scratch_.active.size(), scratch_.hardest[r]);
    }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    JointSolve* joint_; ///< may be null
    CollisionScratch& scratch_;
    StageCounters counters_;
    Progress progress_;
    bool join_ = false; ///< HitRules::join
};

} // namespace

StageCounters handle_collisions(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                const ContactsAtStart& known, JointSolve* joint, CollisionScratch& scratch) {
    if (view.model.settings.collision_iterations == 0) joint = nullptr;
    scratch.touching.start(view.model.size(), known);
    if (view.model.settings.collisions == Collisions::accumulated)
        return accumulate_collisions(view, movers, book, workers, known, scratch.touching, joint, scratch.hits);
    return SequentialCollisions(view, movers, book, workers, joint, scratch).run();
}

} // namespace flotilla
