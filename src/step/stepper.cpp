// SPDX-License-Identifier: MIT
#include "step/stepper.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "collision/collisions.hpp"
#include "parallel/division.hpp"
#include "state/loads.hpp"
#include "step/phase_watch.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBodyGrain = 16; // bodies of a task
/// Of stages 4 and 5, see slow_down(): one unraised and four with half of it at most. Three cubes of 0.3 mm, preset
/// accurate, 1/24 s: 82 bodies held in 96 steps with one halving, 75 with two, 1 with three, none with four; 8 without.
constexpr int kMostRetries = 5;
void add_counters(const StageCounters& c, StepReport& report) {
    report.pairs += c.pairs;
    report.ms(Phase::detection) += c.detection_ms;
    report.ms(Phase::response) += c.response_ms;
}

/// What gravity and the bodies' own loads add in dt (stages 2 and 6).
void accelerate(const Model& model, double dt, std::span<Motion> motion) {
    for (const std::int32_t i : model.active) {
        if (!model.bodies[at(i)].movable()) continue;
        motion[at(i)].velocity += dt * acceleration(model, at(i));
        if (model.bodies[at(i)].torque != Vec3{}) motion[at(i)].momentum += dt * turning_torque(model, at(i));
    }
}

/// m, the rest distance that a pair may have which was placed so: no more than its contacts' gaps, and of the play
/// between two across from each other, the sum of their gaps, half on both sides together. The other half is left to
/// move in: an axle in a hole with sides, all round at the rest distance, could not turn by one of them. Across are
/// sides whose normals are within 18 degrees of opposite: a body that rests in a groove takes up what it is given, and
/// would come nearer with every edit.
double room_for_rest(std::span<const Contact> pair) {
    constexpr double kOfPlay = 0.25, kAcross = -0.95; // cosine
    double room = std::numeric_limits<double>::infinity();
    for (const Contact& c : pair) room = std::min(room, c.distance);
    for (std::size_t i = 1; i < pair.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const double share = kOfPlay * (pair[i].distance + pair[k].distance);
            if (share < room && dot(pair[i].normal, pair[k].normal) < kAcross) room = share;
        }
    return room;
}

/// What a step that begins anew has found: nothing, in the time that it took.
StepReport with_times_of(const StepReport& report, StepReport begun) {
    begun.phase_ms = report.phase_ms;
    return begun;
}

} // namespace

Stepper::Stepper(const Model& model, State state, const StepperOptions& options)
    : model_(inner_model(model)),
      substeps_(model.settings.substeps),
      time_step_(model.settings.time_step),
      inner_over_(substeps_ - 1),
      options_(options),
      workers_(options.team),
      state_(std::move(state)),
      scripts_(model_) {
    state_.sleep.resize(model_.size());
    moved_.assign(model_.size(), state_.step == 0 ? 1 : 0);
    size_buffers();
    workers_.team.region([&] { prepare(); });
}

/// What is there for every body, and what depends on who is there.
void Stepper::size_buffers() {
    const std::size_t n = model_.size();
    turns_.resize(n);
    disturbed_.resize(n);
    changed_.resize(n);
    activity_.resize(n);
    scripts_ = Scripts(model_);
    has_scripts_ = scripts_.any() || !options_.savings.scripts;
    looks_ahead_ = may_look_ahead(model_) || !options_.savings.look_ahead;
    contacts_.keeps_near = looks_ahead_;
}

/// Everything that follows from the state.
void Stepper::prepare() {
    proved_step_ = -1;
    forget_moved_distances();
    mark_asleep();
    pairs_.table.clear();
    trajectories_.resize(model_);
    workers_.team.for_each("place bodies", model_.size(), kBodyGrain,
                           [&](std::size_t i, int) { trajectories_.start(model_, i, state_.pose[i]); });
    measure_strays();
    if (state_.step > 0) find_sleeping_contacts();
    find_contacts(view(), pairs_, workers_, {state_.step}, search_, contacts_);
    contacts_step_ = state_.step;
    if (note_rest_distances()) {
        pairs_.table.clear(); // of other lengths
        find_contacts(view(), pairs_, workers_, {state_.step}, search_, contacts_);
    }
    free_memory_of_sleepers();
}

/// Pairs of bodies that were placed without room for their rest distance have what there is room for
/// (src/state/README.md). Returns whether there are any.
bool Stepper::note_rest_distances() {
    auto& list = state_.rest_distances;
    const auto before = static_cast<std::ptrdiff_t>(list.size());
    for (std::size_t i = 0, end = 0; i < contacts_.size(); i = end) {
        const Contact& first = contacts_.contacts[i];
        for (end = i + 1; end < contacts_.size() && !begins_pair(contacts_.contacts, end);) ++end;
        if ((moved_[at(first.a)] | moved_[at(first.b)]) == 0) continue;
        const std::span<const Contact> pair = std::span(contacts_.contacts).subspan(i, end - i);
        const double room = room_for_rest(pair);
        if (room < contacts_.rest[i]) list.push_back({first.a, first.b, room});
    }
    if (std::ssize(list) == before) return false;
    std::inplace_merge(list.begin(), list.begin() + before, list.end(), by_bodies<RestDistance>);
    return true;
}

QueryCounters Stepper::query_counters() const {
    QueryCounters sum;
    for (const Worker& worker : workers_.each) sum += worker.ccd.counters;
    return sum;
}

StepView Stepper::view() const {
    const Settings& s = model_.settings;
    const double approach =
        s.approach_threshold >= 0 ? s.approach_threshold : 0.5 * length(model_.gravity) * s.time_step;
    const double angle_cos = sin_cos(s.proximity_angle * std::numbers::pi / 180).cos;
    return {model_,
            state_,
            trajectories_,
            clusters_,
            pairs_.lists.bounds,
            s.time_step,
            angle_cos,
            approach,
            options_.keep_candidates,
            options_.savings};
}

StepReport Stepper::step(const std::function<bool(Phase)>& observer) {
    refresh();
    StepReport report;
    report.step = steps() + 1;
    report.time = static_cast<double>(report.step) * time_step_;
    observer_ = observer ? &observer : nullptr;
    if (observer || (has_scripts_ && model_.settings.unsatisfiable_script == UnsatisfiableScript::error))
        before_ = {state_, turns_, activity_, inner_, moved_};
    std::fill(moved_.begin(), moved_.end(), std::uint8_t{0});
    contact_visits_ = 0;
    inner_.resize(static_cast<std::size_t>(substeps_) - 1);
    try {
        const Stopwatch total(report.total_ms);
        make_inner_steps(report);
    } catch (const BlockedScripts&) {
        undo_step();
        throw;
    } catch (const CancelledStep&) {
        undo_step();
        throw;
    }
    measure(report);
    return report;
}

void Stepper::undo_step() {
    state_ = before_.state;
    turns_ = before_.turns;
    activity_ = before_.activity;
    inner_ = before_.inner;
    moved_ = before_.moved;
    inner_over_ = substeps_ - 1;
    workers_.team.region([&] { prepare(); });
}

void Stepper::observe(Phase phase) const {
    if (observer_ == nullptr) return;
    bool goes_on = true;
    try {
        goes_on = (*observer_)(phase);
    } catch (...) {
        throw CancelledStep{phase, std::current_exception()};
    }
    if (!goes_on) throw CancelledStep{phase, nullptr};
}

/// One inner step: section 2 of the paper.
void Stepper::advance(StepReport& report) {
    auto& [end, collided, late, half, kept, next] = buffers_;
    FailsafeStats failsafe;
    {
        const RecordedSpan recorded("step", workers_.team);
        begin_step(report.step);
        const StepReport begun = report;
        const std::int64_t begun_visits = contact_visits_;
        for (;; report = with_times_of(report, begun), contact_visits_ = begun_visits) {
            collisions(collided, late, report); // 1) v^n becomes v^
            observe(Phase::collisions);
            half_velocities(collided, half, report);           // 2) v^{n+1/2} = v^ + dt/2 a
            half_static_contact(collided, half, kept, report); // 3) on v^{n+1/2}; its contacts are the last stage 7's
            observe(Phase::half_static_contact);
            leave_out_late(late, half);
            failsafe = move_bodies(half, report); // 4) x^{n+1} from x^n and v^{n+1/2}; 5) free of intersections
            if (!wake_hit()) break;               // or all of it again with what was hit asleep
        }
        observe(Phase::failsafe);
        certify_end(end, report);
        new_velocities(collided, kept, end, next, report); // 6) v^{n+1} = v^{n+1/2} + dt/2 a, or v^ + dt a
        final_static_contact(end, next, report);           // 7) on v^{n+1}, contacts at x^{n+1}
        observe(Phase::static_contact);
    }
    workers_.team.dismiss();
    commit(next, end, failsafe);
    report.min_distance = contacts_.min_distance;
}

void Stepper::begin_step(std::int64_t step) {
    pairs_.table.start_step(workers_.team, step);
    give_back_memory();
    place_still();
    for (const std::int32_t i : model_.active) first_version_[at(i)] = trajectories_.version(at(i));
    for (Worker& worker : workers_.each) worker.pushed.clear();
    if (Division* division = workers_.team.division()) division->begin_step(centers(), model_.active);
}

std::vector<Vec3> Stepper::centers() const {
    std::vector<Vec3> out;
    for (const Pose& pose : state_.pose) out.push_back(pose.com);
    return out;
}

/// Stage 1.
void Stepper::collisions(std::span<Motion> collided, std::span<Motion> late, StepReport& report) {
    const PhaseWatch watch(report, Phase::collisions, workers_.team);
    start_trajectories(state_.motion); // x^n -> x(v^n)
    wake_disturbed();
    JointSolve* joint = solves_together() ? &joint_collisions_ : nullptr;
    const auto handle = [&] {
        const ContactSet& known = contacts_at_start();
        return handle_collisions(view(), movers(), pairs_, workers_,
                                 {known.contacts, known.rest, state_.warm[ContactStage::final]}, joint, collisions_);
    };
    StageCounters c = handle();
    while (wake_hit()) c = handle();
    add_counters(c, report);
    report.collisions = c.impulses;
    if (c.limit) report.warnings |= kCollisionLimit;
    if (c.rebound_lost) report.warnings |= kReboundLost;
    copy_active<Motion>(clusters_.motion(), collided);
    any_late_ = false;
    for (const std::int32_t i : model_.active) {
        late[at(i)] = clusters_[i].late;
        any_late_ = any_late_ || clusters_[i].any_late();
    }
    open_account();
    if (any_late_) energy_.keep_centers(model_, late);
}

/// What came late in the step moves bodies in the next one.
void Stepper::leave_out_late(std::span<const Motion> late, std::span<Motion> half) const {
    if (!any_late_) return;
    for (const std::int32_t i : model_.active) {
        half[at(i)].velocity -= late[at(i)].velocity;
        half[at(i)].momentum -= late[at(i)].momentum;
    }
}

/// Stage 2.
void Stepper::half_velocities(std::span<const Motion> collided, std::span<Motion> half, StepReport& report) {
    const PhaseWatch watch(report, Phase::half_velocity, workers_.team);
    set_half_velocities(collided, half);
}

void Stepper::set_half_velocities(std::span<const Motion> collided, std::span<Motion> half) {
    copy_active<Motion>(collided, half);
    accelerate(model_, 0.5 * model_.settings.time_step, half);
}

/// The end of stage 5: what is certified is committed.
void Stepper::certify_end(std::span<Pose> end, StepReport& report) {
    const PhaseWatch watch(report, Phase::certificate, workers_.team);
    certify(view(), pairs_, workers_.team);
    for (const std::int32_t i : model_.active) end[at(i)] = trajectories_.end_pose(at(i));
}

/// Stage 6. The paper's v^ + dt a leaves all that contact does in the step to stage 7, at its end: what swings or rolls
/// then loses energy at 1/2 w^2 dt, where w is its frequency. With what stage 3 did at the start, less what brought
/// bodies to their rest distance, contact acts half at either end, as gravity does (the velocity Verlet scheme; for
/// constraints RATTLE, Andersen 1983).
void Stepper::new_velocities(std::span<const Motion> collided, std::span<const Motion> kept, std::span<const Pose> end,
                             std::span<Motion> next, StepReport& report) {
    const PhaseWatch watch(report, Phase::velocity, workers_.team);
    const bool trapezoidal = model_.settings.velocity_update == VelocityUpdate::trapezoidal;
    const std::span<const Motion> from = trapezoidal ? kept : collided;
    const double accelerated = trapezoidal ? 0.5 : 0; // of the step
    copy_active<Motion>(from, next);
    accelerate(model_, (1 - accelerated) * model_.settings.time_step, next);
    if (has_scripts_) {
        for (const std::int32_t i : model_.active)
            if (!model_.bodies[at(i)].movable()) next[at(i)] = clusters_.motion()[at(i)];
        scripts_.reach_end(model_, state_, next);
    }
    turn_momenta(from, accelerated, next);
    held_velocities(collided, from, accelerated, next, end, report);
    drop_line_spin(end, next);
}

/// What the stages read of bodies that stand still: once for as long as the same ones do. The stages themselves see
/// active bodies only.
void Stepper::place_still() {
    if (placed_version_ == pairs_.lists.still_version) return;
    placed_version_ = pairs_.lists.still_version;
    const std::size_t n = model_.size();
    auto& [end, collided, late, half, kept, next] = buffers_;
    clusters_.resize(model_);
    end = state_.pose;
    late.assign(n, Motion{});
    collided = half = kept = next = state_.motion;
    first_version_.resize(n);
    way_.resize(n);
    before_solve_.resize(n);
    auto active = model_.active.begin();
    for (std::size_t i = 0; i < n; ++i) {
        if (active != model_.active.end() && at(*active) == i) {
            ++active;
            continue;
        }
        clusters_.start(i, trajectories_, state_.motion[i]);
        turns_[i] = {};
        activity_[i] = {};
        first_version_[i] = trajectories_.version(i);
    }
}

void Stepper::start_trajectories(std::span<const Motion> motion) {
    const std::vector<std::int32_t>& active = model_.active;
    workers_.team.for_each("start clusters", active.size(), kBodyGrain, [&](std::size_t k, int) {
        clusters_.start(at(active[k]), trajectories_, motion[at(active[k])]);
    });
    if (has_scripts_) scripts_.move(model_, state_, trajectories_, clusters_);
    scripts_stopped_ = scripts_.waits();
    workers_.team.for_each("move bodies", active.size(), kBodyGrain, [&](std::size_t k, int) {
        if (model_.bodies[at(active[k])].movable())
            clusters_.evolve(active[k], model_.settings.time_step, trajectories_);
    });
}

/// Stages 4 and 5. What could not go as far as its half velocity says is tried again with less (slow_down).
FailsafeStats Stepper::move_bodies(std::span<Motion> half, StepReport& report) {
    slowed_.assign(model_.size(), 0);
    joint_.left.assign(model_.size(), 0);
    for (int round = 0;; ++round) {
        candidate_end_states(half, report);                          // 4
        const DynamicContactStats dynamic = dynamic_contact(report); // 5: dynamic contact
        if (hit_sleepers()) return {};                               // not with these: wake_hit()
        const PhaseWatch watch(report, Phase::failsafe, workers_.team);
        FailsafeStats failsafe = run_failsafe(view(), movers(), pairs_, workers_); // 5: the failsafe
        add_counters(failsafe.counters, report);
        if (round < kMostRetries && slow_down(half)) continue;
        hold_overdrawn(failsafe);
        record_failsafe(dynamic, failsafe, report);
        if (!failsafe.delayed_scripts.empty() && model_.settings.unsatisfiable_script == UnsatisfiableScript::error)
            throw BlockedScripts(failsafe.delayed_scripts);
        return failsafe;
    }
}

/// Stage 4, equations 3 and 4.
void Stepper::candidate_end_states(std::span<const Motion> half, StepReport& report) {
    const PhaseWatch watch(report, Phase::position, workers_.team);
    start_trajectories(half);
}

DynamicContactStats Stepper::dynamic_contact(StepReport& report) {
    const PhaseWatch watch(report, Phase::dynamic_contact, workers_.team);
    JointSolve* joint = solves_together() ? &joint_ : nullptr;
    const DynamicContactStats stats = handle_dynamic_contact(view(), movers(), pairs_, workers_, joint);
    add_counters(stats.counters, report);
    return stats;
}

void Stepper::record_failsafe(const DynamicContactStats& dynamic, const FailsafeStats& failsafe, StepReport& report) {
    if (dynamic.counters.limit) report.warnings |= kDynamicLimit;
    scripts_stopped_ = !failsafe.delayed_scripts.empty() || scripts_.waits();
    if (scripts_stopped_) report.warnings |= kScriptDelayed;
    report.merges = dynamic.merges + failsafe.merges;
    // What was slowed down lost momentum like what is held.
    report.rung_changes = failsafe.rung_changes + std::count(slowed_.begin(), slowed_.end(), 1);
    report.trigger_a = dynamic.trigger_a >= 0 ? dynamic.trigger_a : failsafe.trigger_a;
    report.trigger_b = dynamic.trigger_a >= 0 ? dynamic.trigger_b : failsafe.trigger_b;
    failsafe_bodies_.assign(model_.size(), 0);
    for (const std::int32_t i : model_.active) {
        const Cluster& c = clusters_[i];
        if (c.members.empty()) continue;
        // A body that the failsafe kept from passing a body of infinite mass stays free, yet its planned velocity would
        // push on.
        if (c.members.size() == 1 && c.rung == Rung::free && c.resolved_against.empty()) continue;
        const auto size = static_cast<std::int64_t>(c.members.size());
        report.largest_cluster = std::max(report.largest_cluster, size);
        if (c.rung == Rung::kinematic) report.kinematic_bodies += size;
        if (c.rung == Rung::rigid) report.rigid_bodies += size;
        if (c.rung == Rung::held) report.held += size;
        for (std::int32_t member : c.members) failsafe_bodies_[static_cast<std::size_t>(member)] = 1;
    }
}

void Stepper::record_activity() {
    static_assert(static_cast<int>(Rung::held) == static_cast<int>(ClusterState::held));
    for (const std::int32_t body : model_.active) {
        const std::size_t i = at(body);
        activity_[i].cluster =
            std::max(activity_[i].cluster, static_cast<ClusterState>(clusters_[clusters_.of(i)].rung));
        activity_[i].cost += static_cast<std::int64_t>(trajectories_.version(i) - first_version_[i]);
    }
}

void Stepper::commit(std::span<const Motion> motion, std::span<const Pose> end, const FailsafeStats& failsafe) {
    if (has_scripts_) scripts_.commit(model_, failsafe, state_);
    for (const std::int32_t i : model_.active) turns_[at(i)] = trajectories_.turn(at(i));
    record_activity();
    for (const std::int32_t i : model_.active) {
        state_.motion[at(i)] = model_.bodies[at(i)].scripted() ? clusters_.motion()[at(i)] : motion[at(i)];
        state_.pose[at(i)] = end[at(i)];
    }
    proved_step_ = ++state_.step;
    state_.time = static_cast<double>(state_.step) * model_.settings.time_step;
    trajectories_.advance(model_.active);
    if (looks_ahead_)
        contacts_.keep([&](std::size_t i) { return contacts_.ahead[i] == 0; }); // the next step searches for its own
    put_to_sleep();
}

void Stepper::measure(StepReport& report) const {
    report.sleeping = sleepers_.count;
    report.energy = sleepers_.energy;
    for (const std::int32_t id : model_.active) {
        const std::size_t i = at(id);
        const Body& body = model_.bodies[i];
        if (!body.dynamic()) continue;
        const Motion& m = state_.motion[i];
        const Vec3 p = body.mass * m.velocity;
        report.momentum += p;
        report.angular_momentum += cross(state_.pose[i].com, p) + m.momentum;
        report.kinetic_energy +=
            0.5 * dot(p, m.velocity) +
            0.5 * dot(m.momentum, angular_velocity(model_, i, state_.pose[i].rotation, m.momentum));
        report.energy -= body.mass * dot(model_.gravity, state_.pose[i].com);
    }
    report.energy += report.kinetic_energy;
    report.state_hash = with_edits(state_hash(state_, sleepers_.awake, sleepers_.hash), edits_hash_);
}

} // namespace flotilla
