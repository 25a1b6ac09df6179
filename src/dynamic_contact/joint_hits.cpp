// SPDX-License-Identifier: MIT
#include "dynamic_contact/joint_hits.hpp"

#include <algorithm>
#include <tuple>

#include "base/index.hpp"
#include "dynamic_contact/least_impulses.hpp"
#include "islands/contact_graph.hpp"
#include "pair/cluster_query.hpp"
#include "pair/examine.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16; // pairs of a task
/// Hits of an island that are solved directly: the time of that grows with their cube, a second for some thousand.
constexpr std::size_t kMostHits = 512;

/// A hit that is kept, in terms of the clusters' velocities.
struct KeptPush {
    std::int32_t a = -1, b = -1; ///< bodies
    ContactPoint point;
    double chord = 0;   ///< m/s, along the normal: of the points on their way, above what the clusters' velocities say
    double target = 0;  ///< m/s, to be reached at least
    double impulse = 0; ///< N s, on b along the normal
};

class JointHits {
  public:
    JointHits(const StepView& view, Movers movers, PairBook& book, Workers& workers, StageCounters& counters)
        : view_(view), movers_(movers), book_(book), workers_(workers), counters_(counters) {}

    bool run() {
        left_.assign(view_.model.size(), 0);
        while (true) {
            const FrozenList frozen = freeze_clusters(view_, book_, workers_.team, clusters_);
            look(frozen);
            if (found_.empty()) return !any_left_;
            keep();
            solve();
            ++counters_.sweeps;
        }
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

    /// Adds what was found to what is kept, by bodies. Bodies of a pair that has had all its tries are left.
    void keep() {
        const auto by_bodies = [](const KeptPush& x, const KeptPush& y) {
            return std::tuple(x.a, x.b) < std::tuple(y.a, y.b);
        };
        const std::size_t before = kept_.size();
        const int most = std::min(view_.model.settings.dynamic_pair_iterations, kMostTries);
        for (const ClusterHit& found : found_) {
            KeptPush hit;
            hit.a = found.a, hit.b = found.b;
            const auto [first, last] =
                std::equal_range(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(before), hit, by_bodies);
            const auto tries = static_cast<int>(last - first);
            const Impulsive a = impulsive(hit.a), b = impulsive(hit.b);
            if (tries >= most || (found.hit.by_turn && turns_stay(a, b, view_.dt))) {
                leave(hit);
                continue;
            }
            const SweptContact contact = swept_contact(view_, found);
            const PairLengths lengths = pair_lengths(view_.model, view_.state, hit.a, hit.b);
            const double centres = dot(contact.point.normal, b.velocity - a.velocity);
            const HitAnswer answer = answer_to(view_.dt, contact, centres, lengths, tries, most);
            hit.point = contact.point;
            if (answer.on_centres || turns_far(a.angular_velocity, view_.dt)) hit.point.arm_a = {};
            if (answer.on_centres || turns_far(b.angular_velocity, view_.dt)) hit.point.arm_b = {};
            hit.chord = dot(hit.point.normal, contact.point.relative_velocity) - approach_of(hit);
            hit.target = answer.target;
            kept_.push_back(hit);
        }
        std::stable_sort(kept_.begin(), kept_.end(), by_bodies);
    }

    [[nodiscard]] bool is_left(std::int32_t body) const { return left_[at(body)] != 0; }
    /// To the failsafe.
    void leave(const KeptPush& hit) {
        any_left_ = true;
        for (const std::int32_t body : {hit.a, hit.b})
            if (!view_.clusters[body].infinite()) left_[at(body)] = 1;
    }

    [[nodiscard]] Impulsive impulsive(std::int32_t body) const { return view_.clusters.impulsive(body); }
    /// m/s, along the normal.
    [[nodiscard]] double approach_of(const KeptPush& hit) const {
        return dot(hit.point.normal, point_velocity(impulsive(hit.b), hit.point.arm_b) -
                                         point_velocity(impulsive(hit.a), hit.point.arm_a));
    }

    /// Islands of what is kept, one after the other. One without a solution, with too many hits or a script is left.
    void solve() {
        gather_islands();
        std::vector<std::int32_t> places;
        for (std::int32_t island = 0; island < islands_; ++island) {
            places.clear();
            for (std::size_t i = 0; i < kept_.size(); ++i)
                if (island_[i] == island) places.push_back(static_cast<std::int32_t>(i));
            const bool left = std::ranges::any_of(places, [&](std::int32_t k) { return leads_to_left(kept_[at(k)]); });
            if (left || places.size() > kMostHits || !solve_island(places))
                for (const std::int32_t k : places) leave(kept_[at(k)]);
        }
    }

    /// Whether a hit is of a body that is left, or of a script: what that squeezes goes aside here, without friction, by
    /// any way that is asked for, and is to make it wait.
    [[nodiscard]] bool leads_to_left(const KeptPush& hit) const {
        const auto leads = [&](std::int32_t body) {
            return is_left(body) || view_.model.bodies[at(body)].scripted();
        };
        return leads(hit.a) || leads(hit.b);
    }

    void gather_islands() {
        bodies_of_.clear();
        movable_.resize(view_.model.size());
        for (const KeptPush& hit : kept_) {
            bodies_of_.push_back({hit.a, hit.b});
            for (const std::int32_t body : {hit.a, hit.b}) movable_[at(body)] = view_.clusters[body].infinite() ? 0 : 1;
        }
        island_.resize(kept_.size());
        islands_ = find_islands(bodies_of_, movable_, graph_, island_);
    }

    bool solve_island(std::span<const std::int32_t> places) {
        impulses_.clear();
        for (const std::int32_t k : places) impulses_.push_back(kept_[at(k)].impulse);
        const std::vector<double> before = impulses_;
        if (!set_up(places) || !least_impulses(matrix_, missing_, impulses_)) return false;
        for (std::size_t i = 0; i < places.size(); ++i) {
            KeptPush& hit = kept_[at(places[i])];
            const double change = impulses_[i] - before[i];
            if (change == 0) continue;
            hit.impulse = impulses_[i];
            apply_impulse(movers_.clusters(), workers_[0], hit.a, hit.b, hit.point, change * hit.point.normal);
        }
        collect(workers_, counters_);
        for (const std::int32_t k : places)
            for (const std::int32_t body : {kept_[at(k)].a, kept_[at(k)].b})
                if (movable_[at(body)] != 0) movers_.evolve(body);
        return true;
    }

    /// What an impulse of 1 N s at a hit makes of a body's velocity.
    struct Response {
        Vec3 velocity, turn;
    };
    [[nodiscard]] Response response(const KeptPush& hit, std::int32_t body) const {
        const Impulsive x = impulsive(body);
        const Vec3 impulse = body == hit.b ? hit.point.normal : -hit.point.normal;
        return {velocity_change(x, impulse), x.inverse_inertia * cross(arm(hit, body), impulse)};
    }
    [[nodiscard]] static Vec3 arm(const KeptPush& hit, std::int32_t body) {
        return body == hit.b ? hit.point.arm_b : hit.point.arm_a;
    }

    /// Fills matrix_, and missing_ with what the points have of their targets. False where one cannot be moved.
    bool set_up(std::span<const std::int32_t> places) {
        const auto n = static_cast<std::ptrdiff_t>(places.size());
        matrix_.resize(n, n);
        missing_.resize(n);
        for (std::ptrdiff_t j = 0; j < n; ++j) {
            const KeptPush& push = kept_[at(places[static_cast<std::size_t>(j)])];
            const Response of_a = response(push, push.a), of_b = response(push, push.b);
            for (std::ptrdiff_t i = 0; i < n; ++i) {
                const KeptPush& hit = kept_[at(places[static_cast<std::size_t>(i)])];
                const auto change = [&](std::int32_t body) {
                    if (movable_[at(body)] == 0 || (body != push.a && body != push.b)) return Vec3{};
                    const Response& r = body == push.a ? of_a : of_b;
                    return r.velocity + cross(r.turn, arm(hit, body));
                };
                matrix_(i, j) = dot(hit.point.normal, change(hit.b) - change(hit.a));
            }
            if (!(matrix_(j, j) > 0)) return false;
            missing_[j] = approach_of(push) + push.chord - push.target;
        }
        return true;
    }

    const StepView& view_;
    Movers movers_;
    PairBook& book_;
    Workers& workers_;
    StageCounters& counters_;
    ClusterPairs clusters_;          ///< frozen
    std::vector<ClusterHit> hits_;   ///< by pair of clusters
    std::vector<ClusterHit> found_;  ///< of these, what there is
    std::vector<KeptPush> kept_;     ///< sorted by bodies
    std::vector<std::uint8_t> left_; ///< by body, as flags: to the failsafe
    bool any_left_ = false;
    std::vector<BodyPair> bodies_of_;
    std::vector<std::uint8_t> movable_; ///< by body
    std::vector<std::int32_t> island_;  ///< of each kept hit
    int islands_ = 0;
    ContactGraphScratch graph_;
    Eigen::MatrixXd matrix_;       ///< 1/kg
    Eigen::VectorXd missing_;      ///< m/s
    std::vector<double> impulses_; ///< N s
};

} // namespace

bool resolve_jointly(const StepView& view, Movers movers, PairBook& book, Workers& workers, StageCounters& counters) {
    return JointHits(view, movers, book, workers, counters).run();
}

} // namespace flotilla
