// SPDX-License-Identifier: MIT
// Stages 3 and 7: contact points at one set of poses, and the solve that keeps them from approaching (paper, section
// 4.3).
#pragma once

#include <functional>

#include <flotilla/report.hpp>

#include "pair/step_data.hpp"
#include "response/arc.hpp"
#include "static_contact/solve_contacts.hpp"

namespace flotilla {

/// Contact points at the end poses of all pairs within their proximity distance, sorted by (a, b, feature key); those
/// found ahead come after the others of their pair.
struct ContactSet {
    std::vector<Contact> contacts;       ///< targets unset
    std::vector<double> rest;            ///< m, rest distance of each contact's pair
    std::vector<std::uint8_t> processed; ///< stage 1 examined the pair, near at the start or the end of its motion
    std::vector<std::uint8_t> ahead;     ///< found by what the bodies would do (look_ahead.hpp)
    std::vector<CandidatePair> near;     ///< pairs whose boxes come within the reach of gravity, sorted; if kept
    bool keeps_near = false;             ///< for look_ahead.hpp
    double min_distance = std::numeric_limits<double>::infinity(); ///< m, of all feature pairs within proximity
    PruneCounters counters;                                        ///< of the search

    [[nodiscard]] std::size_t size() const { return contacts.size(); }
    void clear();
    void resize(std::size_t size);
    void add(const Contact& contact, double rest_distance, bool was_processed, bool is_ahead);
    /// The pairs of its contacts, without those that are only ahead.
    void list_pairs(std::vector<CandidatePair>& out) const;
    /// Takes pairs for processed, given in the order of the contacts.
    void mark_processed(std::span<const CandidatePair> pairs);
    /// Writes the contacts of `part` over those from `place` on.
    void put(std::size_t place, const ContactSet& part);
    /// Appends those of `part` from `begin` to `end`.
    void append(const ContactSet& part, std::size_t begin, std::size_t end);
    /// Takes the contacts of pairs that it has none of, in the order of pairs.
    void merge(const ContactSet& others);
    /// Removes the contacts that are not wanted, by their places; the smallest distance stays.
    template <typename Wanted>
    void keep(Wanted&& wanted) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (!wanted(i)) continue;
            contacts[kept] = contacts[i];
            rest[kept] = rest[i];
            processed[kept] = processed[i];
            ahead[kept++] = ahead[i];
        }
        contacts.resize(kept);
        rest.resize(kept);
        processed.resize(kept);
        ahead.resize(kept);
    }
};
/// A contact at the point of the vertex, or of body a's edge (section 4.3.1), without a target.
[[nodiscard]] Contact contact_of(std::int32_t a, std::int32_t b, const ProximityPoint& point, double friction);
/// What the tasks of a contact search found, and scratch.
struct ContactSearchScratch {
    std::vector<ContactSet> parts;
    std::vector<std::size_t> places;
};
/// `step`: that ends, or ended, at the end poses.
void find_contacts(StepData& data, std::int64_t step, ContactSearchScratch& scratch, ContactSet& out);
/// The same of the pairs that are wanted alone; `out.near` has all.
void find_contacts_of(StepData& data, std::int64_t step, const std::function<bool(const CandidatePair&)>& wanted,
                      ContactSearchScratch& scratch, ContactSet& out);

/// Bodies as stages 3 and 7 see them: velocities to be changed and the inertia of the poses where the contacts are.
struct VelocityArrays {
    std::vector<Vec3> position, velocity, angular_velocity;
    std::vector<double> inverse_mass;
    std::vector<Mat3> inverse_inertia;
    std::vector<Mat3> inertia; ///< with locked axes the block of the free ones
    std::vector<AxisMask> locked;
    std::vector<double> rest_speed; ///< m/s, see ContactBodies; empty where no body has loads of its own

    std::uint64_t still_version = 0; ///< of the bodies loaded that stand still

    /// Of the active bodies, and of those that stand still where these are of another version.
    void load(Team* team, const Model& model, std::uint64_t version, std::span<const Pose> poses,
              std::span<const Motion> motion);
    /// Writes back; a momentum changes only where the angular velocity did, so that untouched bodies keep theirs to the
    /// bit.
    void store(Team* team, const Model& model, std::span<const Vec3> angular_before, std::span<Motion> motion) const;
};

struct StaticStageOptions {
    bool final_stage = false; ///< stage 7: target min(0, (d_rest - d)/dt)
    /// Pairs that stage 1 did not process keep the approach that their motion in the step gave them, for the bounce of
    /// the next step.
    bool keep_approach = false;
    double warm_factor = 1; ///< of impulses taken over from the other stage
    std::int64_t step = 0;
    std::uint64_t still_version = 0;     ///< ListBuffers::still_version
    std::span<const Motion> last_motion; ///< at x^n: which contacts stick
    std::span<const Pose> start;         ///< x^n; read with keep_approach
    std::span<const std::uint8_t>
        level; ///< by body: contacts do not raise it to its rest distance; may be empty: of none
    Team* team = nullptr;
    ContactTuning tuning{};
    bool normal_rows = true; ///< Savings
};

struct StaticStageScratch {
    ContactScratch solver;
    VelocityArrays bodies;
    std::vector<Vec3> last_velocity, last_angular_velocity; ///< by body: at x^n, or prescribed
    std::vector<Vec3> angular_before;
    std::vector<Contact> selected;
    std::vector<ArcContact> arcs;    ///< of `selected`
    std::vector<std::size_t> places; ///< in `selected`, by chunk of contacts
    std::vector<Vec3> impulses;
    std::vector<std::int32_t> stored; ///< of `selected`, those whose impulses are kept
};

struct StaticStageStats {
    ContactSolveStats solve;
    std::int64_t contacts = 0;
};

/// Solves the contacts of the set on `motion`; `warm` holds the impulses of this stage's last solve and takes those of
/// this one, `other` holds those of the other stage.
StaticStageStats solve_static_contact(const Model& model, const ContactSet& set, std::span<const Pose> poses,
                                      std::span<Motion> motion, std::vector<WarmImpulse>& warm,
                                      std::span<const WarmImpulse> other, const StaticStageOptions& options,
                                      StaticStageScratch& scratch);

} // namespace flotilla
