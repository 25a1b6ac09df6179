// SPDX-License-Identifier: MIT
// The numbers of static contact that change results and that neither the paper nor a setting gives, but for those of
// the exact solver, of the order of sums, and some of rolling.cpp (src/CONSTANTS.md): what it is a share or a multiple
// of, why it is as it is, and under which name bench/results/ablation.md has what happens without it. Names are of one
// glossary (README.md): a look is an evaluation of the residual, parked contacts are inactive, a jam is an
// over-constrained island.
//
// Nobody sets them but bench/scenarios/ablation. What the exact solver goes by is beside it (exact_islands.hpp,
// exact_islands.cpp, interior_point.cpp); src/CONSTANTS.md lists that too.
#pragma once

namespace flotilla {

struct ContactTuning {
    // --- sweeps (sweep_engine.hpp) ---

    /// Upper bound on the momentum coefficient m: the share of the last change that is added before a sweep. Slow modes
    /// become 1 / (1 - m) times faster; beyond 0.95 fast ones ring. Row: momentum.
    double most_momentum = 0.95;
    /// Residual, in multiples of the lowest one, at which momentum begins anew: it can keep a turning error alive that
    /// never heads straight back. Thirty bodies with friction then never come nearer than 0.17 m/s to a solution. Row:
    /// rise.
    double most_rise = 2;
    /// Sweeps between two evaluations of the residual, of which one costs half a sweep. Row: looks.
    int look_every = 10;
    /// Sweeps after which inactive contacts are evaluated, before the first residual is: sweeps that do not know of a
    /// violated one are in vain. It saves no time, but 102 boats (nine seeds) come to rest after 6.6 s with it and
    /// after 7.8 s without. 0: never. Row: peeks.
    int peek = 2;

    /// A packet that meets more than this share of the worst violation of the sweep before, and than the tolerance, is
    /// visited again at once, up to so many times in all. Contacts of one pair that lie near each other and want what
    /// does not go together, within a few tolerances, hand their load from one to the other by that much a visit: a
    /// hundred sweeps and more in which nothing else happens, and a visit of what is at hand costs a fraction of what
    /// one in the next sweep does. 1 visit: none is. Row: visits.
    double repeat_share = 0.25;
    int most_visits = 16;

    // --- giving up (sweep_island.cpp) ---

    /// Sweeps in which the residual has to fall to `least_fall` of itself: so many, or this share of the limit of
    /// sweeps where that is more, since a caller that allows many means it. Row: patience.
    int patience = 50, patience_share = 20;
    double least_fall = 0.8;
    /// An island at rest that no exact solve follows is not given up so: what it is left with is there again in the
    /// next step, and walls, tables and pyramids of 100 to 200 boxes, whose slow modes keep the residual where it is
    /// for longer, swayed for ever at up to 0.5 m/s. Row: patience at rest.
    bool patient_at_rest = true;
    /// A jam: in an over-constrained island, of more active contacts than degrees of freedom (exact_islands.hpp),
    /// targets may contradict each other, and bodies hand load round for ever. One evaluation after the other finds
    /// the residual where it was, to the share `stands`, and more than `fewer` of the violated pairs. So many
    /// evaluations in a row end a solve; 0: none does. Elsewhere the residual may also stand, but because a slow mode
    /// of many bodies (a stack that leans, a narrow heap of stones) is on its way. Row: jams.
    double stands = 0.01, fewer = 0.9;
    int looks_at_jam = 2;
    /// Rest speed, in what gravity adds in a step: an island is at rest if its kinetic energy on entry is at most 1/2 m
    /// v^2 at this speed. A body that is held up has 1 before the solve. Row: rest.
    double rest_speed = 2;
    /// The share of its tolerance that sweeps of an island at rest aim at. One that ends at the tolerance begins the
    /// next solve beyond it: with 1 walls of bricks move at six tolerances for ever, and piles at rest at ten times the
    /// energy and more. With an eighth 1,002 boats at rest take twice the time in contact solves that they take with a
    /// half. Row: aim.
    double aim_at_rest = 0.5;
    /// The share to which exact solves of several bodies in motion are taken. As far as those at rest (kExactShare)
    /// they took twice the time, for 1,323 stones that land. Row: aim.
    double aim_in_motion = 0.125;

    // --- what is not swept (assemble.cpp, unsolved_part.cpp) ---

    /// A margin, in tolerances. A contact without impulse is inactive (parked) where its gap is wider by this than what
    /// the bodies would cross in the step. It cannot be violated while the relative velocity of its points changed by
    /// less since then. Row: parked.
    double parked_margin = 25;
    /// The share of that margin which is compared: the rest is far more than its sums are rounded by.
    double parked_room = 0.9;
    /// A part that is swept alone is at most the island's batches divided by this; 0: none is. It then costs less than
    /// an evaluation. Row: parts.
    int part_divisor = 8;
    /// Sweeps of a part between two evaluations of the whole. Row: part sweeps.
    int part_sweeps = 100;
    /// Where an island at rest is solved by sweeps, the contacts of bodies that still move by more than so many of its
    /// tolerances (0: of none), and their neighbours', are swept to this share of what sweeps aim at, once, but where a
    /// caller asked for a tolerance: a body on a narrow base turns what its contacts are left with into as much more
    /// motion as it is wider than its base, and each step begins with what the one before left. A boat that three
    /// corners close to each other carry rocked for ever, at 16 tolerances; where nothing sleeps it does so at what
    /// this lets pass. Row: settling.
    double settle_above = 1, settle_to = 1.0 / 64;
    /// Where those are too many for a part and the island is slower than so many of its tolerances, at which bodies
    /// fall asleep, the whole goes on to this share of what sweeps aim at: what contacts are left with adds up along
    /// the rows of a pyramid, whose top sinks at twenty times that, and each step begins with it and leaves as much
    /// again. Row: settling of the whole.
    double settle_whole_below = 16, settle_whole_to = 1.0 / 8;
    /// In `look_every`: what the rounds of parts after one evaluation may cost, in sweeps of the whole.
    int part_waits = 4;
    /// In a large island in motion the part is packed anew, of pairs with a violation above the tolerance and this
    /// share of the worst one. What is stirred lies scattered and is slow to converge, beside much that hardly moves:
    /// with momentum of its own the worst is done first. It is at most the island's pairs divided by `packed_divisor`
    /// (0: none is), beyond which a round is dearer than the sweeps of the whole that it takes the place of. 1,323
    /// stirred stones, settled: the three solves of a step take 123 sweeps in place of 473 and half the time, and leave
    /// 0.025 m/s in place of 0.046 (medians); with 1/64 190 sweeps, with 1/4 111, which leave 0.032. Row: packed parts.
    double packed_above = 1.0 / 16;
    int packed_divisor = 2;
    /// Sweeps of such a part between two evaluations. Packing and evaluating cost as much as some five of them. With
    /// 40, which are given up as early, those stones are left with 0.081 m/s. Row: packed sweeps.
    int packed_sweeps = 20;
    /// Within a colour pairs with an even number of active contacts are ordered by region, those with an odd one
    /// backwards. Row: to and fro.
    bool to_and_fro = true;

    // --- shock propagation (shock.cpp) ---

    /// Sweeps in which the violation that a level's sweeps meet has to fall to `least_fall` of itself: a level of
    /// bodies that touch at many points may have no solution with what lies below it frozen. Row: level patience.
    int level_patience = 20;

    // --- the island's energy (solve_contacts.cpp) ---

    /// A share of its energies: far more than their sums are rounded by.
    double energy_rounding = 0x1p-40;

    // --- where the exact solver follows (solve_contacts.cpp, exact_islands.hpp) ---

    /// An exact solve starts from what so many sweeps find, of few contacts, of slender islands and of many contacts,
    /// and is not needed where that is all. By `operations_of_contact` 300 sweeps over many cost no more than one of
    /// its ten to forty factorisations for fifty bodies: 52 boats that settle take a third of the time that they take
    /// with 60. A hundred boxes under one of 1e9 times their mass, preset accurate, take 1.5 times the time with 300 in
    /// place of 60. Row: exact.
    int sweeps_before_exact = 20, sweeps_of_slender = 60, sweeps_of_many = 300;
    /// The same of islands of few contacts and several bodies in motion, which are solved exactly only where these
    /// leave them above the tolerance: three of four are within it after 20, and 60 cost no more than a factorisation
    /// or two. 1,323 stones that land, 700 islands a solve: contact response against stage 1 takes 0.28 of the time,
    /// with 20 0.49. Row: few in motion.
    int sweeps_of_few_in_motion = 60;
    /// Floating point operations of a factorisation that take as long as a contact in a sweep, some 25 ns: an island
    /// that is neither small nor at rest is swept for as long as an exact solve would take. Where the tolerance is
    /// beyond the reach of sweeps these would else run to their limit, and the exact solve would follow.
    double operations_of_contact = 25;
    /// Bodies whose factorisation, some 72 n^3 operations, costs less than so few sweeps over the eight or so contacts
    /// of each.
    int bodies_factorised_soon = 8;

    // --- tolerances and targets (targets.cpp) ---

    /// The share of the rest distance that a target's dead band takes at most. Row: band.
    double most_of_rest = 0.02;
    /// A pair that lacks more than that share of its rest distance at the ends of so many steps in a row is asked in
    /// vain (squeezed_pairs.hpp), and first waits as many. A blow brings pairs too near in one step or two: with 2 a
    /// chain that fell taut hangs by joints of other play than its neighbours'. 0: none is. Row: squeezed.
    int steps_in_vain = 4;
    /// The tolerance, as a share of what gravity adds in a step, and of a rest distance a step (`static_tolerance` in
    /// `flotilla plan --settings` says what it costs). No row.
    double of_gravity = 1.0 / 4096, of_rest = 1.0 / 2048;
    /// A tolerance that was asked for is at least this share of the velocity that what a contact carries would give its
    /// bodies by itself, l W: sixteen times the rounding of that, of which a velocity is a sum. A dead band below it
    /// lets gaps that are equal but for rounding open and close contacts, and no solve comes to its end. A hundred
    /// boxes under one of 1e9 times their mass, preset reference, collapse without it, and with a fourth of it move at
    /// 1e-3 m/s. Row: load.
    double of_load = 0x1p-48;
    /// Slip, as a share of what gravity adds in a step: contacts that slide by less keep their random tangents. Only
    /// the paper's pyramids have such.
    double most_slip = 0.1;
};

} // namespace flotilla
