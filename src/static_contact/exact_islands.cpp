// SPDX-License-Identifier: MIT
#include "static_contact/exact_islands.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "static_contact/island_energy.hpp"

namespace flotilla {
namespace {

using Island = ContactScratch::Island;
using Exact = ContactScratch::ExactSolve;

/// Contacts up to which an island at rest is worth a tenth of a second, since the next step begins with what this one
/// found: walls and houses of cards.
constexpr std::int32_t kMostContacts = 1536;
/// Bodies of an island with more than few contacts: factorisations grow with their cube, but in slender ones. Of more
/// than kManyBodies those that may be over-constrained would take forty that end nowhere, in every step. Most others
/// (may_be_over_constrained()) take them in some ten steps, and then rest: 80 stones in a cone never slept.
constexpr std::int32_t kMostBodies = 128, kManyBodies = 64;
/// Of a slender island, parked or not: of what is parked an exact solve takes in what its result leaves approaching,
/// and factors of what touches all round fill up. A row of dominoes has two.
constexpr std::int32_t kMostPairsOfBody = 2;
/// Factorisations for a residual below an island's tolerance.
constexpr int kMostToTolerance = 80;
/// Where Newton's steps are all that follows the sweeps, each has to get so many times nearer: piles, whose impulses
/// are not determined, cost one factorisation.
constexpr double kPolish = 10;

/// Many bodies that sweeps leave unsolved move among each other where they do so, in the mean, faster than this share
/// of the rest speed and by more than a rest distance a step. Their problems are far from what the impulses of the step
/// before say, the other methods take some forty factorisations for them, and the next step poses others: Newton's
/// steps are all that follows the sweeps. What moves less settles, and the next step begins with what this one found:
/// with no least speed but that of the rest distance a household, nearly at rest, was left above its tolerance in
/// twice as many steps. Of more than kManyBodies only what is nearly at rest is worth what they cost, and what moves is
/// left to its sweeps: with a least speed 80 stones that settle take twice the time, and fall asleep no sooner.
constexpr double kMoves = 1.0 / 8;

/// Impulses change the momentum of an island by the rounding of their sum, and what its bodies need is of the order of
/// its mass times its contacts' largest free velocity; wedges multiply that by the inverse of their angle. Contacts all
/// round a body whose targets contradict each other have no solution, and Newton's steps answer with impulses that
/// balance each other, as large as its compliance allows. Beyond this multiple a solution is refused: its rounding
/// would be 2^-31 of the momentum.
constexpr double kMostImpulse = 0x1p22;

std::span<const ContactBlock> blocks_of(const Island& island, const ContactScratch& s) {
    return std::span(s.blocks).subspan(at(island.first), at(island.end - island.first));
}

void gather(const Island& island, const ContactBodies& bodies, std::span<const double> presses, ContactScratch& s,
            Exact& e) {
    e.bodies.clear();
    e.contacts.clear();
    e.impulses.clear();
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) {
        const std::int32_t body = s.island_bodies[at(k)];
        const std::size_t id = at(s.bodies[at(body)]);
        s.exact_body[at(body)] = static_cast<std::int32_t>(e.bodies.size());
        e.bodies.push_back({bodies.inv_mass[id], bodies.inv_inertia[id], bodies.locked_of(id)});
    }
    const auto number = [&](std::int32_t body) { return s.movable[at(body)] ? s.exact_body[at(body)] : -1; };
    const auto pressed = [&](std::int32_t row) { return !presses.empty() && presses[at(s.source[at(row)])] >= 0; };
    for (const ContactBlock& block : blocks_of(island, s))
        for (std::int32_t r = block.first; r < block.end; ++r) {
            const ContactRow& row = s.rows[at(r)];
            Vec3 free =
                to_contact(row, relative_velocity(row, s.start_velocity[at(block.a)], s.start_velocity[at(block.b)]));
            free -= row.local.target;
            const double friction = std::max(row.local.friction, 0.0), bound = std::max(-row.local.friction, 0.0);
            e.contacts.push_back({number(block.a), number(block.b), row.normal, row.tangent_1, row.tangent_2, row.arm_a,
                                  row.arm_b, friction, free, pressed(r), bound});
            e.impulses.push_back(row.local.impulse);
        }
}

void scatter(const Island& island, const ContactBodies& bodies, ContactScratch& s, const Exact& e) {
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) {
        const std::size_t body = at(s.island_bodies[at(k)]);
        s.velocity[body] = s.start_velocity[body];
    }
    std::size_t c = 0;
    for (const ContactBlock& block : blocks_of(island, s))
        for (std::int32_t r = block.first; r < block.end; ++r, ++c) {
            ContactRow& row = s.rows[at(r)];
            row.local.impulse = e.impulses[c];
            const Vec3 impulse = to_world(row, e.impulses[c]);
            const auto push = [&](std::int32_t body, const Vec3& arm, const Vec3& l) {
                if (!s.movable[at(body)]) return;
                const std::size_t id = at(s.bodies[at(body)]);
                BodyVelocity& v = s.velocity[at(body)];
                v.linear += free_part(bodies.locked_of(id), bodies.inv_mass[id] * l);
                v.angular += bodies.inv_inertia[id] * cross(arm, l);
            };
            push(block.a, row.arm_a, -impulse);
            push(block.b, row.arm_b, impulse);
        }
}

// 1/2 r W r + r (u - target), J, which a solution has below zero, and which is zero without impulses. What it is above
// is energy from nowhere. `yielded`: with targets less by the approach that is left.
double objective(const Island& island, const ContactScratch& s, const Exact& e, bool yielded) {
    double sum = 0;
    std::size_t c = 0;
    for (const ContactBlock& block : blocks_of(island, s))
        for (std::int32_t r = block.first; r < block.end; ++r, ++c) {
            const ContactRow& row = s.rows[at(r)];
            Vec3 u = to_contact(row, relative_velocity(row, s.velocity[at(block.a)], s.velocity[at(block.b)]));
            u -= row.local.target;
            sum += 0.5 * dot(row.local.impulse, u + e.contacts[c].free_velocity);
            if (yielded) sum += row.local.impulse.x * std::max(0.0, -u.x);
        }
    return sum;
}

/// J: what a solve that is nearly one of contacts that yield may gain by what it leaves.
double gain_left(const ConeSolveStats& stats, const Exact& e) {
    if (!stats.yielded) return 0;
    double sum = 0;
    for (const Vec3& impulse : e.impulses) sum += length(impulse);
    return stats.yielding_left * sum;
}

/// Whether the impulses are more than an island may need, by kMostImpulse.
bool balance_each_other(const Exact& e) {
    double mass = 0, speed = 0, sum = 0;
    for (const ConeBody& body : e.bodies) mass += 1 / body.inv_mass;
    for (const ConeContact& c : e.contacts) speed = std::max(speed, length(c.free_velocity));
    for (const Vec3& impulse : e.impulses) sum += length(impulse);
    return sum > kMostImpulse * (mass * speed);
}

/// Whether it rests, also where nothing has weight: at less than so many tolerances, as bodies fall asleep.
bool rests_pressed(const Island& island) {
    constexpr double kTolerances = 16;
    return island.rests || island.speed <= kTolerances * island.tolerance;
}

bool is_pressed(const Exact& e) {
    return std::ranges::any_of(e.contacts, [](const ConeContact& c) { return c.pressed; });
}

/// Whether nothing but Newton's steps follows the sweeps.
bool newton_is_enough(const Island& island, const ContactSolveOptions& options) {
    const bool many = island.end_body - island.first_body > options.tuning.bodies_factorised_soon;
    return many && island.moves;
}

void solve(Island& island, const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& s,
           Exact& e) {
    const bool few = island.end_body - island.first_body <= options.tuning.bodies_factorised_soon;
    gather(island, bodies, few ? options.presses : std::span<const double>(), s, e);
    e.swept = e.impulses;
    const bool stands = is_pressed(e) && rests_pressed(island);
    const int most = is_costly(island) ? kMostFactorisations : kMostToTolerance;
    // What raises bodies is a matter of places, and what it leaves is asked again. The path of the interior point knows
    // no bounds, and of many contacts the other methods take as long as it.
    const bool newton = island.bounded && contacts_of(island, s) > kFewContacts;
    const ConeSolveStats stats =
        e.program.solve(e.bodies, e.contacts,
                        {.tolerance = island.exact_tolerance,
                         .max_iterations = most,
                         .enough = island.tolerance,
                         .most_beyond = is_slender(island) ? kMostToTolerance : kMostFactorisations,
                         .polish = newton_is_enough(island, options) ? kPolish : 0,
                         .newton = newton,
                         .rests = island.rests || stands},
                        e.impulses, e.scratch);
    island.solved = island.residual <= island.tolerance;
    island.stands = stands;
    if (!stats.solved && !stats.yielded && !(stats.residual < island.residual)) return;
    if (balance_each_other(e)) return;
    scatter(island, bodies, s, e);
    if (!stats.solved && objective(island, s, e, stats.yielded) > gain_left(stats, e)) {
        e.impulses = e.swept;
        return scatter(island, bodies, s, e);
    }
    island.stands = island.stands && !stats.solved && !stats.yielded;
    island.yields = stats.yielded && is_pressed(e);
    island.residual = stats.residual;
    island.solved = stats.solved || stats.residual <= island.tolerance;
    island.factorisations = stats.iterations;
}

/// A row of dominoes, a column or a chain, also where all of it stands on the ground: sweeps take long there, and a
/// factorisation does not.
bool is_chain(const Island& island, const ContactScratch& s) {
    const std::span<const ContactBlock> blocks = blocks_of(island, s);
    const auto among_movable = std::ranges::count_if(
        blocks, [&](const ContactBlock& b) { return s.movable[at(b.a)] != 0 && s.movable[at(b.b)] != 0; });
    return among_movable <= island.end_body - island.first_body;
}

} // namespace

std::int32_t contacts_of(const Island& island, const ContactScratch& s) {
    const std::span<const ContactBlock> blocks = blocks_of(island, s);
    return blocks.back().end - blocks.front().first;
}

std::int32_t contacts_in_need(const Island& island, const ContactScratch& s) {
    constexpr auto kOfPair = static_cast<std::int32_t>(3 * kContactsAtOnce);
    std::int32_t sum = 0;
    for (const ContactBlock& block : blocks_of(island, s)) sum += std::min(block.end - block.first, kOfPair);
    return sum;
}

bool may_solve_exactly(const Island& island, const ContactSolveOptions& options, const ContactScratch& s) {
    if (!options.exact || options.tangents == Tangents::random) return false;
    const std::int32_t contacts = contacts_of(island, s), bodies = island.end_body - island.first_body;
    const bool soon = bodies <= options.tuning.bodies_factorised_soon || (island.rests && is_slender(island));
    if (options.exact_few && !soon) return false;
    if (contacts <= kFewContacts || bodies <= options.tuning.bodies_factorised_soon) return true;
    const bool cheap =
        is_slender(island) || bodies <= kManyBodies || (bodies <= kMostBodies && !may_be_over_constrained(island));
    return island.rests && cheap && contacts_in_need(island, s) <= kMostContacts;
}

bool may_be_over_constrained(const Island& island) {
    constexpr std::int32_t kDegreesOfFreedom = 6;
    return island.active_contacts > kDegreesOfFreedom * (island.end_body - island.first_body);
}

bool moves_inside(const Island& island, const ContactBodies& bodies, const ContactSolveOptions& options,
                  const ContactScratch& s) {
    const bool many = island.end_body - island.first_body > options.tuning.bodies_factorised_soon;
    if (!many || options.patience == 0 || is_chain(island, s) || !may_solve_exactly(island, options, s)) return false;
    const double of_rest =
        island.tolerance / options.tuning.of_rest; // a rest distance a step, at the default tolerance
    const double least = is_costly(island) ? 0 : kMoves * options.rest_speed;
    return inner_speed(island, bodies, s) > std::max(least, of_rest);
}

bool is_costly(const Island& island) {
    return island.end_body - island.first_body > kManyBodies && !is_slender(island);
}

bool is_slender(const Island& island) {
    const std::int32_t bodies = island.end_body - island.first_body, pairs = island.end - island.first;
    return island.active_pairs <= bodies + 1 && pairs <= kMostPairsOfBody * bodies;
}

void solve_exactly(const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& s) {
    s.small_islands.clear();
    for (std::size_t k = 0; k < s.islands.size(); ++k)
        if (!s.islands[k].solved && may_solve_exactly(s.islands[k], options, s) &&
            !(s.islands[k].moves && is_costly(s.islands[k])))
            s.small_islands.push_back(static_cast<std::int32_t>(k));
    if (s.small_islands.empty()) return;
    s.exact_body.resize(s.bodies.size());
    s.exact.resize(at(options.team != nullptr ? options.team->size() : 1));
    const auto one = [&](std::size_t i, int thread) {
        Island& island = s.islands[at(s.small_islands[i])];
        solve(island, bodies, options, s, s.exact[at(thread)]);
    };
    if (options.team == nullptr)
        for (std::size_t i = 0; i < s.small_islands.size(); ++i) one(i, 0);
    else
        options.team->for_each("exact islands", s.small_islands.size(), 1, one);
}

} // namespace flotilla
