// SPDX-License-Identifier: MIT
// Small islands that the sweeps leave unsolved are solved exactly (interior_point.hpp): sweeps converge slowly where
// bodies of different masses stand on one another, in chains, in long stacks and with thin bodies, and those are small.
#pragma once

#include "static_contact/solver_state.hpp"

namespace flotilla {

/// The share of an island's tolerance to which it is solved where it is solved exactly. It costs next to nothing there,
/// bodies on the edge of sliding do not creep, and stacks do not sway at the speed of the tolerance.
inline constexpr double kExactShare = 0x1p-20;
/// A share of an island's mean speed: a residual below it is the rounding of contact normals. In a joint without play
/// impulses of any size would answer it, with friction to match.
inline constexpr double kOfSpeed = 0x1p-36;

/// Islands of up to so many contacts are solved exactly after a few sweeps: that takes a few milliseconds at most, as
/// the sweeps would. Larger ones are where more sweeps leave them above what they aim at; slender ones at rest and
/// those of a few bodies are so at once: a ball on 1,400 contacts takes the time of the sweeps in preset balanced, and
/// sweeps left it unsolved in four of five steps.
inline constexpr auto kFewContacts = static_cast<std::int32_t>(kContactsAsTheyAre);

/// Problems that have a solution take ten to forty factorisations; the others end with what was found.
inline constexpr int kMostFactorisations = 40;
/// Floating point operations of a factorisation, a third of a cube of six degrees of freedom a body, for n^3 bodies.
inline constexpr double kOfFactorisation = 72;

/// Whether the island may be solved exactly: friction by the cone, and few enough contacts and bodies. Set `rests`
/// before.
[[nodiscard]] bool may_solve_exactly(const ContactScratch::Island& island, const ContactSolveOptions& options,
                                     const ContactScratch& scratch);

/// Whether its active contacts are more than its degrees of freedom. Normals of no more than those are independent, but
/// by chance, so that impulses exist that meet any targets. Of more, as in piles of shells, which touch at many points,
/// they may contradict each other. Locked axes count as free ones.
[[nodiscard]] bool may_be_over_constrained(const ContactScratch::Island& island);

/// Whether an island of many bodies that its sweeps left unsolved moves, other than as a whole: it is not worth more
/// than a few factorisations, and does not rest, whatever it had on entry beside gravity.
[[nodiscard]] bool moves_inside(const ContactScratch::Island& island, const ContactBodies& bodies,
                                const ContactSolveOptions& options, const ContactScratch& scratch);

/// A column, a chain, an arch: hardly more pairs with active contacts than bodies, and few others. What the contacts
/// leave undone adds up along it, so that a column of fifty leans and sways by a hundred times the tolerance; and its
/// factorisation costs no more than its bodies one by one.
[[nodiscard]] bool is_slender(const ContactScratch::Island& island);

/// Whether its exact solve takes far longer than its sweeps: it is solved so only where these do not reach what they
/// aim at, and no further than that.
[[nodiscard]] bool is_costly(const ContactScratch::Island& island);

[[nodiscard]] std::int32_t contacts_of(const ContactScratch::Island& island, const ContactScratch& scratch);
/// As many as an exact solve takes in as a rule (growing_program.hpp).
[[nodiscard]] std::int32_t contacts_in_need(const ContactScratch::Island& island, const ContactScratch& scratch);

/// Solves the unsolved islands that may be solved exactly, side by side. Their rows hold the impulses of the sweeps,
/// and then the exact ones; velocities follow.
void solve_exactly(const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& scratch);

} // namespace flotilla
