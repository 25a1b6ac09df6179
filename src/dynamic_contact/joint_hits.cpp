// SPDX-License-Identifier: MIT
#include "dynamic_contact/joint_hits.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/index.hpp"
#include "islands/contact_graph.hpp"
#include "pair/cluster_query.hpp"
#include "pair/examine.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16; // pairs of a task
/// What a solve may leave undone, of a rest distance in the step: hits are answered by several of them.
constexpr double kUndone = 1.0 / 16;
/// Rounds: what ends does so within these, 9,900 of 10,000 times within ten.
constexpr int kMostRounds = 16;
/// Hits of an island: what a solve takes grows faster than their number.
constexpr std::ptrdiff_t kMostHits = 128;

/// A hit that is kept, and what it was answered with.
struct MetHit {
    Contact contact;
    Vec3 impulse; ///< N s, on b
};

class JointHits {
  public:
    JointHits(const StepView& view, Movers movers, PairBook& book, Workers& workers, const SolveHits& solve,
              StageCounters& counters)
        : view_(view),
          movers_(movers),
          book_(book),
          workers_(workers),
          solve_(solve),
          counters_(counters),
          motion_(view.clusters.motion()),
          left_(view.model.size(), 0) {}

    bool run() {
        for (int round = 0; round < kMostRounds; ++round) {
            const FrozenList frozen = freeze_clusters(view_, book_, workers_.team, clusters_);
            look(frozen);
            if (found_.empty()) return !any_left_;
            keep();
            leave_large();
            solve();
            ++counters_.sweeps;
        }
        return false;
    }

  private:
    /// Fills found_ with the first hit of each pair, in the order of the pairs, but for bodies that are left.
    void look(const FrozenList& frozen) {
        hits_.assign(clusters_.pairs.size(), {});
        workers_.team.for_each("look for hits", clusters_.pairs.size(), kPairGrain, [&](std::size_t i, int thread) {
            const CandidatePair& pair = clusters_.pairs[i];
            if (apart(view_.trajectories, *frozen.pairs[i].record) || is_left(pair.a) || is_left(pair.b)) return;
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
        any_left_ = true;
        for (const std::int32_t body : {a, b})
            if (!view_.clusters[body].infinite()) left_[at(body)] = 1;
    }

    [[nodiscard]] static bool by_bodies(const MetHit& x, const MetHit& y) {
        return std::tuple(x.contact.a, x.contact.b) < std::tuple(y.contact.a, y.contact.b);
    }

    /// Adds what was found to what is kept, by bodies. Bodies of a pair that has had all its tries are left.
    void keep() {
        const auto before = static_cast<std::ptrdiff_t>(kept_.size());
        const int most = std::min(view_.model.settings.dynamic_pair_iterations, kMostTries);
        for (const ClusterHit& found : found_) {
            MetHit hit;
            hit.contact.a = found.a, hit.contact.b = found.b;
            const auto [first, last] = std::equal_range(kept_.begin(), kept_.begin() + before, hit, by_bodies);
            const auto tries = static_cast<int>(last - first);
            const Impulsive a = impulsive(found.a), b = impulsive(found.b);
            if (tries >= most || (found.hit.by_turn && turns_stay(a, b, view_.dt))) {
                leave(found.a, found.b);
                continue;
            }
            hit.contact = contact_of(found, a, b, tries, most);
            kept_.push_back(hit);
        }
        std::stable_sort(kept_.begin(), kept_.end(), by_bodies);
    }

    /// Islands of too many hits.
    void leave_large() {
        if (std::ssize(kept_) <= kMostHits) return;
        bodies_of_.clear();
        movable_.resize(view_.model.size());
        for (const MetHit& hit : kept_) {
            bodies_of_.push_back({hit.contact.a, hit.contact.b});
            for (const std::int32_t body : {hit.contact.a, hit.contact.b})
                movable_[at(body)] = view_.clusters[body].infinite() ? 0 : 1;
        }
        island_.resize(kept_.size());
        find_islands(bodies_of_, movable_, graph_, island_);
        for (std::size_t i = 0; i < kept_.size(); ++i)
            if (std::ranges::count(island_, island_[i]) > kMostHits) leave(kept_[i].contact.a, kept_[i].contact.b);
    }

    [[nodiscard]] Impulsive impulsive(std::int32_t body) const { return view_.clusters.impulsive(body); }

    /// A hit in terms of the bodies' velocities: its points go on chords, and are seen from where the bodies are then.
    [[nodiscard]] Contact contact_of(const ClusterHit& found, const Impulsive& a, const Impulsive& b, int tries,
                                     int most) const {
        const SweptContact swept = swept_contact(view_, found);
        const PairLengths lengths = pair_lengths(view_.model, view_.state, found.a, found.b);
        const Vec3 &n = swept.point.normal, between = b.velocity - a.velocity;
        const HitAnswer answer = answer_to(view_.dt, swept, dot(n, between), lengths, tries, most);
        const auto arm = [&](const Impulsive& body, const Vec3& of_hit) {
            return answer.on_centres || turns_far(body.angular_velocity, view_.dt) ? Vec3{} : of_hit;
        };
        const Vec3 arm_a = arm(a, swept.point.arm_a), arm_b = arm(b, swept.point.arm_b);
        const Vec3 chords = swept.point.relative_velocity - (point_velocity(b, arm_b) - point_velocity(a, arm_a));
        Contact out;
        out.a = found.a, out.b = found.b;
        out.normal = n;
        out.point = view_.trajectories.start_pose(at(found.a)).com + arm_a;
        out.across = view_.trajectories.start_pose(at(found.b)).com + arm_b - out.point;
        out.distance = swept.start_gap;
        out.target = answer.target - dot(n, chords);
        out.slip = dot(n, chords) * n - chords;
        out.friction = swept.point.friction;
        out.feature_key = static_cast<std::uint64_t>(tries);
        out.tolerance = kUndone * lengths.rest / view_.dt;
        return out;
    }

    /// Moves bodies by what solves all that is kept, or comes near to it: what still hits then is met again.
    void solve() {
        std::erase_if(kept_, [&](const MetHit& hit) { return is_left(hit.contact.a) || is_left(hit.contact.b); });
        contacts_.clear(), impulses_.clear();
        for (const MetHit& hit : kept_) contacts_.push_back(hit.contact), impulses_.push_back(hit.impulse);
        solve_(contacts_, motion_, impulses_);
        moved_.clear();
        for (std::size_t i = 0; i < kept_.size(); ++i) {
            MetHit& hit = kept_[i];
            const Contact& c = hit.contact;
            const Vec3 change = impulses_[i] - std::exchange(hit.impulse, impulses_[i]);
            if (change == Vec3{}) continue;
            const auto arm = [&](std::int32_t body) {
                return point_on(c, body) - view_.trajectories.start_pose(at(body)).com;
            };
            apply_impulse(movers_.clusters(), workers_[0], c.a, c.b, {c.normal, arm(c.a), arm(c.b), {}, c.friction},
                          change);
            for (const std::int32_t body : {c.a, c.b})
                if (!view_.clusters[body].infinite()) moved_.push_back(body);
        }
        collect(workers_, counters_);
        std::sort(moved_.begin(), moved_.end());
        moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
        for (const std::int32_t body : moved_) movers_.evolve(body);
    }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    const SolveHits& solve_;
    StageCounters& counters_;
    std::vector<Motion> motion_;     ///< by body, before any of it
    ClusterPairs clusters_;          ///< frozen
    std::vector<ClusterHit> hits_;   ///< by pair of clusters
    std::vector<ClusterHit> found_;  ///< of these, what there is
    std::vector<MetHit> kept_;       ///< sorted by bodies
    std::vector<std::uint8_t> left_; ///< by body, as flags: to the failsafe
    bool any_left_ = false;
    std::vector<BodyPair> bodies_of_; ///< of kept_, as the next
    std::vector<std::int32_t> island_;
    std::vector<std::uint8_t> movable_; ///< by body
    ContactGraphScratch graph_;
    std::vector<Contact> contacts_; ///< of kept_
    std::vector<Vec3> impulses_;    ///< N s, likewise
    std::vector<std::int32_t> moved_;
};

} // namespace

bool resolve_jointly(const StepView& view, Movers movers, PairBook& book, Workers& workers, const SolveHits& solve,
                     StageCounters& counters) {
    return JointHits(view, movers, book, workers, solve, counters).run();
}

} // namespace flotilla
