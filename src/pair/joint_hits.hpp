// SPDX-License-Identifier: MIT
// Hits solved together, where sweeps over pairs gain nothing or come to their limit.
//
// A light body between heavy ones, or between one and the ground, hands on in a sweep no more than its own mass takes:
// pushes fall by the ratio of the masses, and the links of a chain under a load of 100 times theirs take thousands of
// sweeps. So hits are kept here, each as the contact that it is: what it asks for along its normal, with friction.
// After each round of queries all of an island's are solved at once, as stage 3 solves its contacts. What that makes
// hit elsewhere is met in the next round. Rounds end where nothing hits any more; bodies that they do not help are
// left, and go on as before all of it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "islands/contact_graph.hpp"
#include "pair/impulses.hpp"
#include "pair/step_view.hpp"
#include "pair/worker.hpp"
#include "state/contact.hpp"

namespace flotilla {

/// Solves contacts, sorted by bodies, of bodies that move as `motion` (by body) without them. `impulses`: N s, on b, by
/// contact; in, what was found in the last round. Returns flags by body: islands for which nothing near a solution was
/// found.
using SolveHits = std::function<std::span<const std::uint8_t>(
    std::span<const Contact> hits, std::span<const Motion> motion, std::span<Vec3> impulses)>;

/// Rounds, and tries of a pair: of 10,435 solves that ended 10,406 did so within ten.
inline constexpr int kMostRoundsTogether = 16;
/// What a solve may leave undone, of a rest distance in the step: hits are answered by several of them.
inline constexpr double kUndoneTogether = 1.0 / 16;

/// What solves hits, and the bodies that it did not help, as flags by body.
struct JointSolve {
    SolveHits solve;
    std::vector<std::uint8_t> left;
};

/// A hit that is kept, and what it was answered with.
struct MetHit {
    Contact contact;                ///< without its points
    Vec3 arm_a, arm_b;              ///< m, from the centres of mass
    std::optional<Landing> landing; ///< in stage 1, of the motion before all of it
    Vec3 impulse;                   ///< N s, on b, as it was solved for
    bool changed = false;           ///< that, in this round
    int failures = 0;               ///< rounds in a row whose solve found no solution
};

/// Clusters must be single bodies.
class JointHits {
  public:
    /// Bodies that are left in `joint` take no part. `most_hits`: of an island, of all rounds; what a solve takes grows
    /// faster than their number.
    JointHits(const StepView& view, Movers movers, Workers& workers, JointSolve& joint, std::ptrdiff_t most_hits,
              StageCounters& counters);

    [[nodiscard]] bool is_left(std::int32_t body) const { return joint_.left[static_cast<std::size_t>(body)] != 0; }
    void leave(std::int32_t a, std::int32_t b);
    /// Velocities of a body before any of it.
    [[nodiscard]] Impulsive before(std::int32_t body) const;
    /// How many hits of a pair were kept in earlier rounds.
    [[nodiscard]] int tries(std::int32_t a, std::int32_t b) const;

    /// A hit of this round, with what it asks for.
    void add(const MetHit& hit) { kept_.push_back(hit); }
    /// Moves bodies by what solves all that is kept. Islands that have no solution are left: more hits would not give
    /// them one. `clamps`: no island gets more energy than it had.
    void solve(bool clamps = false);

    // After solve().
    [[nodiscard]] std::span<const MetHit> hits() const { return kept_; } ///< sorted by bodies
    /// By hit.
    [[nodiscard]] std::span<const std::int32_t> islands() const { return island_; }
    [[nodiscard]] std::size_t num_islands() const { return changed_.size(); }
    [[nodiscard]] bool moved(std::int32_t island) const { return changed_[static_cast<std::size_t>(island)] != 0; }
    [[nodiscard]] std::span<const std::int32_t> moved() const { return moved_; } ///< bodies
    /// N s, on b, that the hit acts with.
    [[nodiscard]] Vec3 impulse(std::size_t hit) const;

  private:
    void find_islands_of_hits();
    void mark_pinched();
    void leave_islands();
    void leave_changed();
    void move_islands(bool by_impulses);
    void clamp_energy();

    const StepView& view_;
    Movers movers_;
    Workers& workers_;
    JointSolve& joint_;
    std::ptrdiff_t most_hits_;
    StageCounters& counters_;
    std::vector<Motion> motion_;        ///< by body, before any of it
    std::vector<ClusterChange> before_; ///< the same of its cluster
    std::vector<MetHit> kept_;          ///< sorted by bodies; those of this round behind them until solve()
    std::size_t known_ = 0;             ///< of kept_, of earlier rounds
    std::vector<BodyPair> bodies_of_;   ///< of kept_, as the next
    std::vector<std::int32_t> island_;
    std::vector<std::uint8_t> changed_; ///< by island, as flags
    std::vector<double> share_;         ///< by island, of its impulses
    std::vector<std::size_t> places_;   ///< in kept_
    std::vector<std::uint8_t> movable_; ///< by body
    ContactGraphScratch graph_;
    std::vector<Contact> contacts_; ///< of kept_
    std::vector<Vec3> impulses_;    ///< N s, likewise
    std::vector<Impulsive> gained_; ///< by body, scratch
    std::vector<std::int32_t> moved_;
};

} // namespace flotilla
