// SPDX-License-Identifier: MIT
// What one time step reports: one row of a run's steps.csv, and what World::step returns.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include <flotilla/types.hpp>

namespace flotilla {

/// The timed parts of a step, in the order of the stages; the certificate runs between stages 5 and 6. `detection` and
/// the three after it split the same time another way (the paper's figure 17), so they are not part of the sum.
enum class Phase : std::uint8_t {
    collisions,          ///< stage 1
    half_velocity,       ///< stage 2
    half_static_contact, ///< stage 3
    position,            ///< stage 4
    dynamic_contact,     ///< stage 5, Algorithm 2
    failsafe,            ///< stage 5, Algorithm 3
    velocity,            ///< stage 6
    static_contact,      ///< stage 7
    certificate,         ///< end-of-step check
    detection,           ///< of collisions, dynamic contact and failsafe: time of all threads together
    response,            ///< of collisions, dynamic contact and failsafe: time of all threads together
    static_detection,    ///< contact search of stage 7
    static_response,     ///< contact solves of stages 3 and 7
};
inline constexpr std::size_t kNumPhases = 13;
inline constexpr std::array<std::string_view, kNumPhases> kPhaseNames{
    "stage1_collisions", "stage2_velocity",  "stage3_static_contact", "stage4_position", "stage5_dynamic_contact",
    "stage5_failsafe",   "stage6_velocity",  "stage7_static_contact", "certificate",     "detection",
    "response",          "static_detection", "static_response"};

/// Reasons to look at a step; a set of bits. A setting that may be raised against it is named where there is one.
enum StepWarning : std::uint32_t {
    /// Stage 1 ended before it was quiet: at collision_iterations, or as more sweeps gained nothing.
    kCollisionLimit = 1u << 0,
    /// Algorithm 2 was given up, at dynamic_iterations or as more sweeps gained nothing: the failsafe had to finish.
    kDynamicLimit = 1u << 1,
    /// A contact solve ended above its tolerance (of fast bodies: and above the rounding of its normals): at
    /// static_iterations, or as more sweeps gained nothing. Not where a script squeezes up to eight bodies to less than
    /// their rest distance: that has no solution but one that yields.
    kStaticLimit = 1u << 2,
    /// A scripted body did not go all its way, as bodies are in it or were of late (unsatisfiable_script).
    kScriptDelayed = 1u << 3,
    /// A body that the failsafe held, or that was hit without end, lost a rebound of stage 1 (dynamic_iterations).
    kReboundLost = 1u << 4,
};

/// The report of a step that is made of inner ones (Settings::substeps): times and counts are summed; residual,
/// smallest distance, clusters and held bodies are the worst; the rest is the last inner step's.
struct StepReport {
    std::int64_t step = 0; ///< 1 after the first step
    double time = 0;       ///< s, at the end of the step
    double total_ms = 0;   ///< wall time
    std::array<double, kNumPhases> phase_ms{};

    /// Candidate body pairs examined. Pairs known to be apart are not: a count of work, which may be another after a
    /// restore or a resume, where nothing is known yet. All else here but times has the same bits.
    std::int64_t pairs = 0;
    std::int64_t collisions = 0; ///< impulses of stage 1
    std::int64_t contacts = 0;   ///< contact points of stage 7
    std::int64_t iterations = 0; ///< sweeps of PGS, stages 3 and 7 together
    /// m/s, largest constraint violation that contact solves left; not that of raising bodies that hold each other.
    double residual = 0;
    std::int64_t merges = 0; ///< clusters merged: by the failsafe, and pairs that dynamic contact rigidified
    /// Steps down the failsafe's ladder free, kinematic, rigid, held; and bodies that were slowed down: whose end was
    /// made again with half of their velocity.
    std::int64_t rung_changes = 0;
    std::int64_t held = 0; ///< bodies at x^n at the end

    double energy = 0; ///< J, kinetic and potential
    Vec3 momentum;     ///< kg m/s, linear, of all dynamic bodies together
    /// m, smallest distance of two bodies, one of them awake, at the end poses, and with substeps at those of all inner
    /// steps; infinite where none are within their proximity distance.
    double min_distance = std::numeric_limits<double>::infinity();
    std::uint64_t state_hash = 0;

    Vec3 angular_momentum;             ///< kg m^2/s about the world's origin
    double kinetic_energy = 0;         ///< J
    std::int64_t kinematic_bodies = 0; ///< in clusters that ended on the rung ClusterState::kinematic; no scripted ones
    std::int64_t rigid_bodies = 0;     ///< in clusters that ended on the rung ClusterState::rigid
    std::int64_t largest_cluster = 0;  ///< bodies in the largest cluster
    std::int64_t trigger_a = -1;       ///< the pair of the first failsafe event, body indices; -1: none
    std::int64_t trigger_b = -1;
    std::int64_t sleeping = 0;          ///< bodies asleep
    std::int64_t sleeping_contacts = 0; ///< of bodies that slept through the step: `contacts` does not count them
    std::uint32_t warnings = 0;

    // Energy may rise by lift alone: what brings bodies to their rest distance, at most m |g| d_rest of each (G5).
    std::int64_t energy_corrections = 0; ///< islands whose velocities the last resort cut, because it rose by more
    double energy_removed = 0;           ///< J, taken from them
    double lift = 0;                     ///< J, of all bodies, booked at the end of the step

    // Pruning at the end poses (section 4.3.1): of the feature pairs within the proximity distance, those that are no
    // contact points, by the first rule that left them out.
    std::int64_t proximities = 0; ///< feature pairs within the proximity distance, of pairs searched (contact_reuse)
    std::int64_t pruned_end_points = 0;     ///< ends of edges, what is in a flat face or at one place: others repeat it
    std::int64_t pruned_same_direction = 0; ///< farther faces of the same vertex in the same direction
    std::int64_t pruned_angle = 0;          ///< not the nearest point that the other body sees
    std::int64_t pruned_occluded = 0;       ///< a body lies between the points

    [[nodiscard]] double& ms(Phase phase) { return phase_ms[static_cast<std::size_t>(phase)]; }
};

/// How a body moved in a step: by itself, or by a rung of the failsafe's ladder; or that it is asleep at the end.
enum class ClusterState : std::uint8_t {
    free,
    kinematic, ///< with others, keeping their relative motion; a rung of dynamic bodies, not BodyType::kinematic
    rigid,     ///< as one rigid body with others
    held,      ///< not at all
    asleep,    ///< not at all: it rests, and stands still until something comes near
};

/// What a step did with one body. The same at any number of threads, and in a resumed run.
struct BodyActivity {
    /// Contact points with other bodies at the end poses, nearer than the proximity distance; of sleeping bodies as
    /// well.
    std::int64_t contacts = 0;
    ClusterState cluster = ClusterState::free;
    /// How often the step set the body's end state: 0 for bodies that rest or have infinite mass, 2 for one that
    /// nothing touched; the more, the more work it was.
    std::int64_t cost = 0;
};

/// A contact point at the present poses.
struct ContactState {
    std::int32_t body_a = 0, body_b = 0; ///< a < b
    Vec3 point;                          ///< m, world
    Vec3 normal;                         ///< unit, from a to b
    double distance = 0;                 ///< m, along the normal
    /// On b, N s, world: what the contact carried in the last step, divided by the time step the mean force; a got its
    /// opposite. That of stages 3 and 7 of all inner steps, without the blows of stage 1. What contacts of the pair
    /// carried that are none any more at its end is shared out to those that are; a pair that has none then, having
    /// landed or parted in the step, is listed with those that carried, at their places at its end.
    Vec3 impulse;
    /// Neither body moves: they sleep, or have infinite mass. Point, normal and distance are what they are; the impulse
    /// is that of the inner step in which the island fell asleep, times the number of substeps.
    bool asleep = false;
    /// m, world: from `point`, which is on a then, to where the impulse acts on b, of a pair with friction of which a
    /// body is thinner than the distance at which they rest; else zero: both have one point.
    Vec3 across;
    friend bool operator==(const ContactState&, const ContactState&) = default;
};

} // namespace flotilla
