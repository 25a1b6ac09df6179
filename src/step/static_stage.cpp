// SPDX-License-Identifier: MIT
// Stages 3 and 7: contacts at one set of poses, and the solve that keeps them from approaching (section 4.3).
#include <algorithm>
#include <iterator>
#include <limits>

#include "base/assert.hpp"
#include "base/index.hpp"
#include "step/phase_watch.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

/// Rounds of look_ahead.hpp in stage 3, whose velocities move the bodies: a cube that the first round stops at a corner
/// turns about that in the second solve, and passes others. Three cubes of 0.3 mm at 1/24 s, ten seeds, preset
/// accurate: 633 bodies held in 8 runs and 3 runs at rest with one round, none held and all at rest with two; four give
/// the same.
constexpr int kLooksAhead = 2;

void set_counters(const PruneCounters& c, StepReport& report) {
    report.proximities = c.proximities;
    report.pruned_end_points = c.end_points;
    report.pruned_same_direction = c.same_direction;
    report.pruned_angle = c.angle;
    report.pruned_occluded = c.occluded;
}

/// What the settings say of a solve.
ContactSolveOptions solve_options(const Model& model, const StepperOptions& options) {
    const Settings& s = model.settings;
    ContactSolveOptions solve;
    solve.tuning = options.tuning;
    solve.normal_rows = options.savings.normal_rows;
    solve.iterations = s.static_iterations;
    solve.tolerance = std::numeric_limits<double>::infinity(); // that of the contacts
    solve.warm_start = s.warm_start;
    if (!tolerance_given(s))
        solve.patience = std::max(solve.tuning.patience, s.static_iterations / solve.tuning.patience_share);
    solve.rest_speed = solve.tuning.rest_speed * length(model.gravity) * s.time_step;
    solve.exact = s.contact_solver != ContactSolver::pgs;
    solve.exact_few = s.contact_solver == ContactSolver::exact_few;
    solve.shock = s.shock_propagation;
    // Bodies below do not feel what a pass changes above them. Within the default tolerance what it takes is worse than
    // what it gives: two leaning cards with 5 % less friction than holds them, preset reference, 1/480 s, where the
    // tolerance is below the rounding of a solve, lost a step's gravity in each step, and slid 8.5 mm in 4 s in place
    // of 0.56 m. A swept stack of 20 needs it from that tolerance on, else it leans.
    // In motion levels are others in the next step; their sweeps took a quarter of the time of 1,323 stirred stones.
    solve.shock_in_motion = s.contact_solver == ContactSolver::pgs;
    if (s.static_tolerance < 0 && s.tolerance_share > 0) solve.shock_above = 1 / std::min(1.0, s.tolerance_share);
    solve.tangents = s.tangents;
    solve.seed = s.seed;
    return solve;
}

} // namespace

/// Stage 3. First without raising anything, which is what v^{n+1} keeps of it; then, where that leaves bodies too near,
/// with it, as far as islands can afford it.
void Stepper::half_static_contact(std::span<const Motion> collided, std::span<Motion> half, std::span<Motion> kept,
                                  StepReport& report) {
    const PhaseWatch watch(report, Phase::half_static_contact, workers_.team);
    unpaid_.clear();
    if (model_.settings.velocity_update == VelocityUpdate::end) return raise_or_stay(collided, half, report);
    copy_active<Motion>(half, kept);
    mark_spent();
    static_contact(contacts_at_start(), kept, state_.pose, ContactStage::kept, report);
    add_script_work(state_.pose);
    if (static_.targets.would_raise) {
        static_contact(contacts_at_start(), half, state_.pose, ContactStage::half, report);
        raise_as_far_as_paid(kept, half);
    } else {
        state_.warm[ContactStage::half].clear();
        copy_active<Motion>(kept, half);
    }
    move_as_far_as_paid(half);
    level_.clear();
}

/// The same where nothing of it is kept: islands that cannot afford to be raised are solved once more without.
void Stepper::raise_or_stay(std::span<const Motion> collided, std::span<Motion> half, StepReport& report) {
    const double residual = report.residual;
    const std::uint32_t warnings = report.warnings;
    static_contact(contacts_at_start(), half, state_.pose, ContactStage::half, report);
    if (!mark_level(half)) return;
    set_half_velocities(collided, half);
    report.residual = residual; // what a solve reported that is discarded is forgotten
    report.warnings = warnings;
    static_contact(contacts_at_start(), half, state_.pose, ContactStage::half, report);
    move_as_far_as_paid(half);
    level_.clear();
}

/// No search finds them: they are those that stage 7 of the step before found at its x^{n+1}, without those that were
/// ahead or fell asleep (commit). At the start, and after edits, prepare() and refresh_changed() search for them.
ContactSet& Stepper::contacts_at_start() {
    FLOTILLA_ASSERT(contacts_step_ == state_.step);
    return contacts_;
}

/// Stage 7.
void Stepper::final_static_contact(std::span<const Pose> end, std::span<Motion> next, StepReport& report) {
    const PhaseWatch watch(report, Phase::static_contact, workers_.team);
    find_contacts_at_end(report);
    note_squeezed();
    static_contact(contacts_, next, end, ContactStage::final, report);
    note_carried_ahead();
    give_held_impulses();
    settle_energy(next, end, report);
    report.sleeping_contacts = static_cast<std::int64_t>(sleeping_contacts_.size());
}

/// What contacts ahead carried in stage 7, which no solve goes on from; of bodies that the failsafe acted on for both
/// halves of the step (give_held_impulses).
void Stepper::note_carried_ahead() {
    const bool trapezoidal = model_.settings.velocity_update == VelocityUpdate::trapezoidal;
    std::vector<WarmImpulse>& ahead = static_.ahead;
    ahead.clear();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (contacts_.ahead[i] == 0 || static_.impulses[i] == Vec3{}) continue;
        const Contact& c = contacts_.contacts[i];
        WarmImpulse& w = ahead.emplace_back(WarmImpulse{c.a, c.b, c.feature_key, static_.impulses[i]});
        if (trapezoidal && of_failsafe(w)) w.impulse *= 2;
    }
    if (!ahead.empty()) add_impulses(ahead, 1, state_.earlier, earlier_scratch_);
}

/// What stage 3 gave to bodies that the failsafe acted on went with their velocities (held_velocities): stage 7's half
/// of a step stands for both, for the next one and for who asks.
void Stepper::give_held_impulses() {
    const bool any = std::ranges::find(failsafe_bodies_, 1) != failsafe_bodies_.end();
    if (!any || model_.settings.velocity_update != VelocityUpdate::trapezoidal) return;
    std::vector<WarmImpulse>& kept = state_.warm[ContactStage::kept];
    const std::vector<WarmImpulse>& final = state_.warm[ContactStage::final];
    const auto before = static_cast<std::ptrdiff_t>(kept.size());
    std::ranges::copy_if(final, std::back_inserter(kept), [&](const WarmImpulse& w) { return of_failsafe(w); });
    std::inplace_merge(kept.begin(), kept.begin() + before, kept.end(), by_bodies<WarmImpulse>);
}

/// They are what stage 3 of the next step starts with.
void Stepper::find_contacts_at_end(StepReport& report) {
    const PhaseWatch detection(report, Phase::static_detection, workers_.team);
    note_strays(report.step);
    contacts_.list_pairs(workers_.team, places_, start_pairs_);
    list_known_normals();
    find_contacts(view(), pairs_, workers_, {report.step}, search_, contacts_);
    contacts_step_ = report.step;
    contacts_.mark_processed(workers_.team, start_pairs_);
    set_counters(contacts_.counters, report);
}

/// Of the contacts at x^n.
void Stepper::list_known_normals() {
    known_normals_.clear();
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        const Contact& c = contacts_.contacts[i];
        if (contacts_.ahead[i] == 0 && pair_restitution(model_, c.a, c.b) > 0)
            known_normals_.push_back({c.a, c.b, c.normal});
    }
}

/// Pairs that have no room, from here on. Islands that cannot pay for it were not asked to part. What a script squeezes
/// is asked always: that has an end, and what pairs lack then comes back at its expense.
void Stepper::note_squeezed() {
    const auto still = [&](std::int32_t a, std::int32_t b) { return rests(a, b); };
    const auto may_ask = [&](std::int32_t i) {
        if (!model_.bodies[at(i)].movable()) return true;
        return (unpaid_.empty() || unpaid_[at(i)] == 0) && !energy_.touches_script(i);
    };
    const auto asked = [&](std::int32_t a, std::int32_t b) { return may_ask(a) && may_ask(b); };
    squeezed_.update(workers_.team, contacts_, options_.tuning, still, asked, state_.squeezed);
}

void Stepper::static_contact(ContactSet& contacts, std::span<Motion> motion, std::span<const Pose> poses,
                             ContactStage stage, StepReport& report) {
    const PhaseWatch watch(report, Phase::static_response, workers_.team);
    const bool final_stage = stage == ContactStage::final;
    if (looks_ahead_) copy_active<Motion>(motion, before_solve_);
    ContactSolveStats stats = solve_contacts_at(contacts, motion, poses, stage, report);
    report.iterations += stats.iterations;
    const StepEnd at = final_stage ? StepEnd::end : StepEnd::start;
    const int rounds = !looks_ahead_ ? 0 : final_stage ? 1 : kLooksAhead;
    for (int k = 0;
         k < rounds && add_contacts_ahead(view(), pairs_.table, workers_, {at, static_.velocities}, ahead_, contacts);
         ++k) {
        if (!final_stage) join_contacts();
        copy_active<Motion>(before_solve_, motion);
        stats = solve_contacts_at(contacts, motion, poses, stage, report);
        report.iterations += stats.iterations;
    }
    report.residual = std::max(report.residual, stats.residual);
    if (final_stage) report.contacts = static_cast<std::int64_t>(contacts.size());
    if (stats.unsolved_islands > 0) report.warnings |= kStaticLimit;
}

/// Each solve begins with what it found itself a step ago. Where the kept one began with what raised bodies in the step
/// before, some of that stayed in their velocities: piles at rest took a third more sweeps (102 boats, six seeds), at
/// several times the energy.
KnownImpulses Stepper::known_impulses(ContactStage stage) {
    const bool trapezoidal = model_.settings.velocity_update == VelocityUpdate::trapezoidal;
    // Stage 3 carries half a step's gravity; stage 7 the other half, or a whole one's.
    const double of_half = trapezoidal ? 1 : 2;
    const ContactStage first = trapezoidal ? ContactStage::kept : ContactStage::half;
    if (stage == ContactStage::final) return {state_.warm[stage], state_.warm[first], of_half};
    if (stage == first) return {state_.warm[stage], state_.warm[ContactStage::final], 1 / of_half};
    return {state_.warm[stage], state_.warm[first]};
}

/// Friction of what raises bodies, of pairs whose contacts oppose each other: that of the loads that the kept solve
/// found. A cone that a cone holds at walls steeper than the angle of friction is raised by no impulses whose friction
/// grows with them: they lock it, and the solve has no solution. Empty: there are no such pairs. Of what a script
/// touches all impulses count: it squeezes what is there.
std::span<const double> Stepper::bounds_of_raise(std::span<const Contact> contacts) {
    std::vector<double>& bounds = static_.bounds;
    if (model_.settings.tangents == Tangents::random) return bounds;
    const auto with_script = [&](std::int32_t body) {
        return model_.bodies[at(body)].movable() ? energy_.touches_script(body) : model_.bodies[at(body)].scripted();
    };
    if (has_scripts_) energy_.find_scripted(model_);
    for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
        const Contact& c = contacts[first];
        while (end < contacts.size() && contacts[end].a == c.a && contacts[end].b == c.b) ++end;
        if (!holds_between(contacts.subspan(first, end - first))) continue;
        if (has_scripts_ && (with_script(c.a) || with_script(c.b))) continue;
        if (bounds.empty()) {
            load_warm(&workers_.team, contacts, {state_.warm[ContactStage::kept], {}, 0}, static_.loads);
            bounds.assign(contacts.size(), -1);
        }
        for (std::size_t i = first; i < end; ++i)
            bounds[i] = contacts[i].friction * std::max(0.0, dot(static_.loads[i], contacts[i].normal));
    }
    return bounds;
}

/// Targets, equation 16; the warm start; the solve, equations 15 to 22; and the impulses stored for the next step.
ContactSolveStats Stepper::solve_contacts_at(const ContactSet& contacts, std::span<Motion> motion,
                                             std::span<const Pose> poses, ContactStage stage,
                                             const StepReport& report) {
    const bool final_stage = stage == ContactStage::final;
    auto& [velocities, targets, impulses, carried, bounds, loads, stored, ahead, landing, shared, stiffness, solver] =
        static_;
    stiffness.relax(velocities);
    velocities.load(&workers_.team, model_, pairs_.lists.still_version, poses, motion);
    velocities.set_rest_speeds(&workers_.team, model_, options_.tuning);
    // Stage 7 leaves pairs that stage 1 did not process to their bounce in the next step (section 2). Where stage 1
    // ended by its limit it did not examine all, and may not do so in the next step: bodies that stages 3 and 5 hold up
    // would accelerate for ever.
    const bool keep_approach = final_stage && (report.warnings & kCollisionLimit) == 0;
    const double accelerated = final_stage && model_.settings.velocity_update == VelocityUpdate::end ? 1 : 0.5;
    velocities.set_unloaded(&workers_.team, model_, accelerated * model_.settings.time_step);
    load_warm(&workers_.team, contacts.contacts, known_impulses(stage), impulses);
    const bool kept = model_.settings.velocity_update == VelocityUpdate::trapezoidal;
    const ContactStage before = !final_stage ? ContactStage::final : kept ? ContactStage::kept : ContactStage::half;
    load_warm(&workers_.team, contacts.contacts, {state_.warm[before], {}, 0}, carried);
    const bool raises = kept && stage == ContactStage::half;
    set_targets(&workers_.team, model_, contacts, velocities,
                {final_stage, keep_approach,
                 final_stage ? std::span<const PairNormal>(known_normals_) : std::span<const PairNormal>(), state_.pose,
                 poses, state_.motion, level_, stage == ContactStage::kept, state_.squeezed, state_.rest_distances,
                 final_stage || !any_late_ ? std::span<const Motion>() : std::span<const Motion>(buffers_.late),
                 scripts_stopped_ ? scripts_.due_motion() : std::span<const Motion>(), raises, impulses, carried,
                 accelerated * model_.settings.time_step, options_.tuning},
                targets);
    ContactSolveOptions options = solve_options(model_, options_);
    bounds.clear();
    if (raises) options.bounds = bounds_of_raise(targets.contacts);
    if (!options.bounds.empty())
        std::ranges::copy(loads, impulses.begin()); // within them, and near what is to be found
    give_landing_loads(model_, targets, accelerated * model_.settings.time_step, impulses, velocities, landing);
    if (model_.settings.warm_start && model_.settings.tangents != Tangents::random)
        even_loads(&workers_.team, targets.contacts, options.bounds, impulses, shared);
    options.team = &workers_.team;
    options.step = 2 * static_cast<std::uint64_t>(report.step) + (final_stage ? 1 : 0);
    options.presses = targets.presses;
    const double carries = final_stage || kept ? 0.5 : 1; // of the step, what the stage before carried
    stiffness.stiffen(&workers_.team, model_, targets.contacts, carried, carries * model_.settings.time_step,
                      velocities);
    const ContactSolveStats stats = solve_contacts(targets.contacts, velocities.bodies(), options, impulses, solver);
    add_landing_loads(landing, impulses);
    velocities.store(&workers_.team, model_, motion);
    stiffness.relax(velocities);
    // The impulses of stage 7 in State are those of the contacts at its poses, whose features the next step may reuse.
    const std::span<const std::uint8_t> left_out =
        final_stage ? std::span<const std::uint8_t>(contacts.ahead) : std::span<const std::uint8_t>();
    store_warm(&workers_.team, {targets.contacts, impulses, left_out}, stored, state_.warm[stage]);
    contact_visits_ += stats.visits;
    return stats;
}

/// Hits of stage 5, all that are met so far. The exact solver is what they are here for.
std::span<const std::uint8_t> Stepper::solve_hits(std::span<const Contact> hits, std::span<const Motion> motion,
                                                  std::span<Vec3> impulses) {
    hits_.velocities.load(&workers_.team, model_, pairs_.lists.still_version, state_.pose, motion);
    hits_.velocities.set_rest_speeds(&workers_.team, model_, options_.tuning);
    ContactSolveOptions options = solve_options(model_, options_);
    options.warm_start = options.exact = true;
    options.exact_few = options.shock = false;
    options.team = &workers_.team;
    options.step = 2 * static_cast<std::uint64_t>(state_.step);
    (void)solve_contacts(hits, hits_.velocities.bodies(), options, impulses, hits_.solver);
    constexpr double kNear = 16; // tolerances
    const ContactScratch& s = hits_.solver;
    hits_.hopeless.assign(model_.size(), 0);
    for (const ContactScratch::Island& island : s.islands)
        if (island.residual > kNear * island.tolerance)
            for (std::int32_t k = island.first_body; k < island.end_body; ++k)
                hits_.hopeless[at(s.bodies[at(s.island_bodies[at(k)])])] = 1;
    return hits_.hopeless;
}

} // namespace flotilla
