// SPDX-License-Identifier: MIT
// Who sleeps in a step (islands/sleeping.hpp), and the contacts of those who do.
#include <algorithm>
#include <iterator>
#include <tuple>

#include "step/stepper.hpp"

namespace flotilla {

/// Wakes the islands that something moving may come near in this step.
void Stepper::wake_disturbed(StepData& d) {
    const auto sleeps = [&](std::int32_t i) { return asleep(state_, static_cast<std::size_t>(i)); };
    bool woken = false;
    if (std::none_of(state_.sleep.begin(), state_.sleep.end(), [](const Sleep& s) { return s.island >= 0; })) return;
    for (std::size_t i = 0; i < model_.size();
         ++i) // a scripted body pairs with no sleeping one unless that counts as movable
        model_.bodies[i].asleep = false;
    for (const CandidatePair& p : swept_pairs(d, true)) {
        if (sleeps(p.a) == sleeps(p.b)) continue;
        const std::int32_t sleeper = sleeps(p.a) ? p.a : p.b, other = sleeps(p.a) ? p.b : p.a;
        if (trajectories_.still(static_cast<std::size_t>(other))) continue;
        wake_island(static_cast<std::size_t>(sleeper), state_);
        woken = true;
    }
    mark_asleep();
    if (!woken) return;
    std::erase_if(sleeping_contacts_, [&](const Contact& c) { return !rests(c.a, c.b); });
    start_clusters(state_.motion);
}

/// Lets islands fall asleep at the end of a step.
void Stepper::put_to_sleep() {
    if (!model_.settings.sleeping) return;
    const SleepRule rule = sleep_rule(model_);
    // Where forces do not carry the weight yet, velocities say nothing.
    for (std::size_t i = 0; i < model_.size(); ++i)
        disturbed_[i] = failsafe_bodies_[i] != 0 || static_.solver.unsolved[i] != 0 ? 1 : 0;
    count_quiet_steps(model_, rule, disturbed_, state_);
    touching_.clear();
    for (const Contact& c : contacts_.contacts)
        if (touching_.empty() || touching_.back() != BodyPair{c.a, c.b}) touching_.push_back({c.a, c.b});
    fall_asleep(model_, rule, touching_, sleep_, state_);
    mark_asleep();
    // Contacts of bodies that sleep now are no longer searched for: those at hand would make the next step depend on more than State.
    // They are put aside, for who asks.
    const auto before = static_cast<std::ptrdiff_t>(sleeping_contacts_.size());
    contacts_.keep([&](std::size_t i) {
        const Contact& c = contacts_.contacts[i];
        if (!rests(c.a, c.b)) return true;
        sleeping_contacts_.push_back(c);
        return false;
    });
    std::inplace_merge(sleeping_contacts_.begin(), sleeping_contacts_.begin() + before, sleeping_contacts_.end(),
                       [](const Contact& x, const Contact& y) { return std::tuple(x.a, x.b) < std::tuple(y.a, y.b); });
    std::erase_if(contacts_.near, [&](const CandidatePair& c) { return rests(c.a, c.b); });
}

/// As the step found them in which they fell asleep: the points of a pair go by its poses alone.
void Stepper::find_sleeping_contacts(StepData& d) {
    sleeping_contacts_.clear();
    const auto sleeps = [](const Body& body) { return body.asleep; };
    if (std::none_of(model_.bodies.begin(), model_.bodies.end(), sleeps)) return;
    for (Body& body : model_.bodies) body.asleep = false;
    ContactSet all;
    find_contacts(d, search_, all);
    mark_asleep();
    std::copy_if(all.contacts.begin(), all.contacts.end(), std::back_inserter(sleeping_contacts_),
                 [&](const Contact& c) { return rests(c.a, c.b); });
    pairs_.clear(); // of pairs that steps know nothing of
}

} // namespace flotilla
