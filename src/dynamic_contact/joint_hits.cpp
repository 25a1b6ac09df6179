// SPDX-License-Identifier: MIT
#include "dynamic_contact/joint_hits.hpp"

#include <algorithm>
#include <atomic>
#include <tuple>
#include <utility>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "islands/contact_graph.hpp"
#include "pair/cluster_query.hpp"
#include "pair/examine.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16; // pairs of a task
/// What a solve may leave undone, of a rest distance in the step: hits are answered by several of them.
constexpr double kUndone = 1.0 / 16;
/// Rounds, and tries of a pair: of 10,435 solves that ended 10,406 did so within ten.
constexpr int kMostRounds = 16;
/// Rounds in a row without a solution.
constexpr int kMostFailures = 2;

/// A hit that is kept, and what it was answered with.
struct MetHit {
    Contact contact;      ///< without its points
    Vec3 arm_a, arm_b;    ///< m, from the centres of mass
    Vec3 impulse;         ///< N s, on b
    bool changed = false; ///< that, in this round
    int failures = 0;     ///< rounds in a row whose solve found no solution
};

class JointHits {
  public:
    JointHits(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve& joint,
              StageCounters& counters)
        : view_(view),
          movers_(movers),
          book_(book),
          workers_(workers),
          solve_(joint.solve),
          counters_(counters),
          motion_(view.clusters.motion()),
          left_(joint.left) {
        left_.resize(view.model.size());
        before_.resize(view.model.size());
        for (const std::int32_t body : view.model.active) before_[at(body)] = view.clusters.change(body);
    }

    bool run() {
        for (int round = 0;; ++round) {
            const FrozenList frozen = freeze_clusters(view_, book_, workers_.team, clusters_);
            look(frozen);
            if (found_.empty()) return !passed_over_;
            keep(round >= kMostRounds);
            find_islands_of_hits();
            leave_islands();
            solve();
            ++counters_.sweeps;
        }
    }

  private:
    /// Fills found_ with the first hit of each pair, in the order of the pairs, but for bodies that are left.
    void look(const FrozenList& frozen) {
        hits_.assign(clusters_.pairs.size(), {});
        passed_over_ = false;
        workers_.team.for_each("look for hits", clusters_.pairs.size(), kPairGrain, [&](std::size_t i, int thread) {
            const CandidatePair& pair = clusters_.pairs[i];
            if (apart(view_.trajectories, *frozen.pairs[i].record)) return;
            if (is_left(pair.a) || is_left(pair.b)) {
                passed_over_.store(true, std::memory_order_relaxed);
                return;
            }
            Worker& worker = workers_[thread];
            ++worker.counters.pairs;
            hits_[i] = query_clusters(view_, book_.table, worker, pair.a, pair.b);
        });
        collect(workers_, counters_);
        found_.clear();
        for (const ClusterHit& hit : hits_)
            if (hit.hit.hit) found_.push_back(hit);
    }

    [[nodiscard]] bool is_left(std::int32_t body) const { return left_[at(body)] != 0; }
    /// To the failsafe.
    void leave(std::int32_t a, std::int32_t b) {
        for (const std::int32_t body : {a, b})
            if (!view_.clusters[body].infinite()) left_[at(body)] = 1;
    }

    [[nodiscard]] static bool by_bodies(const MetHit& x, const MetHit& y) {
        return std::tuple(x.contact.a, x.contact.b) < std::tuple(y.contact.a, y.contact.b);
    }

    /// Adds what was found to what is kept, by bodies. Left are bodies of a pair that has had all its tries, and in the
    /// last rounds those of all pairs.
    void keep(bool at_last) {
        const auto before = static_cast<std::ptrdiff_t>(kept_.size());
        const int most = std::min(view_.model.settings.dynamic_pair_iterations, kMostRounds);
        for (const ClusterHit& found : found_) {
            MetHit hit;
            hit.contact.a = found.a, hit.contact.b = found.b;
            const auto [first, last] = std::equal_range(kept_.begin(), kept_.begin() + before, hit, by_bodies);
            const auto tries = static_cast<int>(last - first);
            const Impulsive a = impulsive(found.a), b = impulsive(found.b);
            if (at_last || tries >= most || (found.hit.by_turn && turns_stay(a, b, view_.dt)))
                leave(found.a, found.b);
            else
                kept_.push_back(met_hit(found, a, b, tries, most));
        }
        std::stable_sort(kept_.begin(), kept_.end(), by_bodies);
    }

    [[nodiscard]] Impulsive impulsive(std::int32_t body) const { return view_.clusters.impulsive(body); }
    [[nodiscard]] Vec3 start_of(std::int32_t body) const { return view_.trajectories.start_pose(at(body)).com; }

    /// In terms of the bodies' velocities: its points go on chords, and are seen from where the bodies are then.
    [[nodiscard]] MetHit met_hit(const ClusterHit& found, const Impulsive& a, const Impulsive& b, int tries,
                                 int most) const {
        const SweptContact swept = swept_contact(view_, found);
        const PairLengths lengths = pair_lengths(view_.model, view_.state, found.a, found.b);
        const Vec3& n = swept.point.normal;
        const HitAnswer answer = answer_to(view_.dt, swept, dot(n, b.velocity - a.velocity), lengths, tries, most);
        MetHit out;
        if (!answer.on_centres && !turns_far(a.angular_velocity, view_.dt)) out.arm_a = swept.point.arm_a;
        if (!answer.on_centres && !turns_far(b.angular_velocity, view_.dt)) out.arm_b = swept.point.arm_b;
        const Vec3 chords =
            swept.point.relative_velocity - (point_velocity(b, out.arm_b) - point_velocity(a, out.arm_a));
        Contact& c = out.contact;
        c.a = found.a, c.b = found.b;
        c.normal = n;
        c.distance = swept.start_gap;
        c.target = answer.target - dot(n, chords);
        c.slip = dot(n, chords) * n - chords;
        c.friction = swept.point.friction;
        c.feature_key = static_cast<std::uint64_t>(tries);
        c.tolerance = kUndone * lengths.rest / view_.dt;
        return out;
    }

    /// Fills island_.
    void find_islands_of_hits() {
        bodies_of_.clear();
        movable_.resize(view_.model.size());
        for (const MetHit& hit : kept_) {
            bodies_of_.push_back({hit.contact.a, hit.contact.b});
            for (const std::int32_t body : {hit.contact.a, hit.contact.b})
                movable_[at(body)] = view_.clusters[body].infinite() ? 0 : 1;
        }
        island_.resize(kept_.size());
        changed_.assign(at(find_islands(bodies_of_, movable_, graph_, island_)), 0);
    }

    /// Marks islands of one body that others of infinite mass hold between them: impulses make no room there, and what
    /// is found takes it out sideways.
    void mark_pinched() {
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
    void leave_islands() {
        mark_pinched();
        std::vector<std::ptrdiff_t> hits(changed_.size(), 0);
        for (const std::int32_t i : island_) ++hits[at(i)];
        for (std::size_t i = 0; i < kept_.size(); ++i) {
            const Contact& c = kept_[i].contact;
            if (hits[at(island_[i])] > kMostHitsTogether || is_left(c.a) || is_left(c.b)) changed_[at(island_[i])] = 1;
        }
        leave_changed();
    }

    void leave_changed() {
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
    void move_islands(bool by_impulses) {
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
                apply_impulse(movers_.clusters(), workers_[0], c.a, c.b,
                              {c.normal, hit.arm_a, hit.arm_b, {}, c.friction}, hit.impulse);
        }
        collect(workers_, counters_);
        for (const std::int32_t body : moved_) movers_.evolve(body);
    }

    /// Moves bodies by what solves all that is kept; what hits then is met again. Islands that have no solution are
    /// left: more hits would not give them one.
    void solve() {
        contacts_.clear(), impulses_.clear();
        for (const MetHit& hit : kept_) {
            Contact c = hit.contact;
            c.point = start_of(c.a) + hit.arm_a;
            c.across = start_of(c.b) + hit.arm_b - c.point;
            contacts_.push_back(c), impulses_.push_back(hit.impulse);
        }
        const Stopwatch watch(workers_[0].counters.response_ms);
        const std::span<const std::uint8_t> unsolved = solve_(contacts_, motion_, impulses_);
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
        move_islands(true);
    }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    const SolveHits& solve_;
    StageCounters& counters_;
    std::vector<Motion> motion_;            ///< by body, before any of it
    std::vector<ClusterChange> before_;     ///< the same of its cluster
    ClusterPairs clusters_;                 ///< frozen
    std::vector<ClusterHit> hits_;          ///< by pair of clusters
    std::vector<ClusterHit> found_;         ///< of these, what there is
    std::vector<MetHit> kept_;              ///< sorted by bodies
    std::vector<std::uint8_t>& left_;       ///< by body, as flags: to the failsafe
    std::atomic<bool> passed_over_ = false; ///< a pair of theirs that may hit
    std::vector<BodyPair> bodies_of_;       ///< of kept_, as the next
    std::vector<std::int32_t> island_;
    std::vector<std::uint8_t> changed_; ///< by island, as flags
    std::vector<std::size_t> places_;   ///< in kept_
    std::vector<std::uint8_t> movable_; ///< by body
    ContactGraphScratch graph_;
    std::vector<Contact> contacts_; ///< of kept_
    std::vector<Vec3> impulses_;    ///< N s, likewise
    std::vector<std::int32_t> moved_;
};

} // namespace

bool resolve_jointly(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve& joint,
                     StageCounters& counters) {
    return JointHits(view, movers, book, workers, joint, counters).run();
}

} // namespace flotilla
