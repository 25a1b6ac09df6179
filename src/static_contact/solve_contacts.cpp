// SPDX-License-Identifier: MIT
#include "static_contact/solve_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "base/assert.hpp"
#include "static_contact/assemble.hpp"
#include "static_contact/divided_sweeps.hpp"
#include "static_contact/exact_islands.hpp"
#include "static_contact/island_energy.hpp"
#include "static_contact/shock.hpp"
#include "static_contact/sweep_island.hpp"

namespace flotilla {
namespace {

using Island = ContactScratch::Island;

std::span<const ContactBlock> blocks_of(const Island& island, const ContactScratch& s) {
    return std::span(s.blocks).subspan(static_cast<std::size_t>(island.first),
                                       static_cast<std::size_t>(island.end - island.first));
}

// Calls work(field_of_row) for the packed rows of the island.
template <class Work>
void for_rows(const Island& island, ContactScratch& s, Work&& work) {
    const auto each = [&](std::int32_t first, std::int32_t end) {
        for (std::size_t r = static_cast<std::size_t>(first); r < static_cast<std::size_t>(end); ++r)
            work(s.packed.frictionless ? s.packed.normal_rows[r].field : s.packed.rows[r].field);
    };
    for (std::int32_t p = island.first_packet; p < island.end_packet; ++p) {
        const ContactPacket& packet = s.packed.packets[static_cast<std::size_t>(p)];
        each(packet.first, packet.end);
        each(packet.first_parked, packet.end_parked);
    }
}

// Puts the island back to velocities before the solve and no impulses.
void forget_warm_start(const Island& island, const ContactBodies& bodies, ContactScratch& s) {
    for_rows(island, s, [&](Lanes* field) {
        for (const int f : {PacketRow::kNormalImpulse, PacketRow::kNormalPrevious})
            std::fill_n(field[f], kPacketLanes, 0.0);
        if (s.packed.frictionless) return;
        for (const int f : {PacketRow::kTangentImpulse, PacketRow::kTangentPrevious})
            for (int c = 0; c < 2; ++c) std::fill_n(field[f + c], kPacketLanes, 0.0);
    });
    for (const ContactBlock& block : blocks_of(island, s))
        for (const std::int32_t body : {block.a, block.b}) {
            if (!s.movable[static_cast<std::size_t>(body)]) continue; // never written, and other islands read it now
            const auto id = static_cast<std::size_t>(s.bodies[static_cast<std::size_t>(body)]);
            BodyVelocity& v = s.velocity[static_cast<std::size_t>(body)];
            v.linear = bodies.velocity[id] + Vec3{}; // + 0: no component of a BodyVelocity is -0
            v.angular = bodies.angular_velocity[id] + Vec3{};
        }
}

// m/s, at which the island's mass has its energy before the solve.
double mean_speed(const Island& island, const ContactScratch& s) {
    double mass = 0;
    for (std::int32_t k = island.first_body; k < island.end_body; ++k)
        mass += s.weight[static_cast<std::size_t>(s.island_bodies[static_cast<std::size_t>(k)])].linear;
    return std::sqrt(2 * island.energy_before / mass);
}

// Sweeps that cost as much as an exact solve that takes all its factorisations.
int sweeps_of_exact(const Island& island, const ContactTuning& tuning, const ContactScratch& s) {
    const double bodies = island.end_body - island.first_body, coupled = is_slender(island) ? 2 : bodies;
    const double factorisation = kOfFactorisation * bodies * coupled * coupled;
    const double sweep = tuning.operations_of_contact * contacts_of(island, s);
    return static_cast<int>(std::min(kMostFactorisations * factorisation / sweep, 1e9));
}

// m/s, the largest rest speed of the island's bodies.
double rest_speed_of(const Island& island, const ContactBodies& bodies, double of_gravity, const ContactScratch& s) {
    double speed = of_gravity;
    for (std::int32_t k = island.first_body; k < island.end_body && !bodies.rest_speed.empty(); ++k)
        speed = std::max(speed, bodies.rest_speed[static_cast<std::size_t>(
                                    s.bodies[static_cast<std::size_t>(s.island_bodies[static_cast<std::size_t>(k)])])]);
    return speed;
}

// m/s, the rounding of what the island begins with (ContactTuning::of_load).
double least_tolerance(const Island& island, double of_load, const ContactScratch& s) {
    double most = 0;
    for (const ContactBlock& block : blocks_of(island, s))
        for (std::int32_t r = block.first; r < block.end; ++r) {
            const LocalContact& c = s.rows[static_cast<std::size_t>(r)].local;
            most = std::max(most, c.impulse.x * c.mass_diagonal.x);
        }
    return of_load * most;
}

bool has_bounds(const Island& island, std::span<const double> bounds, const ContactScratch& s) {
    if (bounds.empty()) return false;
    const auto given = [&](std::int32_t source) { return bounds[static_cast<std::size_t>(source)] >= 0; };
    const std::span<const ContactBlock> blocks = blocks_of(island, s);
    const auto first = static_cast<std::size_t>(blocks.front().first),
               end = static_cast<std::size_t>(blocks.back().end);
    return std::ranges::any_of(std::span(s.source).subspan(first, end - first), given);
}

// How long an island that may be solved exactly is swept, and to which tolerance.
void leave_to_exact(Island& island, ContactSolveOptions& options, const ContactScratch& s) {
    const ContactTuning& tuning = options.tuning;
    const std::int32_t bodies = island.end_body - island.first_body;
    const bool few = contacts_in_need(island, s) <= kFewContacts;
    // One of many bodies that moves is left to the sweeps for as long as they get on: a factorisation costs a thousand
    // of them.
    const bool soon = island.rests || bodies <= tuning.bodies_factorised_soon;
    // What moves does not creep, and meets other contacts in the next step: what sweeps leave within the tolerance is
    // enough, and so is what an exact solve does. A lone body may rest all the same but for its spin: a top, a wheel.
    const bool to_the_last = (island.rests || bodies == 1 || options.patience == 0) && !island.bounded;
    island.exact_tolerance = (to_the_last ? kExactShare : tuning.aim_in_motion) * island.tolerance;
    if (soon && (few || is_slender(island)))
        island.exact_tolerance = std::max(island.exact_tolerance, kOfSpeed * island.speed);
    if (to_the_last && soon && (few || is_slender(island))) options.tolerance = island.exact_tolerance;
    // A packet without others would be visited over and over in every sweep: a shaft in a bearing of 180 sides, which
    // touch at 720 points, takes 2.3 times as long. What is left is for the exact solve, which needs few of them.
    if (island.end_packet - island.first_packet == 1 && contacts_of(island, s) > kFewContacts)
        options.tuning.most_visits = 1;
    // Newton's steps alone end early where they lead nowhere: what the sweeps reached is the result then.
    if (options.exact_few && bodies > tuning.bodies_factorised_soon) return;
    const int before = few ? (to_the_last ? tuning.sweeps_before_exact : tuning.sweeps_of_few_in_motion)
                       : is_slender(island) ? tuning.sweeps_of_slender
                                            : tuning.sweeps_of_many;
    options.iterations =
        std::min(options.iterations, soon ? before : std::max(before, sweeps_of_exact(island, tuning, s)));
}

// m/s, residuals.
struct Aims {
    double aim;    // at which sweeps end
    double enough; // at which what they leave is solved
};

// How far an island is swept, by options of its own; `rests` is set.
Aims take_aim(Island& island, ContactSolveOptions& options, const ContactScratch& s) {
    const ContactTuning& tuning = options.tuning;
    // A caller that asked for a tolerance has all sweeps for it, and wants no more.
    const bool aims_lower = island.rests && options.patience > 0;
    const bool small = may_solve_exactly(island, options, s) && !is_costly(island);
    const double aim = (!aims_lower ? 1 : small ? kExactShare : tuning.aim_at_rest) * island.tolerance;
    options.tolerance = aim;
    island.exact_tolerance = aim; // of a costly one
    if (small)
        leave_to_exact(island, options, s);
    else if (aims_lower && tuning.patient_at_rest)
        options.patience = std::max(options.patience, options.iterations);
    // What sweeps leave within the tolerance is solved, but where an exact solve would leave next to nothing, which
    // then stays: at rest.
    return {aim, aims_lower && small ? aim : island.tolerance};
}

// A warm start adds energy where impulses of the past are too large, and so may momentum; sweeps that end unfinished do
// not take all of it back. Sweeps go down 1/2 l W l + l (u - target), which is zero without impulses: where what is
// prescribed rests, an island has gained no more energy than the work of its targets. One that came out with more is
// solved again from zero.
void solve_island(Island& island, const ContactBodies& bodies, const ContactSolveOptions& of_all, ContactScratch& s,
                  int thread = 0) {
    ContactSolveOptions options = of_all;
    island.asked = island.tolerance;
    island.bounded = has_bounds(island, options.bounds, s);
    if (options.patience == 0 && options.warm_start)
        island.tolerance = std::max(island.tolerance, least_tolerance(island, options.tuning.of_load, s));
    options.rest_speed = rest_speed_of(island, bodies, options.rest_speed, s);
    island.energy_before = kinetic_energy(island, bodies, options.team, s);
    island.speed = mean_speed(island, s);
    island.rests = options.rest_speed > 0 && island.speed <= options.rest_speed;
    const ContactSolveOptions of_island = options;
    Aims aims = take_aim(island, options, s);
    const auto sweep_and_measure = [&](const SweepStart& start) {
        sweep_island(island, options, start, s);
        island.solved = island.solved || (options.tolerance == aims.aim && island.residual <= aims.enough);
        if (island.solved) return false;
        island.energy_pgs = kinetic_energy(island, bodies, options.team, s);
        return island.energy_pgs - island.energy_before >
               work_of_targets(island, options.team, s) +
                   options.tuning.energy_rounding * (island.energy_pgs + island.energy_before);
    };
    bool gained = sweep_and_measure({options.warm_start, options.momentum, thread});
    island.moves = !island.solved && moves_inside(island, bodies, options, s);
    if (island.moves && island.rests && !is_costly(island)) { // what gravity added was not all
        island.rests = false;
        options = of_island;
        aims = take_aim(island, options, s);
        gained = sweep_and_measure({false, options.momentum, thread});
    }
    if (!gained || !options.warm_start || !prescribed_at_rest(island, s)) return;
    island.cold = true;
    forget_warm_start(island, bodies, s);
    sweep_and_measure({false, options.momentum, thread});
}

// Small islands, each by the rank that owns its first body.
void solve_small_divided(const ContactBodies& bodies, const ContactSolveOptions& of_all, ContactScratch& s) {
    Division& division = *of_all.team->division();
    ContactSolveOptions options = of_all;
    options.team = nullptr;
    ByteWriter own;
    for (const std::int32_t k : s.small_islands) {
        Island& island = s.islands[static_cast<std::size_t>(k)];
        const std::int32_t first = s.island_bodies[static_cast<std::size_t>(island.first_body)];
        const std::int32_t payer = s.bodies[static_cast<std::size_t>(first)];
        if (division.owner(payer) != division.rank()) continue;
        {
            const CostOf cost(division, payer);
            solve_island(island, bodies, options, s);
        }
        own.add(k);
        write_solved(own, island, s);
    }
    const GatheredBytes told = gather_bytes(division.ranks(), own.take());
    division.log_loop(told.all.size());
    for (int rank = 0; rank < division.size(); ++rank) {
        if (rank == division.rank()) continue;
        for (auto in = reader_of(told.of(rank)); !in.rest().empty();) {
            std::int32_t k = 0;
            in.read(k);
            read_solved(in, s.islands[static_cast<std::size_t>(k)], s);
        }
    }
}

// Among ranks, whose sweeps of an island together wait for one another far longer than those of threads, an island is
// large that has more than a quarter of all contacts: of several like it some ranks can each have one.
bool is_large_among_ranks(const Island& island, const ContactScratch& s) {
    constexpr std::size_t kShare = 4;
    return is_large(island, s) && kShare * static_cast<std::size_t>(contacts_of(island, s)) > s.rows.size();
}

// Large islands one after another, each on all threads; small ones side by side. No island writes what another one
// reads.
void solve_islands(const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& s) {
    s.small_islands.clear();
    s.parts.resize(static_cast<std::size_t>(options.team != nullptr ? options.team->size() : 1));
    const bool divided = options.team != nullptr && options.team->division() != nullptr;
    for (std::size_t k = 0; k < s.islands.size(); ++k) {
        const Island& island = s.islands[k];
        if (options.team == nullptr || (divided ? is_large_among_ranks(island, s) : is_large(island, s)))
            solve_island(s.islands[k], bodies, options, s);
        else
            s.small_islands.push_back(static_cast<std::int32_t>(k));
    }
    if (s.small_islands.empty()) return;
    if (options.team->division() != nullptr) return solve_small_divided(bodies, options, s);
    ContactSolveOptions alone = options;
    alone.team = nullptr;
    options.team->for_each("small islands", s.small_islands.size(), 1, [&](std::size_t i, int thread) {
        solve_island(s.islands[static_cast<std::size_t>(s.small_islands[i])], bodies, alone, s, thread);
    });
}

void unpack_impulses(ContactScratch& s, Team* team) {
    constexpr std::size_t kGrain = 256;
    for_each(team, "unpack impulses", s.packed.num_rows(), kGrain,
             [&](std::size_t row) { unpack_impulses(s.packed, row, s.rows); });
}

// The impulses of PGS, in world coordinates and input order.
void store_impulses(const ContactScratch& s, Team* team, std::span<Vec3> impulses) {
    constexpr std::size_t kGrain = 512;
    std::fill(impulses.begin(), impulses.end(), Vec3{});
    for_each(team, "store impulses", s.rows.size(), kGrain, [&](std::size_t k) {
        impulses[static_cast<std::size_t>(s.source[k])] = to_world(s.rows[k], s.rows[k].local.impulse);
    });
}

// What a script presses on, and no method could solve, stays where it is for as long as it rests: what the methods left
// of its friction is by chance. The impulses stay for the next solve to begin with.
void let_stand(ContactScratch& s) {
    for (const Island& island : s.islands)
        for (std::int32_t k = island.first_body; island.stands && !island.solved && k < island.end_body; ++k)
            s.velocity[static_cast<std::size_t>(s.island_bodies[static_cast<std::size_t>(k)])] = {};
}

void store_velocities(const ContactScratch& s, const ContactBodies& bodies) {
    for (std::size_t k = 0; k < s.bodies.size(); ++k) {
        if (!s.movable[k]) continue;
        const auto id = static_cast<std::size_t>(s.bodies[k]);
        bodies.velocity[id] = s.velocity[k].linear;
        bodies.angular_velocity[id] = s.velocity[k].angular;
    }
}

void mark_unsolved(ContactScratch& s) {
    for (const Island& island : s.islands)
        if (!island.solved)
            for (std::int32_t k = island.first_body; k < island.end_body; ++k)
                s.unsolved[static_cast<std::size_t>(
                    s.bodies[static_cast<std::size_t>(s.island_bodies[static_cast<std::size_t>(k)])])] = 1;
}

void propagate_shocks(const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& s) {
    const auto unfinished = [&](const Island& i) {
        if (i.solved || !(i.residual > options.shock_above * i.tolerance)) return false;
        if (options.shock_in_motion) return true;
        // A pass keeps the friction of the sweeps however hard it presses: a wedge that its friction locks slid out
        // from under a scripted lid as if it had none. What is left unsolved stops the script (failsafe).
        if (!prescribed_at_rest(i, s)) return false;
        return i.rests || i.residual > rest_speed_of(i, bodies, options.rest_speed, s);
    };
    if (!options.shock || std::none_of(s.islands.begin(), s.islands.end(), unfinished)) return;
    s.level.resize(s.bodies.size());
    contact_levels(s.pairs, s.movable, s.graph, s.level);
    s.before_shock = s.velocity;
    for (Island& island : s.islands) {
        if (!unfinished(island)) continue;
        ContactSolveOptions own = options;
        own.tolerance = island.tolerance;
        island.shocked = propagate_shock(island, bodies, own, s);
        if (!island.shocked) continue;
        for (const ContactBlock& block : blocks_of(island, s))
            for (const std::int32_t body : {block.a, block.b}) {
                const auto k = static_cast<std::size_t>(body);
                if (s.movable[k]) s.shocked[static_cast<std::size_t>(s.bodies[k])] = 1;
            }
    }
}

ContactSolveStats summarize(const ContactScratch& s) {
    ContactSolveStats stats{.islands = s.num_islands, .colors = s.num_colors};
    for (const Island& island : s.islands) {
        stats.iterations = std::max(stats.iterations, island.iterations);
        stats.visits += island.visits;
        if (!island.bounded && !island.yields) {
            stats.residual = std::max(stats.residual, island.residual);
            stats.unsolved_islands += island.solved ? 0 : 1;
        }
        stats.part_rounds += island.part_rounds;
        stats.shocked_islands += island.shocked ? 1 : 0;
        stats.exact_islands += island.factorisations > 0 ? 1 : 0;
        stats.cold_islands += island.cold ? 1 : 0;
    }
    return stats;
}

} // namespace

ContactSolveStats solve_contacts(std::span<const Contact> contacts, const ContactBodies& bodies,
                                 const ContactSolveOptions& options, std::span<Vec3> impulses,
                                 ContactScratch& scratch) {
    FLOTILLA_ASSERT(impulses.size() == contacts.size());
    scratch.shocked.assign(bodies.velocity.size(), 0);
    scratch.unsolved.assign(bodies.velocity.size(), 0);
    assemble(contacts, bodies, options, impulses, scratch);
    list_island_bodies(bodies, scratch);
    solve_islands(bodies, options, scratch);
    unpack_impulses(scratch, options.team);
    solve_exactly(bodies, options, scratch);
    for (const Island& island : scratch.islands)
        if (!island.solved) take_back_gain(island, options.team, scratch);
    store_impulses(scratch, options.team, impulses);
    propagate_shocks(bodies, options, scratch);
    let_stand(scratch);
    store_velocities(scratch, bodies);
    mark_unsolved(scratch);
    return summarize(scratch);
}

} // namespace flotilla
