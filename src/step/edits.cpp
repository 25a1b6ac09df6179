// SPDX-License-Identifier: MIT
// Changes between steps: each leaves a State and a Model that are whole, and what follows from them is made anew before
// the next step.
#include <algorithm>
#include <tuple>
#include <utility>

#include "base/index.hpp"
#include "state/build_model.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

/// Of pairs that a body is part of.
template <class T>
void erase_of(std::vector<T>& list, std::int32_t body) {
    std::erase_if(list, [&](const T& x) { return x.a == body || x.b == body; });
}

} // namespace

std::int32_t Stepper::add_shape(RigidShape shape) {
    model_.shapes.push_back(std::move(shape));
    return static_cast<std::int32_t>(model_.shapes.size() - 1);
}

/// Places of removed bodies keep the number of their last shape, and lie there as it is now.
void Stepper::set_shape(std::int32_t shape, RigidShape other) {
    model_.shapes[at(shape)] = std::move(other);
    for (std::size_t i = 0; i < model_.size(); ++i) {
        if (model_.bodies[i].shape != shape) continue;
        model_.bodies[i] = absent_body(model_, shape);
        unplaced_.push_back(static_cast<std::int32_t>(i));
        changed_[i] = 1;
        any_changed_ = true;
    }
}

std::int32_t Stepper::free_place() const {
    const auto& bodies = model_.bodies;
    const auto free = std::find_if(bodies.begin(), bodies.end(), [](const Body& b) { return !b.present; });
    return static_cast<std::int32_t>(free - bodies.begin());
}

std::int32_t Stepper::add_body(const Body& body, const Pose& pose, const Motion& motion) {
    const std::int32_t place = free_place();
    const std::size_t i = at(place);
    if (i == model_.size()) {
        model_.bodies.emplace_back();
        state_.pose.emplace_back();
        state_.motion.emplace_back();
        state_.sleep.emplace_back();
        state_.script_clock.emplace_back();
        state_.lift.emplace_back();
        if (!state_.searched.empty()) state_.searched.emplace_back();
        moved_.resize(model_.size());
        changed_.resize(model_.size());
    }
    model_.bodies[i] = body;
    state_.motion[i] = motion;
    place_anew(place, pose);
    return place;
}

void Stepper::take_places(Stepper& other) noexcept {
    std::copy(state_.pose.begin(), state_.pose.end(), other.state_.pose.begin());
    std::copy(state_.motion.begin(), state_.motion.end(), other.state_.motion.begin());
    state_.pose.swap(other.state_.pose);
    state_.motion.swap(other.state_.motion);
}

void Stepper::remove_body(std::int32_t body) {
    wake_neighbours(body);
    retry_scripts(body);
    forget_pairs_of(body);
    mark_changed(body);
    model_.bodies[at(body)] = absent_body(model_, model_.bodies[at(body)].shape);
    state_.motion[at(body)] = {};
    state_.sleep[at(body)] = {};
    state_.script_clock[at(body)] = {};
    state_.lift[at(body)] = 0;
}

void Stepper::place_body(std::int32_t body, const Pose& pose) {
    wake_neighbours(body);
    retry_scripts(body);
    const std::size_t i = at(body);
    if (model_.bodies[i].dynamic()) { // it goes on turning as it does
        const Vec3 omega = angular_velocity(model_, i, state_.pose[i].rotation, state_.motion[i].momentum);
        state_.motion[i] = make_motion(model_, i, pose.rotation, state_.motion[i].velocity, omega);
        model_.bodies[i].first_rotation = pose.rotation;
    }
    forget_pairs_of(body);
    place_anew(body, pose);
}

/// Nothing is known of a body there; who is near has another neighbour now.
void Stepper::place_anew(std::int32_t body, const Pose& pose) {
    const std::size_t i = at(body);
    state_.pose[i] = pose;
    state_.sleep[i] = {};
    state_.script_clock[i] = {};
    state_.lift[i] = 0;
    if (!state_.searched.empty()) state_.searched[i] = {pose, state_.step};
    moved_[i] = 1;
    unplaced_.push_back(body);
    mark_changed(body);
    wake_neighbours(body);
}

/// Its pairs are to be made anew. Lists of a step leave sleeping bodies out, so for a body that does not move and may
/// touch one everything is.
void Stepper::mark_changed(std::int32_t body) {
    changed_[at(body)] = 1;
    any_changed_ = true;
    if (!model_.bodies[at(body)].dynamic()) stale_ = true;
}

void Stepper::set_motion(std::int32_t body, const Motion& motion) {
    wake(body);
    state_.motion[at(body)] = motion;
}

void Stepper::change_body(std::int32_t body, const Body& changed) {
    wake_neighbours(body);
    mark_changed(body); // as it was
    Body& own = model_.bodies[at(body)];
    if (own.type != changed.type) { // the lengths of its pairs are others, and so is what they are near for
        moved_[at(body)] = 1;
        state_.lift[at(body)] = 0;
    }
    retry_scripts(body);
    own = changed;
    mark_changed(body); // and as it is
    state_.script_clock[at(body)] = {};
}

void Stepper::set_force(std::int32_t body, const Vec3& force, const Vec3& torque) {
    model_.bodies[at(body)].force = force;
    model_.bodies[at(body)].torque = torque;
    if (looks_ahead_)
        any_changed_ = true; // how far loads reach says who is near
    else if (may_look_ahead(model_, at(body)))
        stale_ = true;
}

double Stepper::energy() const {
    double energy = 0;
    for (std::size_t i = 0; i < model_.size(); ++i) {
        const Body& body = model_.bodies[i];
        if (!body.dynamic()) continue;
        const Motion& m = state_.motion[i];
        energy += 0.5 * (body.mass * length_sq(m.velocity) +
                         dot(m.momentum, angular_velocity(model_, i, state_.pose[i].rotation, m.momentum))) -
                  body.mass * dot(model_.gravity, state_.pose[i].com);
    }
    return energy;
}

StepperMemory Stepper::memory() const {
    StepperMemory out;
    const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
    out.bodies = trajectories_.memory() + bytes(state_.pose) + bytes(state_.motion) + bytes(model_.bodies);
    out.contacts = bytes(contacts_.contacts) + bytes(sleeping_contacts_) + bytes(state_.earlier);
    for (const WarmImpulses* stages : {&state_.warm, &state_.waiting})
        for (const auto& impulses : *stages) out.contacts += bytes(impulses);
    out.pairs = pairs_.table.memory();
    return out;
}

void Stepper::set_gravity(const Vec3& gravity) {
    if (model_.gravity == gravity) return;
    model_.gravity = gravity;
    std::fill(state_.sleep.begin(), state_.sleep.end(), Sleep{});
    stale_ = true;
}

void Stepper::set_filter(const FilteredBodies& filtered, std::span<const std::int32_t> whose) {
    model_.filter = filtered.filter;
    for (std::size_t i = 0; i < model_.size(); ++i) model_.bodies[i].group = filtered.group[i];
    for (const std::int32_t body : whose) {
        retry_scripts(body);
        mark_changed(body);
        if (model_.bodies[at(body)].dynamic())
            wake(body);
        else
            wake_neighbours(body);
    }
}

/// Scripts that pressed on the body in the last step, or on what it was pressed by, and so on: what stopped them may be
/// gone. They try again at their speed, and wait only if something stops them once more.
void Stepper::retry_scripts(std::int32_t body) {
    const auto waits = [](const ScriptClock& clock) { return clock.stops > 0; };
    if (std::ranges::none_of(state_.script_clock, waits)) return;
    std::vector<std::uint8_t> near(model_.size(), 0);
    near[at(body)] = 1;
    for (bool more = true; more;) {
        more = false;
        for (const WarmImpulses* stages : {&state_.warm, &state_.waiting})
            for (const WarmImpulse& w : (*stages)[ContactStage::final]) {
                if (near[at(w.a)] == near[at(w.b)]) continue;
                const std::int32_t from = near[at(w.a)] != 0 ? w.a : w.b, to = from == w.a ? w.b : w.a;
                if (from != body && !model_.bodies[at(from)].dynamic()) continue;
                near[at(to)] = 1;
                more = true;
            }
    }
    for (std::size_t i = 0; i < near.size(); ++i)
        if (near[i] != 0) state_.script_clock[i].stops = 0;
}

void Stepper::wake(std::int32_t body) {
    state_.sleep[at(body)].quiet_steps = 0;
    if (!asleep(state_, at(body))) return;
    wake_island(at(body), state_);
    woken_ = true;
}

/// The body's island and those of all bodies near it: what it held up may fall. By where bodies are, and not by
/// contacts, since which of these are known depends on what was asked.
void Stepper::wake_neighbours(std::int32_t body) {
    wake(body);
    place_changed();
    const auto box = [&](std::size_t i) -> const Box& { return trajectories_.start_box(i); };
    const double reach = body_lengths(model_, at(body)).proximity;
    for (std::size_t i = 0; i < model_.size(); ++i) {
        if (!model_.bodies[i].dynamic() || i == at(body)) continue;
        if (boxes_overlap(box(at(body)), box(i), std::max(reach, body_lengths(model_, i).proximity)))
            wake(static_cast<std::int32_t>(i));
    }
}

/// Vertices and boxes of bodies that came or were placed.
void Stepper::place_changed() {
    if (unplaced_.empty()) return;
    trajectories_.grow(model_);
    for (const std::int32_t body : unplaced_) trajectories_.place(model_, at(body), state_.pose[at(body)]);
    unplaced_.clear();
}

void Stepper::forget_pairs_of(std::int32_t body) {
    erase_of(state_.rest_distances, body);
    erase_of(state_.squeezed, body);
    for (WarmImpulses* stages : {&state_.warm, &state_.waiting})
        for (auto& impulses : *stages) erase_of(impulses, body);
    erase_of(state_.earlier, body);
    erase_of(sleeping_contacts_, body);
    contacts_.keep([&](std::size_t i) { return contacts_.contacts[i].a != body && contacts_.contacts[i].b != body; });
}

void Stepper::set_moved(std::vector<std::uint8_t> moved) {
    moved_ = std::move(moved);
    stale_ = std::find(moved_.begin(), moved_.end(), 1) != moved_.end();
}

/// Rest distances are noted anew (note_rest_distances()), and squeezed pairs as steps find them.
void Stepper::forget_moved_distances() {
    const auto moved = [&](const auto& pair) { return (moved_[at(pair.a)] | moved_[at(pair.b)]) != 0; };
    std::erase_if(state_.rest_distances, moved);
    std::erase_if(state_.squeezed, moved);
}

void Stepper::refresh() {
    if (!stale_ && !woken_ && !any_changed_) return;
    size_buffers();
    for (std::size_t i = 0; i < moved_.size(); ++i) changed_[i] |= moved_[i];
    inner_.clear();
    if (stale_) {
        broadphase_ = {};
        const std::uint64_t version = pairs_.lists.still_version; // versions are never used again
        pairs_.lists = {};
        pairs_.lists.still_version = version + 1;
        workers_.team.region([&] { prepare(); });
    } else {
        workers_.team.region([&] { refresh_changed(); });
    }
    unplaced_.clear();
    stale_ = woken_ = any_changed_ = false;
    std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
}

/// What prepare() makes, where all is known but of some dynamic bodies, and of others that woke.
void Stepper::refresh_changed() {
    proved_step_ = -1;
    place_changed();
    forget_moved_distances();
    pairs_.table.forget(changed_);
    mark_asleep();
    take_woken_contacts();
    if (model_.settings.contact_reuse != 0) {
        search_.stray.resize(model_.size());
        for (std::size_t i = 0; i < changed_.size(); ++i)
            if (changed_[i] != 0) search_.stray[i] = 0; // searched for where it is
    }
    search_changed();
    if (!note_rest_distances()) return;
    pairs_.table.forget(changed_); // of other lengths
    search_changed();
}

/// The contacts of changed bodies, in their places between all others.
void Stepper::search_changed() {
    const auto is_changed = [&](std::int32_t i) { return changed_[at(i)] != 0; };
    contacts_.keep(
        [&](std::size_t i) { return !is_changed(contacts_.contacts[i].a) && !is_changed(contacts_.contacts[i].b); });
    const auto wanted = [&](const CandidatePair& p) { return is_changed(p.a) || is_changed(p.b); };
    ContactSet found;
    found.keeps_near = contacts_.keeps_near;
    find_contacts(view(), pairs_, workers_, {state_.step, wanted}, search_, found);
    contacts_.near = std::move(found.near);
    contacts_.merge(found);
}

/// Those of pairs that rest no longer: as a search finds them, for nobody moved.
void Stepper::take_woken_contacts() {
    ContactSet woken;
    std::erase_if(sleeping_contacts_, [&](const Contact& c) {
        if (rests(c.a, c.b)) return false;
        woken.add(c, pair_lengths(model_, state_, c.a, c.b).rest, false, false);
        return true;
    });
    contacts_.merge(woken);
}

} // namespace flotilla
