// SPDX-License-Identifier: MIT
// Targets of contacts: the velocities that stages 3 and 7 ask for, equation 16, and how nearly.
//
// Stage 3 asks for (d_rest - d)/dt; stage 7 for its minimum with 0, so that velocities which are kept do not gain from
// it. Squeezed pairs that wait (squeezed_pairs.hpp) ask for no more than they have. Around that: a dead band, arcs of
// turning bodies (response/arc.hpp, rolling.hpp), and in stage 7 the approach that pairs keep for their bounce in the
// next step.
//
// Reads: the contacts, the velocities at their poses. Writes: ContactTargets alone.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "proximity/contact_set.hpp"
#include "response/arc.hpp"
#include "static_contact/between.hpp"
#include "static_contact/contact_tuning.hpp"
#include "static_contact/rolling.hpp"
#include "static_contact/squeezed_pairs.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

/// Whether a tolerance was asked for: then it is meant, and nothing but the limit of sweeps ends a solve above it.
[[nodiscard]] inline bool tolerance_given(const Settings& s) {
    return s.static_tolerance >= 0 || s.tolerance_share < 1;
}

/// A direction in which a pair was in contact.
struct PairNormal {
    std::int32_t a, b; ///< a < b
    Vec3 normal;       ///< unit, from a to b
};

/// What targets depend on, beside contacts and velocities.
struct TargetInput {
    bool final_stage = false; ///< stage 7
    /// Pairs that stage 1 did not process keep the approach that their motion in the step gave them, for the bounce of
    /// the next step.
    bool keep_approach = false;
    /// In stage 7, of the contacts at x^n of pairs that rebound, sorted by pairs: in another direction a pair that was
    /// in contact, or that stage 1 made part, is not processed.
    std::span<const PairNormal> known_normals;
    std::span<const Pose> start;         ///< x^n
    std::span<const Pose> poses;         ///< of the contacts: x^n, or x^{n+1} in stage 7
    std::span<const Motion> last_motion; ///< v^n: which contacts stick
    /// By body: contacts do not raise it to its rest distance; may be empty: of none.
    std::span<const std::uint8_t> level;
    bool all_level = false;                 ///< of none at all
    std::span<const SqueezedPair> squeezed; ///< State::squeezed
    std::span<const RestDistance> noted;    ///< State::rest_distances
    /// By body: what of the velocities does not move it in this step (Cluster::late, but for the mean of free islands);
    /// empty: nothing.
    std::span<const Motion> late;
    /// By body: the motion that a scripted one is due, where some have less (scripts.hpp); empty: where none has.
    std::span<const Motion> due_motion;
    bool raises = false;            ///< after a solve of the same velocities that did not, in which scripts press
    std::span<const Vec3> impulses; ///< N s, on b, by contact: which the solve begins with
    std::span<const Vec3> carried;  ///< N s, likewise: which the last solve of another stage found at these contacts
    double accelerated = 0;         ///< s, for which loads have acted on the velocities, without contacts
    ContactTuning tuning{};
};

/// Kept between steps, so that a steady scene allocates nothing.
struct ContactTargets {
    std::vector<Contact> contacts;     ///< those of a set, with targets and tolerances, moved to where arcs bring them
    std::vector<ArcContact> arcs;      ///< by contact
    std::vector<std::uint8_t> carries; ///< by contact: arcs.carries is not zero
    std::vector<double> presses;       ///< m/s, by contact (ContactSolveOptions); empty: none
    Between between;
    bool would_raise = false; ///< whether all_level made a difference that counts
    TurningBodies turning;
};

/// Fills `out` with the contacts of the set. `bodies`: at input.poses.
void set_targets(Team* team, const Model& model, const ContactSet& set, const VelocityArrays& bodies,
                 const TargetInput& input, ContactTargets& out);

} // namespace flotilla
