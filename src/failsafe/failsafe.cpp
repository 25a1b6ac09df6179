// SPDX-License-Identifier: MIT
#include "failsafe/failsafe.hpp"

#include <algorithm>

#include "base/assert.hpp"
#include "base/index.hpp"
#include "pair/pair_distance.hpp"

namespace flotilla {
namespace {

/// How much a motion that keeps bodies apart may shrink their distance, at most (Clusters::evolve).
constexpr double kShrinks = 2;

struct Member {
    Box box;
    double reach; ///< m
    std::int32_t body;
};

class Failsafe {
  public:
    Failsafe(const StepView& view, Movers movers, PairBook& book, Workers& workers)
        : view_(view), movers_(movers), book_(book), workers_(workers) {}

    FailsafeStats run() {
        while (true) {
            check_moved_clusters();
            freeze_clusters(view_, book_, workers_.team, list_);
            if (list_.pairs.empty()) break;
            merged_.assign(view_.model.size(), 0);
            lowered_.assign(view_.model.size(), 0);
            for (const CandidatePair& pair : list_.pairs) operate(clusters_of(pair));
            ++stats_.counters.sweeps;
            FLOTILLA_ASSERT(within_bounds());
        }
        collect(workers_, stats_.counters);
        std::sort(stats_.delayed_scripts.begin(), stats_.delayed_scripts.end());
        return std::move(stats_);
    }

  private:
    /// README.md#bounds.
    [[nodiscard]] bool within_bounds() const {
        const auto bodies = std::ssize(view_.model.active);
        return stats_.merges < bodies && stats_.rung_changes <= 3 * bodies;
    }

    /// Clusters whose motion does not keep their members apart by itself need a proof for every pair of members, others
    /// for those that are nearer than rounding can tell; without it a kinematic one becomes rigid and a rigid one is
    /// held (step/certificate.hpp).
    void check_moved_clusters() {
        joined_.clear();
        for (const std::int32_t body : view_.model.active)
            if (view_.clusters.of(at(body)) != body) joined_.push_back(view_.clusters.of(at(body)));
        std::sort(joined_.begin(), joined_.end());
        joined_.erase(std::unique(joined_.begin(), joined_.end()), joined_.end());
        for (const std::int32_t c : joined_) {
            Cluster& cluster = clusters()[c];
            while (cluster.members.size() > 1 && cluster.rung != Rung::held && !members_apart(c)) go_down(c);
            cluster.internal_proved = true;
        }
    }

    bool members_apart(std::int32_t c) {
        const bool kept_apart = view_.clusters[c].internal_proved;
        gather_members(c, kept_apart);
        double widest = 0;
        for (const Member& m : members_) widest = std::max(widest, m.reach);
        for (auto x = members_.begin(); x != members_.end(); ++x)
            for (auto y = x + 1; y != members_.end(); ++y) {
                if (y->box.lower.x - x->box.upper.x > x->reach + widest) break;
                if (boxes_overlap(x->box, y->box, x->reach + y->reach) &&
                    !(kept_apart && far_enough(x->body, y->body)) && !proved_apart(x->body, y->body))
                    return false;
            }
        return true;
    }

    /// Fills members_, sorted along x: with boxes at x^n that reach as far as far_enough() asks for, or those that a
    /// continuous query would ask about.
    void gather_members(std::int32_t c, bool at_start) {
        members_.clear();
        for (const std::int32_t i : view_.clusters[c].members) {
            const BodyMotion motion = view_.trajectories.motion(at(i));
            if (at_start)
                members_.push_back({*motion.at0.box, kShrinks * ccd_floor(motion.max_abs()), i});
            else
                members_.push_back({motion.swept(), list_reach(view_.model, at(i), ListReach::separation), i});
        }
        std::sort(members_.begin(), members_.end(), [](const Member& x, const Member& y) {
            return std::pair(x.box.lower.x, x.body) < std::pair(y.box.lower.x, y.body);
        });
    }

    bool proved_apart(std::int32_t a, std::int32_t b) {
        PairRecord& record = book_.table.get(view_.model, view_.state, a, b);
        return apart(view_.trajectories, record) ||
               !boxes_overlap(view_.trajectories.motion(at(a)).swept(), view_.trajectories.motion(at(b)).swept(),
                              record.lengths.separation) ||
               !query(view_, workers_[0], record).hit;
    }

    /// Whether a common motion that halves the distance of two bodies at most keeps it above the rounding of their
    /// coordinates.
    bool far_enough(std::int32_t a, std::int32_t b) {
        const BodyMotion x = view_.trajectories.motion(at(a)), y = view_.trajectories.motion(at(b));
        const double least = kShrinks * ccd_floor(std::max(x.max_abs(), y.max_abs()));
        if (!boxes_overlap(*x.at0.box, *y.at0.box, least)) return true;
        PairRecord& record = book_.table.get(view_.model, view_.state, a, b);
        const double start = start_distance(view_, workers_[0], record, record.cache);
        return std::min(start, kShrinks * record.lengths.separation) > least;
    }

    /// Of bodies of those that were frozen: the clusters that have them by now.
    [[nodiscard]] CandidatePair clusters_of(const CandidatePair& pair) const {
        const std::int32_t a = view_.clusters.of(at(pair.a)), b = view_.clusters.of(at(pair.b));
        return {std::min(a, b), std::max(a, b)};
    }

    void operate(const CandidatePair& pair) {
        if (pair.a == pair.b || lowered_[at(pair.a)] != 0 || lowered_[at(pair.b)] != 0) return;
        const bool infinite_a = view_.clusters[pair.a].infinite(), infinite_b = view_.clusters[pair.b].infinite();
        const bool infinite = infinite_a || infinite_b;
        if (infinite && (merged_[at(pair.a)] != 0 || merged_[at(pair.b)] != 0)) return;
        ++stats_.counters.pairs;
        const Resolution r = resolve_inelastic(view_, movers_, book_.table, workers_[0], pair,
                                               view_.model.settings.dynamic_pair_iterations);
        if (!r.found) return;
        if (stats_.trigger_a < 0) stats_.trigger_a = r.first_a, stats_.trigger_b = r.first_b;
        if (infinite_a && infinite_b) {
            const bool first = view_.model.bodies[at(pair.a)].scripted();
            hold_script(first ? pair.a : pair.b, first ? r.first_b : r.first_a, r.toi);
        } else if (infinite) {
            meet_infinite(infinite_a ? pair.b : pair.a, infinite_a ? pair.a : pair.b, r.resolved);
        } else {
            merge(pair, !r.resolved || view_.model.settings.rigidification != Rigidification::kinematic);
        }
    }

    /// The first conflict with a body of infinite mass since the last merge counts as resolved if it is; else down.
    void meet_infinite(std::int32_t cluster, std::int32_t infinite, bool resolved) {
        auto& met = clusters()[cluster].resolved_against;
        const bool again = std::find(met.begin(), met.end(), infinite) != met.end();
        if (resolved && !again) {
            met.push_back(infinite);
            return;
        }
        lowered_[at(cluster)] = 1;
        go_down(cluster);
    }

    void merge(const CandidatePair& pair, bool rigid) {
        ++stats_.merges;
        const std::int32_t merged = clusters().merge(pair.a, pair.b, rigid, view_.dt, view_.trajectories);
        merged_[at(merged)] = 1;
        if (rigid) movers_.evolve(merged);
    }

    /// One rung down. A body alone moves in the same way on the first three, so it goes to the last at once.
    void go_down(std::int32_t id) {
        Cluster& c = clusters()[id];
        ++stats_.rung_changes;
        if (c.rung < Rung::rigid && c.members.size() > 1) {
            clusters().make_rigid(id, view_.trajectories);
            c.resolved_against.clear();
            movers_.evolve(id);
        } else {
            clusters().hold(id, trajectories());
        }
    }

    /// A script goes as far as what stands in its way, if that is anywhere, and where that is not proved either it
    /// stays at x^n. So it is held twice at most.
    void hold_script(std::int32_t body, std::int32_t victim, double toi) {
        constexpr double kOfWay = 0.9, kLeastShare = 1.0 / 64; // below it a body hardly moves, and queries cost as ever
        if (view_.trajectories.still(at(body))) return;
        auto& delayed = stats_.delayed_scripts;
        const auto known = std::find_if(delayed.begin(), delayed.end(), [&](const auto& d) { return d.body == body; });
        const bool again = known != delayed.end();
        const double share = again || kOfWay * toi < kLeastShare ? 0.0 : kOfWay * toi;
        if (share > 0)
            shorten(body, share);
        else
            trajectories().hold(at(body));
        const Motion& motion = view_.clusters.motion()[at(body)];
        clusters().set_script(body, share > 0 ? Motion{share * motion.velocity, share * motion.momentum} : Motion{});
        if (again)
            known->share = 0;
        else
            delayed.push_back({body, share, victim});
    }

    /// The first part of a body's way.
    void shorten(std::int32_t body, double share) {
        const Pose &start = view_.trajectories.start_pose(at(body)), &end = view_.trajectories.end_pose(at(body));
        const Vec3 turn = share * view_.trajectories.turn(at(body));
        const Quat rotation = turn == Vec3{} ? start.rotation : normalized(rotation_from_vector(turn) * start.rotation);
        const Vec3 com = start.com + share * (end.com - start.com);
        trajectories().set_end(at(body), make_pose(view_.model.shape_of(at(body)), com, rotation), turn);
    }

    Clusters& clusters() { return movers_.clusters(); }
    Trajectories& trajectories() { return movers_.trajectories(); }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    FailsafeStats stats_;
    ClusterPairs list_;
    std::vector<std::int32_t> joined_;  ///< clusters of several bodies
    std::vector<Member> members_;       ///< of one cluster
    std::vector<std::uint8_t> merged_;  ///< clusters that this sweep made
    std::vector<std::uint8_t> lowered_; ///< those that it took a rung down
};

} // namespace

FailsafeStats run_failsafe(const StepView& view, Movers movers, PairBook& book, Workers& workers) {
    return Failsafe(view, movers, book, workers).run();
}

} // namespace flotilla
