// SPDX-License-Identifier: MIT
#include "collision/late_hits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/index.hpp"
#include "pair/impulses.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

/// How much of a blow may act along the normal of a contact that does not answer to it. Were it all that draws the body
/// away from the contact, two balls side by side, which a third one meets at once, would leave at 0.81 m/s and more in
/// place of 1.04.
constexpr double kAside = 1.0 / 16;

/// m/s^2, what loads do to a body along the normal.
double load(const StepView& view, std::int32_t body, const Vec3& normal) {
    return view.model.bodies[at(body)].movable() ? dot(normal, acceleration(view.model, at(body))) : 0.0;
}

/// m/s, what loads add to the approach of either body along the normal in half a step.
double pull(const StepView& view, const CandidatePair& pair, const Vec3& normal) {
    return 0.5 * view.dt * std::max({0.0, load(view, pair.a, normal), -load(view, pair.b, normal)});
}

/// Whether both bodies can move, and loads change the speed of neither along the normal by more than next to nothing of
/// the approach in the step.
bool weightless(const StepView& view, const CandidatePair& pair, const Landing& landing) {
    constexpr double kNothing = 1.0 / 1024; // twice that of the energy
    const auto free = [&](std::int32_t body) {
        return view.model.bodies[at(body)].movable() &&
               view.dt * std::abs(load(view, body, landing.normal)) <= kNothing * landing.approach;
    };
    return free(pair.a) && free(pair.b);
}

/// J.
double kinetic_energy(const Cluster& c, const Vec3& velocity, const Vec3& momentum) {
    return 0.5 * (length_sq(velocity) / c.inverse_mass + dot(momentum, c.inertia.inverse * momentum));
}

/// Whether a body turns by more than half a turn on its way. Its points go elsewhere than its velocity says then, and
/// what is taken back for one hit may ask for more at the next: that grew to 1e125 m/s.
bool turns_far(const StepView& view, std::int32_t body) {
    return length_sq(view.trajectories.turn(at(body))) > std::numbers::pi * std::numbers::pi;
}

/// Whether an impulse would make more late for a body than was, and than it has energy.
bool more_than_all(const Cluster& c, const Vec3& arm, const Vec3& impulse) {
    const Motion& late = c.late;
    const Vec3 velocity = late.velocity + free_part(c.locked.translation, c.inverse_mass * impulse);
    const double after = kinetic_energy(c, velocity, late.momentum + cross(arm, impulse));
    const double before = kinetic_energy(c, late.velocity, late.momentum);
    return after > std::max(before, kinetic_energy(c, c.velocity, c.momentum));
}

/// Whether the impulses, from the given one on, have one of the contact's pair. Goes on to the first of a later pair.
template <class Iterator>
bool carried(Iterator& impulse, Iterator end, const Contact& c) {
    const auto before = [&] { return std::pair(impulse->a, impulse->b) < std::pair(c.a, c.b); };
    const auto of_pair = [&] { return impulse->a == c.a && impulse->b == c.b; };
    while (impulse != end && before()) ++impulse;
    bool any = false;
    for (; impulse != end && of_pair(); ++impulse) any = any || impulse->impulse != Vec3{};
    return any;
}

} // namespace

void Touching::start(std::size_t bodies, const ContactsAtStart& known) {
    const std::span<const Contact> contacts = known.contacts;
    first_.assign(bodies + 1, 0);
    for (const Contact& c : contacts)
        for (const std::int32_t body : {c.a, c.b}) ++first_[at(body) + 1];
    for (std::size_t i = 0; i < bodies; ++i) first_[i + 1] += first_[i];
    next_.assign(first_.begin(), first_.end() - 1);
    touches_.resize(2 * contacts.size());
    auto impulse = known.impulses.begin();
    bool loaded = false;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& c = contacts[i];
        if (begins_pair(contacts, i)) loaded = carried(impulse, known.impulses.end(), c);
        touches_[next_[at(c.a)]++] = {c.b, loaded, -c.normal};
        touches_[next_[at(c.b)]++] = {c.a, loaded, c.normal};
    }
}

Touching::Late Touching::late_of(const Clusters& clusters, std::int32_t body, std::int32_t other,
                                 const Vec3& away) const {
    if (clusters[body].any_late()) return Late::alone;
    const bool from_late = clusters[other].infinite() || clusters[other].any_late();
    Late late = Late::alone;
    for (std::size_t i = first_[at(body)]; i < first_[at(body) + 1]; ++i) {
        const Touch& touch = touches_[i];
        if (touch.other == other) continue;
        const double along = dot(touch.away, away);
        if (!(std::abs(along) <= kAside || (from_late && !touch.loaded && along < 0))) return Late::no;
        late = Late::with_other;
    }
    return late;
}

std::pair<bool, bool> Touching::may_be_late(const Clusters& clusters, std::int32_t a, std::int32_t b,
                                            const Vec3& normal) const {
    const bool fixed_a = clusters[a].infinite(), fixed_b = clusters[b].infinite();
    const Late of_a = fixed_a ? Late::no : late_of(clusters, a, b, -normal);
    const Late of_b = fixed_b ? Late::no : late_of(clusters, b, a, normal);
    // Were one of two late alone, their centre of mass would go elsewhere than their momentum says; where they touch
    // others, nothing else sees to that: a row of cubes on a floor, hit at its end, went 25 mm too far.
    const auto late = [](Late own, Late others, bool other_fixed) {
        return own == Late::alone || (own == Late::with_other && (other_fixed || others != Late::no));
    };
    return {late(of_a, of_b, fixed_b), late(of_b, of_a, fixed_a)};
}

OfBoth late_shares(const StepView& view, const Touching& touching, const CandidatePair& pair, const Landing& landing,
                   const OfBoth& change) {
    const auto [a, b] = touching.may_be_late(view.clusters, pair.a, pair.b, landing.normal);
    const double of_late = (a ? change.a : 0.0) + (b ? change.b : 0.0);
    if (!(of_late > 0)) return {};
    // Where no loads work on the way, no height has to make up for that.
    const bool no_loads = weightless(view, pair, landing);
    if (no_loads && a && b) return {landing.time, landing.time};
    const double e = pair_restitution(view.model, pair.a, pair.b);
    const double rebound = e * std::min(landing.approach, landing.way);
    const double closes = landing.gap > landing.lengths.rest ? landing.gap / view.dt : 0.0;
    double after = rebound - (no_loads ? 1 + e : 1 - e * e) * closes;   // m/s, of the way
    if (landing.gap > landing.lengths.proximity - landing.lengths.rest) // else static contact knows the points
        after = std::max(after, pull(view, pair, landing.normal) - closes);
    const double share = std::clamp((change.a + change.b - landing.way - after) / of_late, 0.0, 1.0);
    return {a ? share : 0.0, b ? share : 0.0};
}

bool hasten(const StepView& view, Clusters& clusters, const CandidatePair& pair, const ContactPoint& hit,
            const Landing& landing) {
    const double wanted = landing.way - std::max(0.0, landing.gap) / view.dt;
    if (!(wanted > 0)) return false;
    const bool late_a = clusters[pair.a].any_late(), late_b = clusters[pair.b].any_late();
    const Impulsive a = late_a ? clusters.impulsive(pair.a) : Impulsive{};
    const Impulsive b = late_b ? clusters.impulsive(pair.b) : Impulsive{};
    const double mobility = normal_mobility(a, b, hit, collision_matrix(a, b, hit.arm_a, hit.arm_b));
    if (!(mobility > 0)) return false;
    const Vec3 impulse = (wanted / mobility) * hit.normal;
    const auto too_far = [&](std::int32_t body, const Vec3& arm, const Vec3& change) {
        return turns_far(view, body) && more_than_all(clusters[body], arm, change);
    };
    if ((late_a && too_far(pair.a, hit.arm_a, impulse)) || (late_b && too_far(pair.b, hit.arm_b, -impulse)))
        return false;
    if (late_a) clusters.delay(pair.a, hit.arm_a, impulse);
    if (late_b) clusters.delay(pair.b, hit.arm_b, -impulse);
    return true;
}

} // namespace flotilla
