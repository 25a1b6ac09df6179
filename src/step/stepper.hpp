// SPDX-License-Identifier: MIT
// One time step (paper, section 2): seven stages over the state.
#pragma once

#include <exception>
#include <functional>

#include <flotilla/report.hpp>

#include "base/hasher.hpp"
#include "broadphase/kept_pairs.hpp"
#include "collision/collisions.hpp"
#include "dynamic_contact/dynamic_contact.hpp"
#include "failsafe/failsafe.hpp"
#include "islands/sleeping.hpp"
#include "pair/contact_search.hpp"
#include "static_contact/even_loads.hpp"
#include "static_contact/geometric_stiffness.hpp"
#include "static_contact/landing_load.hpp"
#include "static_contact/solve_contacts.hpp"
#include "static_contact/targets.hpp"
#include "static_contact/warm_impulses.hpp"
#include "step/certificate.hpp"
#include "step/energy_account.hpp"
#include "step/look_ahead.hpp"
#include "step/scripts.hpp"

namespace flotilla {

/// None but `tuning` changes a bit of the results.
struct StepperOptions {
    bool keep_candidates = true; ///< neighbour lists and known distances of pairs, between queries: changes cost only
    TeamOptions team{};
    Savings savings{};
    ContactTuning tuning{}; ///< for measurements of what each of them is worth
};

/// Where an inner step ended, by body.
struct InnerState {
    std::vector<Pose> pose;
    std::vector<Vec3> turn; ///< rad, see Stepper::turns()
};

/// Bytes, of what grows with the scene.
struct StepperMemory {
    std::size_t bodies = 0, contacts = 0, pairs = 0;
};

/// A step that its observer ended.
struct CancelledStep {
    Phase phase;               ///< after which
    std::exception_ptr thrown; ///< by the observer; null: it said no
};

/// The hash of a state that edits led to; 0: there were none.
[[nodiscard]] inline std::uint64_t with_edits(std::uint64_t state, std::uint64_t edits) {
    if (edits == 0) return state;
    Hasher h;
    h.add(state), h.add(edits);
    return h.value();
}

class Stepper {
  public:
    /// The state must be free of intersections.
    Stepper(const Model& model, State state, const StepperOptions& options = {});

    Stepper(const Stepper&) = delete;
    Stepper& operator=(const Stepper&) = delete;

    /// Advances by the settings' time step, in as many inner steps as they say. Throws CertificateError rather than
    /// leave an unproved state, and BlockedScripts, with everything as it was before, where the settings ask for that.
    /// `observer` is asked after each stage whether to go on; may be empty. Where it says no, or throws, everything is
    /// as it was before, and CancelledStep is thrown.
    StepReport step(const std::function<bool(Phase)>& observer = {});

    // Changes between steps; arguments are not checked here. The body concerned wakes, with all bodies near it.
    std::int32_t add_shape(RigidShape shape);
    /// Of a shape that no body has which is there.
    void set_shape(std::int32_t shape, RigidShape other);
    /// At the lowest free place; apart from all others.
    std::int32_t add_body(const Body& body, const Pose& pose, const Motion& motion);
    void remove_body(std::int32_t body);
    /// Keeps its velocities. Apart from all others.
    void place_body(std::int32_t body, const Pose& pose);
    void set_motion(std::int32_t body, const Motion& motion);
    void change_body(std::int32_t body, const Body& changed);
    void set_gravity(const Vec3& gravity);
    /// `whose`: of each pair for which it says something else than before, and of which both are there and one may
    /// move, one that does, or else its other; they wake.
    void set_filter(const FilteredBodies& filtered, std::span<const std::int32_t> whose);
    void wake(std::int32_t body);
    /// Rebuilds what follows from the model and the state, where these were changed; step() does so too.
    void refresh();
    /// Of that, the vertices and boxes of trajectories() alone.
    void place_changed();
    /// From now on poses and motions are where `other` had its own, of which it has as many.
    void take_places(Stepper& other) noexcept;
    /// Bodies that were placed since the last step, as flags: part of what a snapshot between edits must hold.
    [[nodiscard]] const std::vector<std::uint8_t>& moved() const { return moved_; }
    void set_moved(std::vector<std::uint8_t> moved);
    /// The place that add_body() would take, maybe the one after the last.
    [[nodiscard]] std::int32_t free_place() const;

    /// Of all edits, for the hashes of states that are reported.
    void set_edits_hash(std::uint64_t hash) { edits_hash_ = hash; }
    /// N and N m on a body, at its centre of mass, in the steps to come.
    void set_force(std::int32_t body, const Vec3& force, const Vec3& torque);

    [[nodiscard]] StepperMemory memory() const;
    [[nodiscard]] double energy() const; ///< J, kinetic and potential, of the dynamic bodies

    [[nodiscard]] const Model& model() const { return model_; }
    [[nodiscard]] const Trajectories& trajectories() const { return trajectories_; }
    /// Steps and time of the settings' time step, whatever it is made of.
    [[nodiscard]] std::int64_t steps() const { return state_.step / substeps_; }
    [[nodiscard]] double time() const { return static_cast<double>(steps()) * time_step_; }
    [[nodiscard]] int substeps() const { return substeps_; }
    [[nodiscard]] const State& state() const { return state_; }
    /// The rotation vector of each body's motion in the last inner step, with whole turns, radians.
    [[nodiscard]] const std::vector<Vec3>& turns() const { return turns_; }
    /// Of the inner steps of the last step but for its last one.
    [[nodiscard]] const std::vector<InnerState>& inner_states() const { return inner_; }
    /// Contact points at the present poses, but for those of sleeping_contacts().
    [[nodiscard]] const ContactSet& contacts() const { return contacts_; }
    /// Those of sleeping bodies with each other and with infinite mass, sorted by bodies.
    [[nodiscard]] const std::vector<Contact>& sleeping_contacts() const { return sleeping_contacts_; }
    /// Cluster state and cost of every body in the last step; contacts are not counted.
    [[nodiscard]] const std::vector<BodyActivity>& activity() const { return activity_; }
    /// Contact updates of sweeps in the last step, stages 3 and 7 together.
    [[nodiscard]] std::int64_t contact_visits() const { return contact_visits_; }
    [[nodiscard]] QueryCounters query_counters() const;
    /// Movable bodies that were near no other when pairs of bodies were last looked for.
    [[nodiscard]] std::size_t lone_bodies() const { return broadphase_.lone_bodies(model_.active); }
    /// Bodies that stand still and fill no cells of a grid.
    [[nodiscard]] const std::vector<std::int32_t>& large_still() const { return broadphase_.grids().large_still(); }
    /// Whether small bodies may look for contacts ahead (look_ahead.hpp), and whether scripts run.
    [[nodiscard]] bool looks_ahead() const { return looks_ahead_; }
    [[nodiscard]] bool has_scripts() const { return has_scripts_; }
    /// How the last inner step proved two bodies apart. Known until something is edited; a pure function of what the
    /// step left, so that it costs nothing where nobody asks.
    [[nodiscard]] ProofWay proved_by(std::int32_t a, std::int32_t b) const;
    [[nodiscard]] Team& team() { return workers_.team; }

  private:
    void size_buffers();
    void prepare();
    void forget_moved_distances();
    bool note_rest_distances();
    void place_anew(std::int32_t body, const Pose& pose);
    void mark_changed(std::int32_t body);
    void wake_neighbours(std::int32_t body);
    void retry_scripts(std::int32_t body);
    void refresh_changed();
    void search_changed();
    void take_woken_contacts();
    void forget_pairs_of(std::int32_t body);
    void place_still();
    void find_sleeping_contacts();
    void measure_strays();
    void note_strays(std::int64_t step);
    void advance(StepReport& report);
    void make_inner_steps(StepReport& report);
    void add_earlier(const WarmImpulses& stages, double times);
    void keep_earlier_of_woken();
    [[nodiscard]] StepView view() const;
    [[nodiscard]] Movers movers() { return {clusters_, trajectories_, model_.settings.time_step}; }
    void wake_disturbed();
    [[nodiscard]] bool hit_sleepers() const;
    bool wake_hit();
    void wake_along(std::span<const std::int32_t> hit, double way);
    [[nodiscard]] double way_in_step(std::size_t body) const;
    void rejoin_woken();
    void mark_asleep();
    void disturb_parted();
    void put_to_sleep();
    void free_memory_of_sleepers();
    void give_back_memory();
    /// Whether neither body moves until something wakes it.
    [[nodiscard]] bool rests(std::int32_t a, std::int32_t b) const {
        return !model_.bodies[static_cast<std::size_t>(a)].movable() &&
               !model_.bodies[static_cast<std::size_t>(b)].movable();
    }
    /// Of the active bodies; the others have the same in both.
    template <class T>
    void copy_active(std::span<const T> from, std::span<T> to) const {
        for (const std::int32_t i : model_.active) to[static_cast<std::size_t>(i)] = from[static_cast<std::size_t>(i)];
    }
    void begin_step(std::int64_t step);
    [[nodiscard]] std::vector<Vec3> centers() const; ///< m, of mass, at x^n
    /// Every body on its own, with the given motion, and evolved to its candidate end state: stage 1 begins so with
    /// v^n, stage 4 is this with v^{n+1/2}.
    void start_trajectories(std::span<const Motion> motion);
    void collisions(std::span<Motion> collided, std::span<Motion> late, StepReport& report);
    void leave_out_late(std::span<const Motion> late, std::span<Motion> half) const;
    void half_velocities(std::span<const Motion> collided, std::span<Motion> half, StepReport& report);
    void set_half_velocities(std::span<const Motion> collided, std::span<Motion> half);
    ContactSet& contacts_at_start();
    void half_static_contact(std::span<const Motion> collided, std::span<Motion> half, std::span<Motion> kept,
                             StepReport& report);
    FailsafeStats move_bodies(std::span<Motion> half, StepReport& report);
    void candidate_end_states(std::span<const Motion> half, StepReport& report);
    DynamicContactStats dynamic_contact(StepReport& report);
    std::span<const std::uint8_t> solve_hits(std::span<const Contact> hits, std::span<const Motion> motion,
                                             std::span<Vec3> impulses);
    void certify_end(std::span<Pose> end, StepReport& report);
    void new_velocities(std::span<const Motion> collided, std::span<const Motion> kept, std::span<const Pose> end,
                        std::span<Motion> next, StepReport& report);
    void final_static_contact(std::span<const Pose> end, std::span<Motion> next, StepReport& report);
    void find_contacts_at_end(StepReport& report);
    void list_known_normals();
    void note_squeezed();
    void note_carried_ahead();
    void give_held_impulses();
    /// Whether a body did not go as its half velocity says: the failsafe acted on it, or slow_down().
    [[nodiscard]] bool moved_otherwise(std::size_t body) const {
        return failsafe_bodies_[body] != 0 || slowed_[body] != 0;
    }
    /// Whether the failsafe acted on a body of the pair in this step.
    [[nodiscard]] bool of_failsafe(const WarmImpulse& w) const {
        return failsafe_bodies_[static_cast<std::size_t>(w.a)] != 0 ||
               failsafe_bodies_[static_cast<std::size_t>(w.b)] != 0;
    }
    /// Of stage 3 for what v^{n+1} keeps of it, which nothing raises to its rest distance; of stage 3; of stage 7.
    void static_contact(ContactSet& contacts, std::span<Motion> motion, std::span<const Pose> poses, ContactStage stage,
                        StepReport& report);
    ContactSolveStats solve_contacts_at(const ContactSet& contacts, std::span<Motion> motion,
                                        std::span<const Pose> poses, ContactStage stage, const StepReport& report);
    [[nodiscard]] KnownImpulses known_impulses(ContactStage stage);
    [[nodiscard]] std::span<const double> bounds_of_raise(std::span<const Contact> contacts);
    void add_script_work(std::span<const Pose> poses);
    void record_failsafe(const DynamicContactStats& dynamic, const FailsafeStats& failsafe, StepReport& report);
    [[nodiscard]] Vec3 within_energy(std::size_t i, const Vec3& before, const Vec3& turned_on) const;
    [[nodiscard]] Vec3 with_energy(std::size_t i, const Vec3& before, const Vec3& momentum) const;
    [[nodiscard]] double load_work(std::size_t i, const Motion& collided, const Pose& end) const;
    void turn_momenta(std::span<const Motion> kept, double accelerated, std::span<Motion> motion);
    void drop_line_spin(std::span<const Pose> end, std::span<Motion> motion) const;
    [[nodiscard]] bool keeps_momentum(const Cluster& c) const;
    [[nodiscard]] Impulses impulses_not_kept(const Cluster& c, std::span<const Motion> from, double accelerated) const;
    void held_velocities(std::span<const Motion> collided, std::span<const Motion> from, double accelerated,
                         std::span<Motion> motion, std::span<const Pose> end, StepReport& report);
    void open_account();
    bool mark_level(std::span<const Motion> half);
    void mark_spent();
    void raise_or_stay(std::span<const Motion> collided, std::span<Motion> half, StepReport& report);
    void raise_as_far_as_paid(std::span<const Motion> kept, std::span<Motion> half);
    void move_as_far_as_paid(std::span<Motion> half);
    std::span<const double> shares_paid();
    bool slow_down(std::span<Motion> half);
    bool leave_unraised(std::size_t i, std::span<Motion> half);
    void mark_unpaid(std::size_t i);
    void hold_overdrawn(FailsafeStats& failsafe);
    void join_pushed();
    void join_contacts();
    void settle_energy(std::span<Motion> motion, std::span<const Pose> end, StepReport& report);
    void observe(Phase phase) const;
    void undo_step();
    void commit(std::span<const Motion> motion, std::span<const Pose> end, const FailsafeStats& failsafe);
    void record_activity();
    void measure(StepReport& report) const;

    Model model_; ///< its own, of an inner step: who sleeps changes from step to step
    int substeps_;
    double time_step_; ///< s, of all inner steps together
    int inner_over_;   ///< inner steps of the step under way that are over; between steps all but the last
    StepperOptions options_;
    Workers workers_;
    State state_;
    struct Before {
        State state;
        std::vector<Vec3> turns;
        std::vector<BodyActivity> activity;
        std::vector<InnerState> inner;
        std::vector<std::uint8_t> moved;
    };
    Before before_;                                        ///< the step under way, where that may have to be undone
    const std::function<bool(Phase)>* observer_ = nullptr; ///< of the step under way
    std::uint64_t edits_hash_ = 0;
    /// What edits changed since the last step: everything, some bodies, or who sleeps.
    bool stale_ = false, woken_ = false;
    std::vector<std::uint8_t> changed_; ///< by body
    bool any_changed_ = false;
    std::vector<std::int32_t> unplaced_; ///< those whose vertices are where they were before
    /// By body: placed since the last step. The rest distances of their pairs are noted again at every rebuild, so that
    /// they do not depend on what was asked between edits.
    std::vector<std::uint8_t> moved_;
    Scripts scripts_;
    bool scripts_stopped_ = false; ///< whether one has less motion than it is due
    bool has_scripts_ = false;
    Trajectories trajectories_;
    Clusters clusters_;
    KeptPairs broadphase_;
    PairBook pairs_{broadphase_}; ///< kept between steps
    /// What one step hands from stage to stage; kept, so that a steady scene allocates nothing.
    struct StepBuffers {
        std::vector<Pose> end;
        std::vector<Motion> collided, late, half, kept, next;
    };
    StepBuffers buffers_;
    bool any_late_ = false; ///< of buffers_.late
    CollisionScratch collisions_;
    /// What a solve of stages 3 and 7 is made of; the last one's, until the next.
    struct StaticBuffers {
        VelocityArrays velocities;
        ContactTargets targets;
        std::vector<Vec3> impulses;       ///< N s, on b, by contact of `targets`
        std::vector<Vec3> carried;        ///< likewise, of the stage before
        std::vector<double> bounds;       ///< N s, of friction where pairs that hold between are raised
        std::vector<Vec3> loads;          ///< N s, on b, by contact: what the kept solve found, where there are bounds
        std::vector<std::int32_t> stored; ///< of `targets`, those whose impulses are kept
        std::vector<WarmImpulse> ahead;   ///< of stage 7's contacts ahead
        LandingLoads landing;
        std::vector<std::vector<SharedLoad>> shared;
        GeometricStiffness stiffness;
        ContactScratch solver;
    };
    StaticBuffers static_;
    /// The same of hits of stage 5.
    struct HitBuffers {
        VelocityArrays velocities;
        ContactScratch solver;
        std::vector<std::uint8_t> hopeless; ///< by body, as flags
    };
    HitBuffers hits_;
    [[nodiscard]] bool solves_together() const { return model_.settings.contact_solver != ContactSolver::pgs; }
    JointSolve joint_{[this](std::span<const Contact> hits, std::span<const Motion> motion, std::span<Vec3> impulses) {
                          return solve_hits(hits, motion, impulses);
                      },
                      {}};
    JointSolve joint_collisions_{joint_.solve, {}};
    std::vector<WarmImpulse> earlier_scratch_;
    SqueezedPairs squeezed_;
    std::int64_t contact_visits_ = 0;
    EnergyAccount energy_;
    std::vector<Vec3> way_;            ///< m, displacements of centres of mass in the step
    std::vector<std::uint8_t> slowed_; ///< by body: whether slow_down() took of its half velocity
    std::vector<std::uint8_t> level_;  ///< see mark_level() and mark_spent(); empty but in stage 3
    std::vector<std::uint8_t> unpaid_; ///< by body: of islands that cannot pay for being raised; empty: of none
    ContactSearchScratch search_;
    /// With contacts at x^n. Stage 1 examined how they move from there, so that stage 7 misses no collision of theirs;
    /// left to a bounce in the next step, what passes a corner or a wire by less than the rest distance would keep the
    /// velocity that stages 3 and 5 do not let it follow, in every step.
    std::vector<std::size_t> places_; ///< scratch of compactions
    std::vector<CandidatePair> start_pairs_;
    ContactSet contacts_;
    std::int64_t contacts_step_ = -1;        ///< the step at whose end they are contacts
    std::vector<PairNormal> known_normals_;  ///< at x^n, of pairs that rebound, for stage 7
    std::vector<Contact> sleeping_contacts_; ///< found when their bodies fell asleep; not searched for again
    bool looks_ahead_ = false;               ///< may_look_ahead()
    LookAheadScratch ahead_;
    std::vector<Motion> before_solve_;
    SleepScratch sleep_;
    std::vector<BodyPair> touching_;
    std::uint64_t placed_version_ = 0; ///< ListBuffers::still_version that place_still() was called for
    /// What stays as long as the same bodies sleep.
    struct Sleepers {
        std::vector<std::int32_t> awake; ///< bodies that do not sleep
        std::int64_t count = 0;
        double energy = 0; ///< J, of gravity
        double lift = 0;   ///< J, written down when they fell asleep
        std::uint64_t hash = 0;
        std::size_t freed = 0;        ///< bytes of bodies that fell asleep since give_back_memory() did something
        std::int64_t freed_step = -1; ///< when the last did
    };
    Sleepers sleepers_;
    std::vector<Vec3> turns_;
    std::vector<InnerState> inner_;
    std::vector<std::uint8_t> failsafe_bodies_; ///< those that a failsafe event of the step touched, as flags
    std::vector<std::uint8_t> disturbed_;       ///< bodies that may not fall asleep
    std::vector<std::uint64_t> first_version_;  ///< of the bodies' end states in this step
    std::int64_t proved_step_ = -1;             ///< the step of which proved_by() knows; -1: of none
    std::vector<BodyActivity> activity_;
};

} // namespace flotilla
