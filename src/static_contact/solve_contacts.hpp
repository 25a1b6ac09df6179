// SPDX-License-Identifier: MIT
// Static contact (paper, section 4.3.2): impulses that leave no contact approaching faster than its target, with
// friction, by projected Gauss-Seidel (eqs 15-22) and, where that ends unfinished, shock propagation.
//
// Contacts are visited island by island, in an island colour by colour, in a colour pair by pair, in a pair by feature
// key. That order is a pure function of the island's own contacts: neither the order of the input nor other islands can
// change a bit. Every island stops by itself.
//
// Reads: contacts, positions, masses, velocities. Writes: velocities of bodies of finite mass, impulses, scratch.
#pragma once

#include <cstdint>
#include <span>

#include "static_contact/solver_state.hpp"

namespace flotilla {

struct ContactSolveStats {
    int islands = 0;
    int colors = 0;
    int iterations = 0; ///< most sweeps of an island, those of parts counted as what they cost
    /// Contact updates, shock passes included; of activated contacts as if from the start, without those of packets
    /// that a sweep visits again.
    std::int64_t visits = 0;
    /// m/s, violation of all of eqs 17-20 by the final state, a shock pass included (shock.hpp). This and the next
    /// without islands with bounds of friction: what they leave undone are places (ContactSolveOptions::bounds).
    double residual = 0;
    int unsolved_islands = 0; ///< whose sweeps, or whose exact solve, ended above their tolerance
    int shocked_islands = 0;  ///< islands whose velocities come from a shock pass
    int part_rounds = 0;      ///< times that a part of an island was swept alone
    int exact_islands = 0;    ///< solved exactly, or nearer to it than PGS came
    int cold_islands = 0;     ///< islands whose warm start was taken back because it added energy
};

/// Solves all contacts. impulses[k] of contacts[k], N s in the world, on b: in, the warm start (zero if cold; projected
/// on the contact's frame and cut to its cone; ignored without warm_start), out, the result of PGS. Shock propagation
/// changes velocities only: its impulses know nothing of the weight above, so they are no measure of a force and are
/// neither handed out nor used as a friction bound. Contacts between two bodies of infinite mass get zero. Most
/// contacts of a resting pile are gaps that nothing will close in the step. Those without impulse that the bodies are
/// far from closing are inactive (parked): sweeps leave them out, evaluations of the residual do not, and a batch with
/// one that is violated becomes active. So the residual counts all contacts.
ContactSolveStats solve_contacts(std::span<const Contact> contacts, const ContactBodies& bodies,
                                 const ContactSolveOptions& options, std::span<Vec3> impulses, ContactScratch& scratch);

} // namespace flotilla
