// SPDX-License-Identifier: MIT
// What the steps of a contact solve share: its input, its options and its memory. Nothing here depends on any of them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <flotilla/settings.hpp>

#include "islands/coloring.hpp"
#include "islands/contact_graph.hpp"
#include "parallel/team.hpp"
#include "state/contact.hpp"
#include "static_contact/contact_packets.hpp"
#include "static_contact/contact_tuning.hpp"
#include "static_contact/growing_program.hpp"
#include "static_contact/interior_point.hpp"
#include "static_contact/sweep_shares.hpp"

namespace flotilla {

/// Arrays by body id, all of one length.
struct ContactBodies {
    std::span<const Vec3> position;    ///< m, centre of mass
    std::span<Vec3> velocity;          ///< m/s, in and out
    std::span<Vec3> angular_velocity;  ///< rad/s, world, in and out
    std::span<const double> inv_mass;  ///< 1/kg; 0: prescribed velocity, never written
    std::span<const Mat3> inv_inertia; ///< 1/(kg m^2), world, symmetric; read where inv_mass > 0
    std::span<const AxisMask> locked;  ///< axes along which bodies do not move; may be empty: none
    std::span<const double>
        rest_speed; ///< m/s: ContactSolveOptions::rest_speed of bodies with loads of their own; may be empty

    [[nodiscard]] AxisMask locked_of(std::size_t id) const { return locked.empty() ? AxisMask{0} : locked[id]; }
};

struct ContactSolveOptions {
    int iterations = 1000; ///< sweeps per island, >= 0 (figure 20)
    /// m/s, L-infinity violation at which an island stops (but see rest_speed); the least of this and of its contacts'
    /// tolerances.
    double tolerance = 1e-6;
    bool warm_start = true;  ///< start from the impulses handed in
    bool normal_rows = true; ///< one row a contact where none has friction (Savings)
    bool momentum = true;    ///< carry sweeps on (sweep_engine.hpp): several times fewer of them in a pile
    /// Sweeps after which an island is given up before the limit, because its residual did not fall by a fifth in them;
    /// 0: never. What is left then are impulses that bodies in contact at many points could exchange for ever, hardly
    /// moving. At rest an island with more active contacts than degrees of freedom, which may be over-constrained, is
    /// not given up while the number of violated pairs falls, but as soon as that and the residual stand for two
    /// evaluations. 0 switches all of this off.
    int patience = 0;
    /// m/s. An island is at rest if its kinetic energy on entry is at most 1/2 m v^2 at this speed: what it has is what
    /// gravity added. Then what is not solved yet is swept alone where it is a small part of an island; sweeps aim
    /// at less than the tolerance (ContactTuning::aim_at_rest), over-constrained islands are given up early, and a
    /// shock pass stands only where it solves its levels. In motion nothing of this holds. 0: no island is at rest.
    double rest_speed = 0;
    bool exact = false;     ///< small islands that PGS leaves unsolved are solved exactly (exact_islands.hpp)
    bool exact_few = false; ///< of them only those of few bodies, and columns at rest by Newton's steps alone
    bool shock = true;      ///< propagate a shock where an island is still unsolved
    /// Also where it does not rest and is left with less than its rest speed, and where a prescribed body moves.
    bool shock_in_motion = true;
    double shock_above = 1; ///< by more than so many tolerances
    /// Sweeps per level of the shock pass, which stops at the tolerance divided by the number of levels: what one level
    /// leaves is carried on by all above. Every contact belongs to one level, so the pass costs at most as much as this
    /// many sweeps of the whole island; a level of bodies on frozen ones converges in a few.
    int shock_iterations = 100;
    /// cone, aligned: friction bounded by a disc, so that it is mu lambda_n in every direction. random: the paper's
    /// pyramid with keyed tangents.
    Tangents tangents = Tangents::cone;
    /// N s, by contact: the bound of its friction in place of mu lambda_n; negative: none is given. May be empty. With
    /// Tangents::cone alone.
    std::span<const double> bounds;
    /// m/s, by contact: what is asked in addition where an exact solve is soon, because a script presses; negative:
    /// none does. May be empty: no script presses.
    std::span<const double> presses;
    std::uint64_t seed = 0, step = 0; ///< key of the random tangents; step: of contacts that slide
    Isa isa = best_isa();             ///< instruction set of the sweeps: the same bits with any
    Team* team = nullptr;             ///< null: the calling thread does all; the same bits with any
    ContactTuning tuning{};
};

/// Memory of the solver, owned by the caller and reused, so that a steady scene allocates nothing. Tests and reports
/// may read `shocked` and `unsolved` afterwards; the rest is between one call's functions.
struct ContactScratch {
    std::vector<std::uint8_t> shocked;  ///< per body id: its velocity comes from a shock pass
    std::vector<std::uint8_t> unsolved; ///< per body id: its island ended above its tolerance

    /// Where an island is in the arrays below.
    struct IslandPlace {
        std::int32_t first = 0, end = 0; ///< blocks
        std::int32_t first_packet = 0, end_packet = 0;
        std::int32_t first_group = 0, end_group = 0; ///< in groups
        std::int32_t first_body = 0, end_body = 0;   ///< in island_bodies
    };
    struct Island : IslandPlace {
        std::int32_t active_pairs = 0, active_contacts = 0; ///< pairs with contacts that are not parked, and those
        int iterations = 0;
        double residual = 0;        ///< m/s, of the final state
        double tolerance = 0;       ///< m/s
        double asked = 0;           ///< m/s, the least tolerance of its contacts, by which they are parked
        double exact_tolerance = 0; ///< m/s, asked of an exact solve
        double energy_before = 0, energy_pgs = 0; ///< J, kinetic; the latter of unsolved ones
        double speed = 0;                         ///< m/s, at which its mass has its energy before the solve
        std::int64_t visits = 0;
        int part_rounds = 0;
        int factorisations = 0; ///< of the exact solve
        bool rests = false;     ///< slow on entry (ContactSolveOptions::rest_speed); nothing to do with sleep
        bool solved = false;    ///< the tolerance holds, apart from rounding
        bool shocked = false;
        bool moves = false;   ///< bodies that sweeps left unsolved, and fast among each other
        bool cold = false;    ///< the warm start was taken back
        bool bounded = false; ///< bounds of friction are given for some of its contacts
        bool yields = false;  ///< what a script presses on has no solution but one that yields, and that was found
        bool stands = false;  ///< a script presses on it, and it is left as it is: at rest
    };
    /// Of a body in the metric of kinetic energy, kg and kg m^2.
    struct Weight {
        double linear = 0, angular = 0;
    };
    /// Of a pair, J: l W l and l (u - target), with u the velocities before the solve.
    struct Gain {
        double given = 0, from_start = 0;
    };
    /// A body as rows see it: what their frames and masses depend on, beside the contacts. Without padding.
    struct PlacedBody {
        Vec3 position;            ///< m, centre of mass
        double inv_mass = 0;      ///< 1/kg
        Sym3 inv_inertia;         ///< 1/(kg m^2), world; zero where inv_mass is
        std::uint64_t locked = 0; ///< AxisMask
    };
    /// What the solve before went by; this one makes anew only what depends on something else (assemble.hpp).
    struct LastSolve {
        bool complete = false; ///< all that it assembled is there
        std::vector<BodyPair> pairs;
        std::vector<std::uint8_t> movable;
        std::vector<std::int32_t> first_contact, num_awake, pair_order;
        Cone cone = Cone::none;
        bool to_and_fro = false;
    };
    LastSolve last;
    int num_colors = 0, num_islands = 0;
    std::int32_t most_regions = 1;           ///< of an island
    std::vector<PlacedBody> placed;          ///< per body in contact
    std::vector<std::uint8_t> body_stands;   ///< per body in contact: placed as in the solve before
    std::vector<std::uint8_t> block_stands;  ///< per block: its rows have the frames and masses of the solve before
    std::vector<std::int32_t> order;         ///< contacts in (a, b, feature key) order, infinite pairs left out
    std::vector<std::int32_t> bodies;        ///< ids of the bodies in contact, ascending
    std::vector<std::int32_t> local;         ///< per body id: its place in `bodies`
    std::vector<std::uint8_t> movable;       ///< per body in contact
    std::vector<BodyPair> pairs;             ///< bodies in contact, sorted
    std::vector<std::int32_t> first_contact; ///< per pair, into `order`; one more at the end
    std::vector<std::uint8_t> parked;        ///< as `order`
    std::vector<std::uint8_t> look;          ///< per contact
    std::vector<std::size_t> places;
    std::vector<double> tolerance;       ///< per pair, the least of its contacts, m/s
    std::vector<std::int32_t> num_awake; ///< active contacts of each pair
    std::vector<std::int32_t> color, island_of_pair, level, missing;
    std::vector<std::int32_t> pair_order; ///< pairs by (island, colour)
    std::vector<std::int32_t> packet_order;
    std::vector<std::int32_t> counts, sorted;
    std::vector<std::int32_t> region, cell, body_order; ///< of bodies in contact
    /// Of an island's movable bodies.
    struct Extent {
        Vec3 low, high; ///< m
        std::int32_t bodies = 0, numbered = 0;
    };
    std::vector<Extent> extents; ///< by island
    std::vector<std::int32_t> region_of_pair, region_to_and_fro;
    ColoringScratch coloring;
    ContactGraphScratch graph;
    LargeVector<BodyVelocity> velocity, start_velocity; ///< per body in contact
    LargeVector<ContactBlock> blocks;                   ///< in `pair_order`
    LargeVector<ContactRow> rows;
    bool any_extras = false; ///< a contact has a slip, or a point on each body
    PackedContacts packed, shock_packed;
    std::vector<std::int32_t> source; ///< contact of each row
    std::vector<Island> islands;
    std::vector<std::int32_t> island_bodies;             ///< movable, by island
    std::vector<std::int32_t> island_of_body;            ///< per body in contact, -1: not movable
    LargeVector<BodyVelocity> before_sweep, sweep_start; ///< per body in contact
    LargeVector<Weight> weight;                          ///< per body in contact
    /// Of a body's velocity since the solve began, m/s and rad/s.
    struct Change {
        Vec3 linear;
        double turn = 0;
    };
    LargeVector<Change> change; ///< per body in contact
    /// How a sweep went against the momentum that it began with, of some bodies, J (SweepEngine::add_up).
    struct Turns {
        double back = 0; ///< > 0: the path turns back
        double over = 0; ///< < 0: the sweep undid more than the momentum had added
    };
    std::vector<Turns> sums;                    ///< parts of sums, at the place of their first body in island_bodies
    std::vector<PacketGroup> groups;            ///< by island
    std::vector<double> energy_sums, work_sums; ///< parts of sums, by the places of bodies and packets of islands
    std::vector<Gain> gain;                     ///< by pair of one island
    ShareMemory whole_shares, part_shares;      ///< of an island or a level, and of a part of it
    std::vector<std::int32_t> small_islands;
    /// What a share of a sweep, or of an evaluation of the residual, found.
    struct alignas(64) Seen {
        double worst = 0;    ///< m/s
        double residual = 0; ///< m/s
        int violated = 0;    ///< pairs
    };
    std::vector<Seen> seen; ///< by share
    std::vector<std::uint8_t>
        violated; ///< per packet, a bit for each pair: what the last evaluation of a resting island found
    /// The part of an island that is not solved yet (unsolved_part.hpp).
    struct Unsolved {
        std::vector<std::uint8_t> near, chosen; ///< per body in contact: of a pair violated so far; of a chosen packet
        std::vector<std::uint8_t> touches;      ///< per packet: it has a near body
        std::vector<std::int32_t> bodies;       ///< the chosen movable ones
        std::vector<ContactPacket> packets;     ///< copies of the chosen ones
        std::vector<PacketGroup> groups;
        std::vector<Turns> sums;   ///< parts of a sum over the bodies
        std::int64_t contacts = 0; ///< that a sweep of them visits
    };
    std::vector<Unsolved> parts; ///< by thread
    /// The part of a large island in motion that is not solved yet, packed anew (packed_part.hpp).
    struct PackedPart {
        std::vector<std::uint8_t> near;       ///< per body in contact: of a violated pair, then of a chosen one
        std::vector<std::uint8_t> near_pairs; ///< per packet, a bit for each pair with a near body
        std::vector<std::int32_t> packets;    ///< of the island: those with chosen pairs
        std::vector<ContactBlock> blocks;     ///< copies of the chosen pairs, with the rows that are swept
        std::vector<std::int32_t> bodies;     ///< the chosen movable ones
        PackedContacts packed;
        std::vector<PacketGroup> groups;
        std::vector<Turns> sums;   ///< parts of a sum over the bodies
        std::int64_t contacts = 0; ///< that a sweep of them visits
    };
    PackedPart packed_part;
    /// What a thread needs to solve an island exactly.
    struct ExactSolve {
        std::vector<ConeBody> bodies;
        std::vector<ConeContact> contacts;
        std::vector<Vec3> impulses, swept; ///< N s, contact frames; those of the sweeps
        ConeScratch scratch;
        GrowingProgram program;
    };
    std::vector<ExactSolve> exact;                         ///< by thread
    std::vector<std::int32_t> exact_body;                  ///< per body in contact: its number in its island's problem
    std::vector<std::int32_t> level_order, level_of_block; ///< of one island: blocks by level
    LargeVector<ContactBlock> shock_blocks;                ///< of one level
    std::vector<Vec3> ground_impulses;                     ///< N s, by contact, on the movable body
    LargeVector<ContactRow> shock_rows;
    std::vector<PacketGroup> shock_groups; ///< of one level
    LargeVector<BodyVelocity> before_shock;
};

} // namespace flotilla
