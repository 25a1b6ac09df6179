// SPDX-License-Identifier: MIT
#include "dynamic_contact/dynamic_contact.hpp"

#include <algorithm>
#include <atomic>
#include <limits>

#include "pair/divided_sweep.hpp"
#include "pair/progress.hpp"

namespace flotilla {
namespace {

/// When Algorithm 2 is given up: after the limit of sweeps, when as many pairs hit again as had up to it and for half
/// as many sweeps the list of pairs was never shorter than before, nor the largest push less by a fifth; at ten limits
/// in any case, for what is pinched between bodies of infinite mass hits in every sweep and cannot be merged.
///
/// Hits get fewer geometrically, and what a sweep costs with them: of a hundred thousand a deep pile in an impact has a
/// few at the limit. In chain mail that is taut all rings hit to the end, but ever more softly. The failsafe would
/// merge those into clusters, and these with all that they push, which costs more than all sweeps did: twelve hits left
/// of 5,439 made one of 2,600 of 10,002 boats.
class Patience {
  public:
    explicit Patience(int limit) : limit_(limit) {}

    /// Of a sweep: pairs that hit, pairs listed, and the largest push, N s.
    void add(std::int64_t hits, std::size_t listed, double pushed) {
        ++sweeps_;
        (sweeps_ <= limit_ ? hits_ : more_hits_) += hits;
        if (listed < shortest_ || pushed < kLeastFall * weakest_) since_ = sweeps_;
        shortest_ = std::min(shortest_, listed);
        if (pushed < kLeastFall * weakest_) weakest_ = pushed;
    }

    [[nodiscard]] bool ends() const {
        if (sweeps_ / kMostLimits >= limit_) return true;
        return sweeps_ >= limit_ && more_hits_ >= hits_ && sweeps_ - since_ >= limit_ / 2;
    }

  private:
    static constexpr int kMostLimits = 10;
    static constexpr double kLeastFall = 0.8;
    int limit_, sweeps_ = 0, since_ = 0;
    std::int64_t hits_ = 0, more_hits_ = 0; ///< up to the limit, and after it
    std::size_t shortest_ = std::numeric_limits<std::size_t>::max();
    double weakest_ = std::numeric_limits<double>::infinity(); ///< N s
};

/// Algorithm 2.
class DynamicContact {
  public:
    DynamicContact(const StepView& view, Movers movers, PairBook& book, Workers& workers, JointSolve* joint)
        : view_(view),
          movers_(movers),
          book_(book),
          workers_(workers),
          joint_(view.model.settings.dynamic_iterations > 0 ? joint : nullptr),
          patience_(view.model.settings.dynamic_iterations) {}

    /// For all pairs of clusters that are not proved apart, resolve their hits; rigidify what neither that resolved nor
    /// all hits together; again, until every pair is proved apart.
    DynamicContactStats run() {
        for (int sweep = 0;; ++sweep) {
            FrozenList frozen = freeze_clusters(view_, book_, workers_.team, clusters_);
            if (clusters_.pairs.empty()) return stats_;
            stats_.counters.limit = patience_.ends() || progress_.stalled();
            if (stats_.counters.limit) {
                stats_.counters.limit = !together();
                return stats_;
            }
            if (alone()) close_apart(frozen);
            stats_.counters.pairs += static_cast<std::int64_t>(frozen.num_closed());
            if (frozen.num_open == 0) return stats_;
            const SweepPlan plan{sweep_order(view_, book_, workers_.team, clusters_.pairs.size(),
                                             [&](std::size_t i) { return clusters_.pairs[i]; }),
                                 sweep % 2 != 0};
            resolve(plan, frozen);
            if (some_may_be_helped() && together()) return stats_;
            rigidify(plan);
            ++stats_.counters.sweeps;
        }
    }

  private:
    /// Whether all clusters are single bodies: the frozen pairs of bodies are those of clusters, one for one.
    [[nodiscard]] bool alone() const { return stats_.merges == 0; }

    [[nodiscard]] bool is_left(std::int32_t body) const {
        return static_cast<std::size_t>(body) < joint_->left.size() &&
               joint_->left[static_cast<std::size_t>(body)] != 0;
    }
    /// Whether a pair did not resolve of which no body was left before: what cannot be merged, as between bodies of
    /// infinite mass, does not resolve in any sweep.
    [[nodiscard]] bool some_may_be_helped() const {
        if (joint_ == nullptr || !any_unresolved_) return false;
        for (std::size_t i = 0; i < resolutions_.size(); ++i)
            if (!resolutions_[i].resolved && !is_left(clusters_.pairs[i].a) && !is_left(clusters_.pairs[i].b))
                return true;
        return false;
    }
    /// Whether nothing hits any more. Else that is so of all pairs but those of bodies that are left.
    bool together() {
        if (joint_ == nullptr || !alone()) return false;
        if (resolve_together(view_, movers_, book_, workers_, *joint_, stats_.counters)) return true;
        for (std::size_t i = 0; i < resolutions_.size(); ++i)
            if (!is_left(clusters_.pairs[i].a) && !is_left(clusters_.pairs[i].b)) resolutions_[i].resolved = true;
        return false;
    }

    /// Runs the queries of few open pairs side by side.
    void close_apart(FrozenList& frozen) {
        close_early(view_, workers_, frozen,
                    [&](PairRecord& pair, Worker& worker) { return !query(view_, worker, pair).hit; });
    }

    /// Fills resolutions_, by pair of clusters.
    void resolve(const SweepPlan& plan, const FrozenList& frozen) {
        const bool single = alone();
        const int iterations = view_.model.settings.dynamic_pair_iterations;
        take_largest_push(workers_); // of other stages
        resolutions_.assign(clusters_.pairs.size(), {.resolved = true});
        const SweepOperation operation{
            "dynamic contact",
            [&](std::size_t i) { return single && apart(view_.trajectories, *frozen.pairs[i].record); },
            [&](std::size_t i) {
                if (single) fetch_record(*frozen.pairs[i].record);
            },
            [&](std::size_t i, int, Worker& worker) {
                ++worker.counters.pairs;
                resolutions_[i] =
                    resolve_inelastic(view_, movers_, book_.table, worker, clusters_.pairs[i], iterations);
            }};
        // Ranks tell one another of the pairs of bodies that are listed; a pair of larger clusters has several.
        if (single)
            run_sweep(workers_, book_.lists.sweep, plan, operation, shared_sweep(frozen));
        else
            run_here(workers_, book_.lists.sweep, plan, operation);
        collect(workers_, stats_.counters);
        const std::size_t hits = look_at_resolutions();
        const double pushed = take_largest_push(workers_);
        patience_.add(static_cast<std::ptrdiff_t>(hits), clusters_.pairs.size(), pushed);
        progress_.add(hits, clusters_.pairs.size(), pushed);
    }

    /// Returns how many pairs hit, and notes whether all of them resolved.
    std::size_t look_at_resolutions() {
        constexpr std::size_t kGrain = 1024; // pairs of a task
        std::atomic<std::size_t> hits = 0, left = 0;
        const std::size_t n = resolutions_.size();
        for_each(&workers_.team, "look at resolutions", (n + kGrain - 1) / kGrain, 1, [&](std::size_t chunk) {
            std::size_t found = 0, unresolved = 0;
            for (std::size_t i = chunk * kGrain; i < std::min(n, (chunk + 1) * kGrain); ++i) {
                found += resolutions_[i].found ? 1u : 0u;
                unresolved += resolutions_[i].resolved ? 0u : 1u;
            }
            hits.fetch_add(found, std::memory_order_relaxed);
            left.fetch_add(unresolved, std::memory_order_relaxed);
        });
        any_unresolved_ = left > 0;
        return hits;
    }

    [[nodiscard]] SharedSweep shared_sweep(const FrozenList& frozen) {
        return {movers_, [&](std::size_t i) -> PairRecord& { return *frozen.pairs[i].record; },
                [&](std::size_t i) { return std::as_writable_bytes(std::span(&resolutions_[i], 1)); }};
    }

    /// Makes one rigid cluster of each two that did not resolve, in the order of the sweep; of those that meet a
    /// cluster already merged the first counts.
    void rigidify(const SweepPlan& plan) {
        if (!any_unresolved_) return;
        for (std::size_t i = 0; i < plan.size(); ++i) {
            const std::size_t k = plan.place(0, i);
            if (!resolutions_[k].resolved) merge(clusters_.pairs[k], resolutions_[k]);
        }
    }

    void merge(const CandidatePair& pair, const Resolution& failed) {
        Clusters& clusters = movers_.clusters();
        if (clusters[pair.a].members.empty() || clusters[pair.b].members.empty()) return;
        if (clusters[pair.a].infinite() || clusters[pair.b].infinite()) return;
        if (stats_.merges++ == 0) stats_.trigger_a = failed.first_a, stats_.trigger_b = failed.first_b;
        movers_.evolve(clusters.merge(pair.a, pair.b, true, view_.dt, view_.trajectories));
    }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    JointSolve* joint_; ///< may be null; without sweeps all is the failsafe's
    DynamicContactStats stats_;
    ClusterPairs clusters_; ///< frozen
    std::vector<Resolution> resolutions_;
    bool any_unresolved_ = false; ///< of these
    Patience patience_;
    /// Giving up makes clusters of what hits: of 8 links of a tight chain in 100 steps, preset accurate, two trips
    /// alone leave 6 merges without need.
    Progress progress_{2, true};
};

} // namespace

DynamicContactStats handle_dynamic_contact(const StepView& view, Movers movers, PairBook& book, Workers& workers,
                                           JointSolve* joint) {
    return DynamicContact(view, movers, book, workers, joint).run();
}

} // namespace flotilla
