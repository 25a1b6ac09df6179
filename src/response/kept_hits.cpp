// SPDX-License-Identifier: MIT
#include "response/kept_hits.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "response/arc.hpp"

namespace flotilla {
namespace {

/// A bound on the sweeps over the hits of an island, which end when no impulse changes: an island has more hits than a
/// pair. Not measured.
constexpr int kSweeps = 200;
/// The share of the fastest approach met in a round that is left undone.
constexpr double kTolerance = 1e-4;
/// The same of what sweeps that came to their bound may leave. More is a blow that does not get through.
constexpr double kLeft = 1.0 / 16;

/// The largest eigenvalue of a symmetric matrix in the plane across a unit vector, where it has two: from their sum and
/// that of their squares.
double largest_across(const Mat3& m, const Vec3& n) {
    const Vec3 mn = m * n;
    const double along = dot(n, mn);
    const double sum = m.m[0] + m.m[4] + m.m[8] - along;
    const double squares =
        length_sq(row(m, 0)) + length_sq(row(m, 1)) + length_sq(row(m, 2)) - 2 * length_sq(mn) + along * along;
    return 0.5 * (sum + std::sqrt(std::max(0.0, 2 * squares - sum * sum)));
}

class Island {
  public:
    Island(std::span<KeptHit> hits, std::span<const std::int32_t> places, HitBodies& bodies)
        : hits_(hits), places_(places), bodies_(bodies) {}

    bool run() {
        for (const std::int32_t k : places_) {
            KeptHit& hit = hits_[at(k)];
            hit.change = {};
            hit.seen = hit.met || hit.fresh ? -1 : 0;
        }
        find_owners();
        while (meet()) {
            run_sweeps(false);
            run_sweeps(true);
            for (const std::int32_t k : places_) wake(hits_[at(k)]);
        }
        return ended_;
    }

  private:
    Impulsive& body(std::int32_t i) { return bodies_.body[at(i)]; }

    [[nodiscard]] Vec3 rigid(const KeptHit& hit) {
        return point_velocity(body(hit.b), hit.point.arm_b) - point_velocity(body(hit.a), hit.point.arm_a);
    }
    [[nodiscard]] Vec3 relative(const KeptHit& hit) { return rigid(hit) + hit.point.relative_velocity; }

    /// The velocity that the pair's impulses of this step gave the points of a hit against each other.
    [[nodiscard]] Vec3 by_pair(const KeptHit& hit, std::span<const std::int32_t> pair) {
        Impulsive a = body(hit.a), b = body(hit.b);
        a.velocity = a.angular_velocity = b.velocity = b.angular_velocity = {};
        for (const std::int32_t k : pair) push(hits_[at(k)].point, hits_[at(k)].impulse, a, b);
        return point_velocity(b, hit.point.arm_b) - point_velocity(a, hit.point.arm_a);
    }

    /// Bodies of infinite mass are those of other islands as well, which may be read side by side.
    static void push(const ContactPoint& point, const Vec3& impulse, Impulsive& a, Impulsive& b) {
        if (a.inverse_mass > 0) {
            a.velocity -= velocity_change(a, impulse);
            a.angular_velocity -= a.inverse_inertia * cross(point.arm_a, impulse);
        }
        if (b.inverse_mass > 0) {
            b.velocity += velocity_change(b, impulse);
            b.angular_velocity += b.inverse_inertia * cross(point.arm_b, impulse);
        }
    }

    /// Begins the rebound of fresh hits; whether there are any.
    bool meet() {
        fastest_ = 0;
        for (std::size_t i = 0; i < places_.size();) {
            const KeptHit& first = hits_[at(places_[i])];
            std::size_t end = i;
            bool fresh = false;
            for (; end < places_.size(); ++end) {
                const KeptHit& hit = hits_[at(places_[end])];
                if (hit.a != first.a || hit.b != first.b) break;
                fresh = fresh || hit.fresh;
            }
            if (fresh) meet_pair(places_.subspan(i, end - i));
            i = end;
        }
        return fastest_ > 0;
    }

    [[nodiscard]] static std::int64_t key(const KeptHit& hit) { return (std::int64_t{hit.a} << 32) + hit.b; }

    /// The pair that each body had impulses of in this step.
    void find_owners() {
        for (const std::int32_t k : places_)
            for (const std::int32_t i : {hits_[at(k)].a, hits_[at(k)].b})
                if (body(i).inverse_mass > 0) bodies_.owner[at(i)] = HitBodies::kNone;
        for (const std::int32_t k : places_)
            if (hits_[at(k)].impulse != Vec3{}) own(hits_[at(k)]);
    }
    void own(const KeptHit& hit) {
        for (const std::int32_t i : {hit.a, hit.b}) {
            if (!(body(i).inverse_mass > 0)) continue;
            std::int64_t& owner = bodies_.owner[at(i)];
            owner = owner == HitBodies::kNone || owner == key(hit) ? key(hit) : HitBodies::kMany;
        }
    }

    /// Whether the pair's hits may be solved again, from before their impulses: no other pair pushed its bodies since,
    /// and none of them had its rebound and approaches again.
    [[nodiscard]] bool may_begin_anew(std::span<const std::int32_t> pair) {
        const KeptHit& first = hits_[at(pair[0])];
        for (const std::int32_t i : {first.a, first.b})
            if (body(i).inverse_mass > 0 && bodies_.owner[at(i)] != key(first)) return false;
        return std::all_of(pair.begin(), pair.end(), [&](std::int32_t k) {
            const KeptHit& hit = hits_[at(k)];
            return hit.impulse == Vec3{} || (!hit.fresh && dot(hit.point.normal, relative(hit)) >= 0);
        });
    }

    void begin_anew(std::span<const std::int32_t> pair) {
        const KeptHit& first = hits_[at(pair[0])];
        save(first.a);
        save(first.b);
        for (const std::int32_t k : pair) {
            KeptHit& hit = hits_[at(k)];
            if (hit.impulse == Vec3{}) continue;
            hit.aim = std::min(hit.target, dot(hit.point.normal, relative(hit)));
            hit.live = true;
            hit.start = hit.next = hit.impulse;
            Impulsive a = body(hit.a), b = body(hit.b);
            if (a.inverse_mass > 0) a = bodies_.before[at(hit.a)];
            if (b.inverse_mass > 0) b = bodies_.before[at(hit.b)];
            push(hit.point, -hit.impulse, a, b);
            if (a.inverse_mass > 0) bodies_.before[at(hit.a)] = a;
            if (b.inverse_mass > 0) bodies_.before[at(hit.b)] = b;
        }
    }

    void meet_pair(std::span<const std::int32_t> pair) {
        const bool anew = may_begin_anew(pair);
        if (anew) begin_anew(pair);
        for (const std::int32_t k : pair) {
            KeptHit& hit = hits_[at(k)];
            if (!hit.fresh) continue;
            hit.fresh = false;
            const Vec3 u = hit.point.relative_velocity;
            const double vn = dot(hit.point.normal, u);
            fastest_ = std::max(fastest_, length(u));
            if (!hit.met) {
                const double first = anew ? vn - dot(hit.point.normal, by_pair(hit, pair)) : vn;
                hit.target = hit.aim = std::max(0.0, -hit.restitution * first);
            }
            hit.met = hit.live = true;
            hit.point.relative_velocity = u - rigid(hit);
            const Mat3 m = collision_matrix(body(hit.a), body(hit.b), hit.point.arm_a, hit.point.arm_b);
            hit.mass_normal = normal_mobility(body(hit.a), body(hit.b), hit.point, m);
            hit.mass_tangent = largest_across(m, hit.point.normal);
            hit.seen = -1;
        }
    }

    void save(std::int32_t i) {
        if (!(body(i).inverse_mass > 0) || bodies_.saved[at(i)] != 0) return;
        bodies_.saved[at(i)] = 1;
        bodies_.before[at(i)] = body(i);
        changed_.push_back(i);
    }

    void apply(const KeptHit& hit, const Vec3& impulse) {
        for (const std::int32_t i : {hit.a, hit.b}) {
            save(i);
            if (body(i).inverse_mass > 0) bodies_.stamp[at(i)] = clock_;
        }
        push(hit.point, impulse, body(hit.a), body(hit.b));
    }

    /// A hit that sweeps may change: beside one another, as most sweeps change few of many.
    struct Turn {
        std::int32_t hit, a, b;
        std::int64_t seen; ///< when the velocities were last looked at
    };

    template <class Looked> // a KeptHit or a Turn
    [[nodiscard]] bool stale(const Looked& x) const {
        return bodies_.stamp[at(x.a)] > x.seen || bodies_.stamp[at(x.b)] > x.seen;
    }

    /// Of what rebounds, or of all that was met so far.
    void run_sweeps(bool all) {
        const auto is_within = [&](std::int32_t k) { return hits_[at(k)].met && hits_[at(k)].within; };
        if (std::ranges::any_of(places_, is_within)) sweep_on(all, false);
        sweep_on(all, true);
        end_round();
    }
    void sweep_on(bool all, bool within) {
        turns_.clear();
        for (const std::int32_t k : places_) {
            const KeptHit& hit = hits_[at(k)];
            if (hit.met && (hit.live || all) && (within || !hit.within)) turns_.push_back({k, hit.a, hit.b, hit.seen});
        }
        bool changes = true;
        for (int i = 0; i < kSweeps && changes; ++i) changes = sweep(i % 2 != 0);
        ended_ = ended_ && (!changes || left_undone() <= kLeft * fastest_);
        for (const Turn& turn : turns_) hits_[at(turn.hit)].seen = turn.seen;
    }

    /// m/s, the fastest approach of what takes part, to what it is to rebound with.
    [[nodiscard]] double left_undone() {
        double most = 0;
        for (const Turn& turn : turns_) {
            const KeptHit& hit = hits_[at(turn.hit)];
            if (hit.live) most = std::max(most, hit.aim - dot(hit.point.normal, relative(hit)));
        }
        return most;
    }

    /// Whether an impulse changed.
    bool sweep(bool backwards) {
        bool any = false;
        for (std::size_t i = 0; i < turns_.size(); ++i) {
            Turn& turn = turns_[backwards ? turns_.size() - 1 - i : i];
            if (!stale(turn)) continue;
            ++clock_;
            KeptHit& hit = hits_[at(turn.hit)];
            const bool changed = update(hit);
            any = any || changed;
            // Its normal is solved at once, friction in steps: it is looked at until they end, whoever else does not
            // move.
            turn.seen = changed && hit.point.friction > 0 ? clock_ - 1 : clock_;
        }
        return any;
    }

    /// As PairManifold::sweep().
    bool update(KeptHit& hit) {
        if (!(hit.mass_normal > 0)) return false;
        const Vec3& n = hit.point.normal;
        const Vec3 u = relative(hit);
        if (!hit.live && !(-dot(n, u) > hit.least)) return false;
        hit.live = true;
        bool any = false;
        const double old = dot(n, hit.next);
        double normal = std::max(0.0, old + (hit.aim - dot(n, u)) / hit.mass_normal);
        if (std::abs(normal - old) * hit.mass_normal > kTolerance * fastest_) {
            apply(hit, (normal - old) * n);
            hit.next += (normal - old) * n;
            any = true;
        } else {
            normal = old;
        }
        if (!(hit.point.friction > 0) || !(hit.mass_tangent > 0)) return any;
        const Vec3 slip = relative(hit), tangential = slip - dot(n, slip) * n;
        Vec3 wanted = hit.next - normal * n - tangential / hit.mass_tangent;
        const double size = length(wanted), bound = hit.point.friction * normal;
        if (size > bound) wanted = (bound / size) * wanted;
        const Vec3 change = wanted - (hit.next - normal * n);
        // A cone that shrank is not left, by however little.
        if (!(length(change) * hit.mass_tangent > kTolerance * fastest_) && !(any && size > bound)) return any;
        apply(hit, change);
        hit.next += change;
        return true;
    }

    /// How much of the round's impulses the energy allows that the island had before them ([13], as energy_clamp() has
    /// it for one).
    [[nodiscard]] double energy_share() {
        const auto before = [&](std::int32_t i, const Vec3& arm) {
            return point_velocity(bodies_.saved[at(i)] != 0 ? bodies_.before[at(i)] : body(i), arm);
        };
        double slope = 0, curvature = 0;
        for (const std::int32_t k : places_) {
            const KeptHit& hit = hits_[at(k)];
            const Vec3& d = hit.next;
            if (d == Vec3{}) continue;
            const Vec3 u = before(hit.b, hit.point.arm_b) - before(hit.a, hit.point.arm_a);
            slope += dot(d, u);
            curvature += dot(d, rigid(hit) - u);
        }
        if (!(slope < 0)) return 0;
        return curvature > -2 * slope ? -2 * slope / curvature : 1.0;
    }

    void end_round() {
        const double share = energy_share();
        if (share < 1) {
            ++clock_;
            for (const std::int32_t i : changed_) {
                const Impulsive& from = bodies_.before[at(i)];
                body(i).velocity = from.velocity + share * (body(i).velocity - from.velocity);
                body(i).angular_velocity =
                    from.angular_velocity + share * (body(i).angular_velocity - from.angular_velocity);
                bodies_.stamp[at(i)] = clock_;
            }
        }
        for (const std::int32_t k : places_) {
            KeptHit& hit = hits_[at(k)];
            if (!hit.met) continue;
            const Vec3 change = share * hit.next - hit.start;
            hit.impulse += change;
            hit.change += change;
            if (change != Vec3{}) own(hit);
            hit.start = hit.next = {};
            hit.aim = 0;
            hit.live = false;
        }
        for (const std::int32_t i : changed_) bodies_.saved[at(i)] = 0;
        changed_.clear();
    }

    /// A hit that waits is met where it approaches fast enough by now.
    void wake(KeptHit& hit) {
        if (hit.met || !stale(hit)) return;
        hit.seen = clock_;
        const Vec3 u = rigid(hit);
        const double approach = -dot(hit.point.normal, u);
        if (!(approach > std::max(hit.least, hit.room))) return;
        const double apart = dot(hit.point.normal, arc_acceleration(body(hit.b).angular_velocity, hit.point.arm_b) -
                                                       arc_acceleration(body(hit.a).angular_velocity, hit.point.arm_a));
        if (!(approach_on_arrival(approach, hit.gap, apart) > hit.least)) return;
        hit.fresh = true;
        hit.point.relative_velocity = u;
    }

    std::span<KeptHit> hits_;
    std::span<const std::int32_t> places_;
    HitBodies& bodies_;
    std::vector<std::int32_t> changed_; ///< bodies, in the round
    std::vector<Turn> turns_;
    double fastest_ = 0; ///< m/s, of what the round meets
    bool ended_ = true;  ///< all sweeps, before their bound
    std::int64_t clock_ = 0;
};

} // namespace

bool solve_hits(std::span<KeptHit> hits, std::span<const std::int32_t> island, HitBodies& bodies) {
    return Island(hits, island, bodies).run();
}

} // namespace flotilla
