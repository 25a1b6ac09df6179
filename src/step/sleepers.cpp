// SPDX-License-Identifier: MIT
// Who sleeps in a step (islands/sleeping.hpp), and what waits with those who do: their contacts and impulses.
#include <algorithm>
#include <iterator>

#include "base/index.hpp"
#include "parallel/heap.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

/// Moves what is wanted of a list sorted by bodies to another one, pair by pair.
template <class T, class Wanted>
void move_if(std::vector<T>& from, std::vector<T>& to, Wanted&& wanted) {
    const auto before = static_cast<std::ptrdiff_t>(to.size());
    std::copy_if(from.begin(), from.end(), std::back_inserter(to), wanted);
    std::erase_if(from, wanted);
    std::inplace_merge(to.begin(), to.begin() + before, to.end(), by_bodies<T>);
}

/// m, between two boxes.
double box_distance(const Box& a, const Box& b) {
    const auto gap = [](double lower, double upper) { return std::max(0.0, lower - upper); };
    const Vec3 d{std::max(gap(a.lower.x, b.upper.x), gap(b.lower.x, a.upper.x)),
                 std::max(gap(a.lower.y, b.upper.y), gap(b.lower.y, a.upper.y)),
                 std::max(gap(a.lower.z, b.upper.z), gap(b.lower.z, a.upper.z))};
    return length(d);
}

} // namespace

/// After State's sleepers changed.
void Stepper::mark_asleep() {
    sleepers_.awake.clear();
    sleepers_.count = 0;
    sleepers_.energy = sleepers_.lift = 0;
    for (std::size_t i = 0; i < model_.size(); ++i) {
        Body& body = model_.bodies[i];
        body.asleep = body.dynamic() && asleep(state_, i);
        if (!body.asleep) {
            sleepers_.awake.push_back(static_cast<std::int32_t>(i));
            continue;
        }
        ++sleepers_.count;
        sleepers_.energy -= body.mass * dot(model_.gravity, state_.pose[i].com);
        sleepers_.lift += state_.lift[i];
    }
    model_.list_active();
    ++pairs_.lists.still_version;
    pairs_.lists.forget_motions(); // sleeping bodies pair by other rules than awake ones
    const auto waits = [&](const WarmImpulse& w) { return rests(w.a, w.b); };
    const auto is_due = [&](const WarmImpulse& w) { return !rests(w.a, w.b); };
    keep_earlier_of_woken();
    for (const auto stage : {ContactStage::kept, ContactStage::half, ContactStage::final}) {
        move_if(state_.waiting[stage], state_.warm[stage], is_due);
        move_if(state_.warm[stage], state_.waiting[stage], waits);
    }
    sleepers_.hash = sleepers_hash(state_);
}

/// Wakes the islands that something moving may come near in this step.
void Stepper::wake_disturbed() {
    if (sleepers_.count == 0) return;
    bool woken = false;
    for (const CandidatePair& p : waking_pairs(view(), pairs_, workers_.team)) {
        const auto sleeps = [&](std::int32_t i) { return asleep(state_, at(i)); };
        if (sleeps(p.a) == sleeps(p.b)) continue;
        const std::int32_t sleeper = sleeps(p.a) ? p.a : p.b, other = sleeps(p.a) ? p.b : p.a;
        if (trajectories_.still(at(other))) continue;
        wake_island(model_, at(sleeper), at(other), state_);
        woken = true;
    }
    pairs_.lists.forget_motions(); // sleeping bodies are in no other list
    if (woken) rejoin_woken();
}

/// Whether this step pushed what sleeps: by bodies that others set in motion, so that wake_disturbed() could not know.
bool Stepper::hit_sleepers() const {
    if (sleepers_.count == 0) return false;
    const auto pushed = [&](const CandidatePair& p) { return asleep(state_, at(p.a)) || asleep(state_, at(p.b)); };
    return std::ranges::any_of(workers_.each,
                               [&](const Worker& worker) { return std::ranges::any_of(worker.pushed, pushed); });
}

/// Wakes the islands that stage 1 or 5 hit. What sleeps takes an impulse as if its mass were infinite, and what should
/// go on with it is lost. Whether there were any: then the step is where it began.
bool Stepper::wake_hit() {
    if (!hit_sleepers()) return false;
    std::vector<std::int32_t> hit; // of an order that no thread decides
    double way = 0;
    for (const Worker& worker : workers_.each)
        for (const CandidatePair& p : worker.pushed)
            for (const std::int32_t body : {p.a, p.b}) {
                if (asleep(state_, at(body)))
                    hit.push_back(body);
                else
                    way = std::max(way, way_in_step(at(body)));
            }
    std::ranges::sort(hit);
    wake_along(hit, way);
    for (Worker& worker : workers_.each) worker.pushed.clear();
    contacts_.keep([&](std::size_t i) { return contacts_.ahead[i] == 0; });
    pairs_.table.restart_step(workers_.team);
    pairs_.lists.forget_motions();
    rejoin_woken();
    return true;
}

/// m, how far points of an awake body may go in the step, at its velocity before or after stage 1.
double Stepper::way_in_step(std::size_t body) const {
    const auto speed = [&](const Motion& m) {
        const Vec3 omega = model_.bodies[body].movable()
                               ? angular_velocity(model_, body, state_.pose[body].rotation, m.momentum)
                               : m.momentum;
        return length(m.velocity) + length(omega) * model_.shape_of(body).radius;
    };
    return model_.settings.time_step * std::max(speed(state_.motion[body]), speed(clusters_.motion()[body]));
}

/// Wakes the islands of some sleepers, and those that these may hit in turn: a blow that comes `way` metres far in the
/// step goes on to what is so near, less each gap that it crosses. One island after the other would take a step anew
/// for each.
void Stepper::wake_along(std::span<const std::int32_t> hit, double way) {
    std::vector<double> left(model_.size(), -1); // m, of the way, by body
    std::vector<std::int32_t> reached;
    std::int64_t asleep_still = sleepers_.count;
    const auto reach = [&](std::size_t body, double rest) {
        const std::int32_t island = state_.sleep[body].island;
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (state_.sleep[i].island != island || left[i] >= rest) continue;
            if (left[i] < 0) --asleep_still;
            left[i] = rest;
            reached.push_back(static_cast<std::int32_t>(i));
        }
    };
    for (const std::int32_t body : hit) reach(at(body), way);
    for (std::size_t k = 0; k < reached.size() && asleep_still > 0; ++k) {
        const std::size_t from = at(reached[k]);
        const Box box = trajectories_.motion(from).swept();
        for (std::size_t i = 0; i < left.size(); ++i) {
            if (!asleep(state_, i) || !(left[from] > left[i])) continue;
            const double rest = left[from] - box_distance(box, trajectories_.motion(i).swept());
            if (rest > left[i] && rest >= 0) reach(i, rest);
        }
    }
    for (const std::int32_t body : reached)
        if (asleep(state_, at(body))) wake_island(at(body), state_);
}

/// After islands woke: the step begins with them awake.
void Stepper::rejoin_woken() {
    mark_asleep();
    take_woken_contacts();
    place_still();
    start_trajectories(state_.motion);
}

/// Bodies that carried each other at the start of the step and do not touch at its end are disturbed: what is left of
/// the step's impulses is not what holds them. Both lists are sorted by bodies. (Where velocities are those of the end,
/// its impulses are all.)
void Stepper::disturb_parted() {
    auto pair = touching_.begin();
    for (const WarmImpulse& w : state_.warm[ContactStage::kept]) {
        if (w.impulse == Vec3{}) continue;
        const BodyPair bodies{w.a, w.b};
        pair = std::lower_bound(pair, touching_.end(), bodies);
        if (pair == touching_.end() || *pair != bodies) disturbed_[at(w.a)] = disturbed_[at(w.b)] = 1;
    }
}

/// Lets islands fall asleep at the end of a step.
void Stepper::put_to_sleep() {
    if (!model_.settings.sleeping) return;
    // Where forces do not carry the weight yet, velocities say nothing.
    for (const std::int32_t i : model_.active)
        disturbed_[at(i)] = moved_otherwise(at(i)) || static_.solver.unsolved[at(i)] != 0 ? 1 : 0;
    touching_.clear();
    for (const Contact& c : contacts_.contacts)
        if (touching_.empty() || touching_.back() != BodyPair{c.a, c.b}) touching_.push_back({c.a, c.b});
    disturb_parted();
    disturb_sliding(model_, contacts_.contacts, state_, sleep_, disturbed_);
    count_quiet_steps(model_, disturbed_, state_);
    if (!fall_asleep(model_, touching_, sleep_, state_)) return;
    mark_asleep();
    free_memory_of_sleepers();
    // Contacts of bodies that sleep now are no longer searched for: those at hand would make the next step depend on
    // more than State. They are kept aside for queries.
    const auto before = static_cast<std::ptrdiff_t>(sleeping_contacts_.size());
    contacts_.keep([&](std::size_t i) {
        const Contact& c = contacts_.contacts[i];
        if (!rests(c.a, c.b)) return true;
        sleeping_contacts_.push_back(c);
        return false;
    });
    std::inplace_merge(sleeping_contacts_.begin(), sleeping_contacts_.begin() + before, sleeping_contacts_.end(),
                       by_bodies<Contact>);
    std::erase_if(contacts_.near, [&](const CandidatePair& c) { return rests(c.a, c.b); });
}

/// Of large scenes most sleeps most of the time: most of what a body takes are its vertices and boxes, and lists that
/// held what is due are mostly empty now.
void Stepper::free_memory_of_sleepers() {
    sleepers_.freed_step = state_.step;
    for (std::size_t i = 0; i < model_.size(); ++i)
        if (model_.bodies[i].asleep) sleepers_.freed += trajectories_.forget_features(i);
    const auto fit = [](auto& list) {
        constexpr std::size_t kSpare = 4; // what takes more than so many times its size was larger once
        if (list.capacity() > kSpare * list.size()) list.shrink_to_fit();
    };
    for (WarmImpulses* stages : {&state_.warm, &state_.waiting})
        for (auto& impulses : *stages) fit(impulses);
    fit(state_.earlier);
    fit(contacts_.contacts);
    fit(sleeping_contacts_);
}

/// Where more has become free than is held, a scene that was awake mostly sleeps: the buffers of its stages go too, and
/// the system gets back what is free. The table forgets a pair in the second step in which nobody asked for it.
void Stepper::give_back_memory() {
    constexpr std::size_t kWorthwhile = std::size_t{16} << 20; // of less the host will have other use
    if (state_.step != sleepers_.freed_step + 1 || sleepers_.freed < std::max(kWorthwhile, trajectories_.memory()))
        return;
    sleepers_.freed = 0;
    static_ = {};
    hits_ = {};
    collisions_ = {};
    search_.parts.clear();
    release_free_memory();
}

/// As the step in which they fell asleep found them: the contact points of a pair depend on its poses alone.
void Stepper::find_sleeping_contacts() {
    sleeping_contacts_.clear();
    if (sleepers_.count == 0) return;
    for (Body& body : model_.bodies) body.asleep = false;
    model_.list_active();
    ++pairs_.lists.still_version;
    ContactSet all;
    find_contacts(view(), pairs_, workers_, {state_.step}, search_, all);
    mark_asleep();
    std::copy_if(all.contacts.begin(), all.contacts.end(), std::back_inserter(sleeping_contacts_),
                 [&](const Contact& c) { return rests(c.a, c.b); });
    pairs_.table.clear(); // of pairs that no step lists
}

} // namespace flotilla
