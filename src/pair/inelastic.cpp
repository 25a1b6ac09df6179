// SPDX-License-Identifier: MIT
#include "pair/inelastic.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "base/index.hpp"
#include "pair/cluster_query.hpp"
#include "pair/simultaneous_hits.hpp"
#include "parallel/compact.hpp"
#include "parallel/team_sort.hpp"

namespace flotilla {
namespace {

// The exact-rest target may lie below the present velocity when the bodies turn: the hit would stay. Then the approach
// is halved, later stopped, and if the points do not even approach they are pushed apart at this many separations per
// step. So it is done in the second half of the tries anyway: a body pinched by another from two sides, with less room
// than two rest distances, would be thrown from one side to the other (of 10,002 boats at rest one pair was merged for
// that in each of 141 steps).
constexpr double kPushSeparations = 4;

// So many impulses share out the tries of targets, whatever the limit: where the exact one does not end the hit,
// 50,000 tries of it do not either, and cost 40 s. Pushes after as many more are twice as far: with a rest distance of
// a micrometre those of four separations do not end in minutes where bodies of a metre are in each other's way.
constexpr int kMostTries = 20;

// Of those pushes: no end of tries may throw bodies out of what numbers can hold.
constexpr int kMostDoublings = 20;

// A contact's impulse turns a body by dt I^-1 (r x l), and its point then moves by that turn times r: as long as the
// turn is small. A thin body that is hit on an edge would turn many times instead, its point would be anywhere, and the
// next impulse would push again. Beyond this angle an impulse acts on the centre of mass alone, which moves the point
// by just as much as is asked for.
constexpr double kLargestTurn = 1; // radians

/// The impulse for the target; sets the arms of bodies that it, or their own spin, would turn too far to zero.
std::optional<Vec3> displacing_impulse(const Impulsive& a, const Impulsive& b, double dt, double target,
                                       ContactPoint& point) {
    auto impulse = contact_impulse(a, b, point, target);
    if (!impulse) return impulse;
    const auto turned_far = [&](const Impulsive& body, const Vec3& arm) {
        if (!(body.inverse_mass > 0)) return false;
        return turns_far(body.angular_velocity, dt) || turns_far(body.inverse_inertia * cross(arm, *impulse), dt);
    };
    const bool far_a = turned_far(a, point.arm_a), far_b = turned_far(b, point.arm_b);
    if (!far_a && !far_b) return impulse;
    if (far_a) point.arm_a = {};
    if (far_b) point.arm_b = {};
    return contact_impulse(a, b, point, target);
}

/// m/s, of the rigid bodies' points, b against a.
Vec3 relative_velocity(const Impulsive& a, const Impulsive& b, const ContactPoint& p) {
    return point_velocity(b, p.arm_b) - point_velocity(a, p.arm_a);
}

/// The ends of the line on which the points of a hit lie, its own and at least one other; nothing where they are the
/// corners of a side.
std::optional<std::array<ContactPoint, 2>> ends_of_line(const ContactPoint& point, std::span<const ContactPoint> others,
                                                        double reach) {
    const auto apart = [](const ContactPoint& p, const ContactPoint& q) { return length_sq(p.arm_b - q.arm_b); };
    const auto farthest = [&](const ContactPoint& from) {
        return *std::ranges::max_element(others, {}, [&](const ContactPoint& p) { return apart(p, from); });
    };
    const ContactPoint one = farthest(point);
    ContactPoint other = farthest(one);
    if (apart(point, one) >= apart(other, one)) other = point;
    const auto on_line = [&, along = normalized(other.arm_b - one.arm_b)](const ContactPoint& p) {
        return length(cross(along, p.arm_b - one.arm_b)) <= reach;
    };
    if (!on_line(point) || !std::ranges::all_of(others, on_line)) return std::nullopt;
    return std::array{one, other};
}

/// Moves the point to where an impulse changes the normal velocities of all points between the ends alike. That is
/// where the mobility is least, which is quadratic in the place.
void move_between(const std::array<ContactPoint, 2>& ends, const Impulsive& a, const Impulsive& b,
                  ContactPoint& point) {
    const auto between = [&](double share) {
        ContactPoint p = point;
        p.arm_a = (1 - share) * ends[0].arm_a + share * ends[1].arm_a;
        p.arm_b = (1 - share) * ends[0].arm_b + share * ends[1].arm_b;
        return p;
    };
    const auto mobility = [&](double share) {
        const ContactPoint p = between(share);
        return normal_mobility(a, b, p, collision_matrix(a, b, p.arm_a, p.arm_b));
    };
    const double first = mobility(0), last = mobility(1), bend = first + last - 2 * mobility(0.5);
    if (!(bend > 0)) return;
    const ContactPoint hit = point;
    point = between(std::clamp(0.5 + 0.25 * (first - last) / bend, 0.0, 1.0));
    point.relative_velocity += relative_velocity(a, b, point) - relative_velocity(a, b, hit);
}

/// Sets the place of the impulse where two bodies meet on a side or along a line, all of whose points are to do alike:
/// on a side the centres of mass, on a line where an impulse moves all of it alike. At one end of an edge that lands
/// flat it turned a stick of 2 cm by 0.08 rad about its length, and the blow of the next step, on the lower corner
/// alone, made that 66 rad/s.
void meet_alike(const StepView& view, Worker& worker, const ClusterHit& hit, double reach, ContactPoint& point) {
    constexpr std::size_t kSpan = 3; // beside the points of the hit itself
    const std::int32_t a = view.clusters.of(at(hit.a)), b = view.clusters.of(at(hit.b));
    if (view.clusters[a].members.size() > 1 || view.clusters[b].members.size() > 1) return;
    worker.hits.clear();
    find_simultaneous_hits(view, worker.footprints, hit, point, reach, {}, worker.hits);
    if (worker.hits.empty()) return;
    if (worker.hits.size() >= kSpan) {
        point.arm_a = point.arm_b = {};
        return;
    }
    const auto ends = ends_of_line(point, worker.hits, reach);
    if (!ends) return;
    const Impulsive body_a = view.clusters.impulsive(a), body_b = view.clusters.impulsive(b);
    const Vec3 parts = relative_velocity(body_a, body_b, (*ends)[0]) - relative_velocity(body_a, body_b, (*ends)[1]);
    if (std::abs(dot(point.normal, parts)) * view.dt <= reach) move_between(*ends, body_a, body_b, point);
}

} // namespace

bool turns_far(const Vec3& angular_velocity, double dt) {
    return length_sq(angular_velocity) * dt * dt > kLargestTurn * kLargestTurn;
}

// Impulses at one corner after the other of a side that lands flat tilt it to and fro for longer than there are tries,
// and what stops its points then stops the body where the step began: plates that met the floor by what gravity adds
// in one step fell no further, and hung above it for ever. An impulse on the centres of mass moves all points alike, so
// that each is asked for once: where it is these that come too near, at `centres` m/s, and not what turning does.
HitAnswer answer_to(double dt, const SweptContact& contact, double centres, const PairLengths& lengths, int iteration,
                    int iterations) {
    const double vn = dot(contact.point.normal, contact.point.relative_velocity);
    const double exact = (lengths.rest - contact.start_gap) / dt;
    if (exact > vn && iteration < iterations / 2) return {exact};
    if (vn < 0 && exact <= vn && iteration < iterations / 4) return {0.5 * vn};
    if (exact > std::max(vn, centres) && exact < 0 && iteration < 3 * iterations / 4) return {exact, true};
    const double pushes = std::exp2(std::clamp((iteration - iterations) / kMostTries, 0, kMostDoublings));
    return {std::max(0.0, vn + kPushSeparations * pushes * lengths.separation / dt)};
}

bool turns_stay(const Impulsive& a, const Impulsive& b, double dt) {
    const auto stays = [&](const Impulsive& body) {
        return !(body.inverse_mass > 0) || turns_far(body.angular_velocity, dt);
    };
    return stays(a) && stays(b);
}

Resolution resolve_inelastic(const StepView& view, Movers& movers, PairTable& pairs, Worker& worker,
                             const CandidatePair& clusters, int iterations) {
    Resolution out;
    for (int i = 0;; ++i) {
        const ClusterHit hit = query_clusters(view, pairs, worker, clusters.a, clusters.b);
        if (!hit.hit.hit) {
            out.resolved = true;
            return out;
        }
        if (!out.found) out.first_a = hit.a, out.first_b = hit.b, out.toi = hit.hit.toi;
        out.found = true;
        if (i == iterations) return out;
        const std::int32_t a = view.clusters.of(at(hit.a)), b = view.clusters.of(at(hit.b));
        const Impulsive body_a = view.clusters.impulsive(a), body_b = view.clusters.impulsive(b);
        if (hit.hit.by_turn && turns_stay(body_a, body_b, view.dt)) return out;
        SweptContact contact = swept_contact(view, hit);
        const PairLengths lengths = pair_lengths(view.model, view.state, hit.a, hit.b);
        const double centres = dot(contact.point.normal, body_b.velocity - body_a.velocity);
        const HitAnswer answer = answer_to(view.dt, contact, centres, lengths, i, std::min(iterations, kMostTries));
        if (answer.on_centres)
            contact.point.arm_a = contact.point.arm_b = {};
        else if (answer.target < 0)
            meet_alike(view, worker, hit, lengths.rest, contact.point);
        const auto impulse = displacing_impulse(body_a, body_b, view.dt, answer.target, contact.point);
        if (!impulse) return out;
        push(movers, worker, a, b, contact.point, *impulse);
    }
}

FrozenList freeze_clusters(const StepView& view, PairBook& book, Team& team, ClusterPairs& out) {
    std::vector<CandidatePair>& clusters = out.pairs;
    const FrozenList frozen = freeze(view, book, team, ListReach::separation);
    constexpr std::size_t kGrain = 1024; // pairs of a task
    const auto clusters_of = [&](std::size_t i) {
        const CandidatePair& p = frozen.pairs[i].pair;
        const std::int32_t a = view.clusters.of(at(p.a)), b = view.clusters.of(at(p.b));
        return CandidatePair{std::min(a, b), std::max(a, b)};
    };
    clusters.resize(frozen.pairs.size());
    std::atomic<bool> merged = false;
    for_each(&team, "pairs of clusters", clusters.size(), kGrain, [&](std::size_t i) {
        clusters[i] = clusters_of(i);
        if (i > 0 && !(clusters_of(i - 1) < clusters[i])) merged.store(true, std::memory_order_relaxed);
    });
    if (!merged) return frozen; // clusters are bodies, and their pairs sorted
    team_sort(team, clusters, out.buffer, std::less<>{});
    out.buffer.swap(clusters);
    const auto first = [&](std::size_t i) { return i == 0 || !(out.buffer[i] == out.buffer[i - 1]); };
    compact_if({&team, "pairs of clusters", kGrain, book.lists.chunk_places}, out.buffer.size(), first, clusters, 0,
               [&](std::size_t i) { return out.buffer[i]; });
    return frozen;
}

} // namespace flotilla
