// SPDX-License-Identifier: MIT
// The step's account of energy (energy_account.hpp), and what slows down or holds islands that it cannot afford.
#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "state/loads.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBodyGrain = 64; // bodies of a task

} // namespace

/// The step's account of energy, after stage 1.
void Stepper::open_account() {
    energy_.start(workers_.team, model_, state_.pose, state_.motion);
    for (const std::int32_t i : model_.active) energy_.add_work(i, clusters_.work(i));
    join_contacts();
    join_pushed();
}

/// Marks the bodies of islands that stage 3 would raise by more than they have. Bodies pressed together closer than
/// their rest distance then stay as near as they are, until they can afford to part. Whether there are any.
bool Stepper::mark_level(std::span<const Motion> half) {
    for (const std::int32_t i : model_.active) way_[at(i)] = model_.settings.time_step * half[at(i)].velocity;
    const std::span<const std::int32_t> bodies = energy_.overdrawn(model_, way_, state_.lift);
    if (bodies.empty()) return false;
    level_.assign(model_.size(), 0);
    for (const std::int32_t body : bodies) level_[at(body)] = 1;
    unpaid_ = level_;
    return true;
}

/// Marks the bodies of islands that have no energy left to be raised with: to ask for it would cost a solve in vain in
/// every step.
void Stepper::mark_spent() {
    level_.clear(); // whatever ended the step before
    const std::span<const std::int32_t> bodies = energy_.spent(model_, options_.tuning.most_of_rest, state_.lift);
    if (bodies.empty()) return;
    level_.assign(model_.size(), 0);
    for (const std::int32_t body : bodies) level_[at(body)] = 1;
    unpaid_ = level_;
}

/// Takes islands that stage 3 would raise by more than they have for it back towards what it found without raising
/// them, as far as they do not pay. Contacts ask for no approach that is faster than either.
void Stepper::raise_as_far_as_paid(std::span<const Motion> kept, std::span<Motion> half) {
    const std::span<const double> shares = energy_.affordable(model_, state_.pose, kept, half, state_.lift);
    for (const std::int32_t id : model_.active) {
        const std::size_t i = at(id);
        if (shares[i] == 1) continue;
        mark_unpaid(i);
        half[i].velocity = kept[i].velocity + shares[i] * (half[i].velocity - kept[i].velocity);
        half[i].momentum = kept[i].momentum + shares[i] * (half[i].momentum - kept[i].momentum);
    }
}

/// What stage 3 leaves undone within its tolerance moves bodies as well, and some of them up. Islands whose energy and
/// lift do not pay for that go as far as these do: at rest, nowhere. Held for it they would lose their impulses with
/// their velocities, and the next step would begin where this one did, for ever.
void Stepper::move_as_far_as_paid(std::span<Motion> half) {
    for (const std::int32_t i : model_.active) way_[at(i)] = model_.settings.time_step * half[at(i)].velocity;
    const std::span<const double> shares = energy_.paid(model_, way_, state_.lift);
    for (const std::int32_t id : model_.active) {
        const std::size_t i = at(id);
        if (shares[i] == 1) continue;
        mark_unpaid(i);
        half[i] = {shares[i] * half[i].velocity, shares[i] * half[i].momentum};
    }
}

/// By body, the share that its island pays for of what stages 3 and 5 raised it by.
std::span<const double> Stepper::shares_paid() {
    join_pushed();
    const std::vector<std::int32_t>& active = model_.active;
    workers_.team.for_each("ways", active.size(), kBodyGrain, [&](std::size_t k, int) {
        const std::size_t i = at(active[k]);
        way_[i] = trajectories_.end_pose(i).com - state_.pose[i].com;
    });
    return energy_.paid(model_, way_, state_.lift);
}

void Stepper::mark_unpaid(std::size_t i) {
    if (unpaid_.empty()) unpaid_.assign(model_.size(), 0);
    unpaid_[i] = 1;
}

/// Slows down what stages 3 and 5 could not move as a whole. Returns whether there is any. These are islands that were
/// raised by more than all their energy, which get half of their half velocities: a body that falls on others in the
/// step pushes them up with all its speed from the start on, and they keep theirs to the end, so that they rise by
/// m g dt v for the m v^2 / 2 that they got. A slower one pushes less, or does not get there yet. Islands that pay for
/// less than half get what they pay for: at rest they stay, since whatever comes too near, however slowly, is pushed to
/// its rest distance at the same cost. And they are bodies that the failsafe held, where no script blocks them: half
/// the displacement is more than none. Before that both are left unraised: in a slot with less play than two rest
/// distances no velocity brings a body to both, and what the solve made of that is wider than the play.
bool Stepper::slow_down(std::span<Motion> half) {
    const std::span<const double> shares = shares_paid();
    bool any = false;
    for (const std::int32_t body : model_.active) {
        const std::size_t i = at(body);
        const bool overdrawn = shares[i] < 1;
        if (!overdrawn && clusters_[clusters_.of(i)].rung != Rung::held) continue;
        if (!leave_unraised(i, half)) {
            if (!overdrawn && energy_.touches_script(body)) continue;
            const double share = std::min(0.5, shares[i]);
            half[i] = {share * half[i].velocity, share * half[i].momentum};
            slowed_[i] = 1;
        }
        any = true;
    }
    return any;
}

/// Gives a body the half velocity that stage 3 found before it raised anything, once in a step, and if that is another
/// one. Whether it is. With `velocity_update: end` there is none.
bool Stepper::leave_unraised(std::size_t i, std::span<Motion> half) {
    if (slowed_[i] != 0 || model_.settings.velocity_update == VelocityUpdate::end) return false;
    Motion unraised = buffers_.kept[i];
    if (any_late_) unraised.velocity -= buffers_.late[i].velocity, unraised.momentum -= buffers_.late[i].momentum;
    if (half[i].velocity == unraised.velocity && half[i].momentum == unraised.momentum) return false;
    half[i] = unraised;
    return true;
}

/// Islands that are raised too far even so stay where they were, and the failsafe goes on around them. Each round holds
/// a body more at least.
void Stepper::hold_overdrawn(FailsafeStats& failsafe) {
    while (true) {
        const std::span<const double> shares = shares_paid();
        bool any = false;
        for (const std::int32_t body : model_.active) {
            if (shares[at(body)] == 1) continue;
            any = true;
            const std::int32_t id = clusters_.of(at(body));
            if (!clusters_[id].infinite()) clusters_.hold(id, trajectories_), ++failsafe.rung_changes;
        }
        if (!any) return;
        const FailsafeStats more = run_failsafe(view(), movers(), pairs_, workers_);
        failsafe.merges += more.merges;
        failsafe.rung_changes += more.rung_changes;
        for (const DelayedScript& script : more.delayed_scripts) { // maybe shortened by an earlier round
            auto& all = failsafe.delayed_scripts;
            const auto known =
                std::find_if(all.begin(), all.end(), [&](const auto& x) { return x.body == script.body; });
            if (known == all.end())
                all.push_back(script);
            else
                known->share *= script.share;
        }
        std::sort(failsafe.delayed_scripts.begin(), failsafe.delayed_scripts.end());
    }
}

/// Bodies that had an impulse in stages 1 and 5, or are of one cluster, are of one island.
void Stepper::join_pushed() {
    for (const Worker& worker : workers_.each)
        for (const CandidatePair& p : worker.pushed) energy_.join(model_, p.a, p.b);
    for (const std::int32_t body : model_.active)
        if (clusters_.of(at(body)) != body) energy_.join(model_, clusters_.of(at(body)), body);
}

/// Bodies in contact are of one island.
void Stepper::join_contacts() {
    const Contact* last = nullptr; // they come pair by pair
    for (const Contact& c : contacts_.contacts) {
        if (last == nullptr || last->a != c.a || last->b != c.b) energy_.join(model_, c.a, c.b);
        last = &c;
    }
}

/// J, of a body's own force and torque in the step.
double Stepper::load_work(std::size_t i, const Motion& collided, const Pose& end) const {
    const Pose& start = state_.pose[i];
    return work_of_loads(model_, i, start.rotation, collided, end.com - start.com, trajectories_.turn(i));
}

/// Work that scripted bodies did by the impulses of the last solve, at `poses`, which the step's end keeps: along the
/// way that they go in the step, as gravity's work is. With the velocity at its end in stage 7 a lift that slows down
/// would pay for less than the rise of what it carries.
void Stepper::add_script_work(std::span<const Pose> poses) {
    if (!has_scripts_) return;
    for (std::size_t k = 0; k < static_.targets.contacts.size(); ++k) {
        const Contact& c = static_.targets.contacts[k];
        for (const std::int32_t body : {c.a, c.b}) {
            if (!model_.bodies[static_cast<std::size_t>(body)].scripted()) continue;
            const Motion& m = clusters_.motion()[static_cast<std::size_t>(body)];
            const Vec3 v =
                m.velocity + cross(m.momentum, point_on(c, body) - poses[static_cast<std::size_t>(body)].com);
            const Vec3 impulse = body == c.a ? static_.impulses[k] : -static_.impulses[k];
            energy_.add_work(body == c.a ? c.b : c.a, dot(impulse, v));
        }
    }
}

/// The account of the step's energy, after stage 7 (energy_account.hpp).
void Stepper::settle_energy(std::span<Motion> motion, std::span<const Pose> end, StepReport& report) {
    join_contacts();
    // What was held or slowed fell less than its momentum says. No motion of the island in itself pays for that.
    for (const std::int32_t i : model_.active)
        if (slowed_[at(i)] != 0 || clusters_[clusters_.of(at(i))].rung == Rung::held) energy_.ground(i);
    add_script_work(end);
    for (const std::int32_t i : model_.active)
        if (model_.bodies[at(i)].movable() && model_.bodies[at(i)].driven())
            energy_.add_loads(i, load_work(at(i), buffers_.collided[at(i)], end[at(i)]));
    const EnergyCorrections made = energy_.settle(workers_.team, model_, end, motion, state_.lift);
    report.energy_corrections = made.islands;
    report.energy_removed = made.removed;
    report.lift = made.lift + sleepers_.lift;
}

} // namespace flotilla
