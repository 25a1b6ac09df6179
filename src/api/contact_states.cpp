// SPDX-License-Identifier: MIT
#include "api/contact_states.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <utility>

#include "base/index.hpp"
#include "pair/impulses.hpp"
#include "proximity/contact_set.hpp"
#include "proximity/feature_points.hpp"
#include "static_contact/thin_bodies.hpp"
#include "static_contact/warm_impulses.hpp"

namespace flotilla {
namespace {

template <class T>
std::pair<std::int32_t, std::int32_t> bodies(const T& x) {
    return {x.a, x.b};
}

/// The impulses of one solve, sorted by bodies; pairs are asked for in that order.
class ImpulsesByPair {
  public:
    explicit ImpulsesByPair(std::span<const WarmImpulse> list) : left_(list) {}

    std::span<const WarmImpulse> of(const std::pair<std::int32_t, std::int32_t>& pair) {
        const auto first =
            std::find_if(left_.begin(), left_.end(), [&](const WarmImpulse& w) { return bodies(w) >= pair; });
        const auto end = std::find_if_not(first, left_.end(), [&](const WarmImpulse& w) { return bodies(w) == pair; });
        left_ = {end, left_.end()};
        return {first, end};
    }

  private:
    std::span<const WarmImpulse> left_;
};

/// Without an impulse.
ContactState state_of(const Contact& c, bool asleep) {
    return {c.a, c.b, c.point, c.normal, c.distance, {}, asleep, c.across};
}

/// What contacts of the step carried that are none any more at its end, as one that rolls has them, goes to those of
/// the pair that carry at its end, by their share: the force between the bodies is whole.
void share(const Vec3& impulse, std::span<ContactState> pair) {
    if (impulse == Vec3{}) return;
    double sum = 0;
    const auto load = [](const ContactState& c) { return std::max(0.0, dot(c.normal, c.impulse)); };
    for (const ContactState& c : pair) sum += load(c);
    for (ContactState& c : pair) {
        const double part = sum > 0 ? load(c) / sum : 1 / static_cast<double>(pair.size());
        c.impulse += part * impulse;
    }
}

/// Sets the impulses of the contacts of one pair: the sum of what solves found, as `factor` times that. `end`: by the
/// last one, whose contacts these are; `before`: by those before it. `features`: of the contacts.
void set_impulses(std::span<const WarmImpulse> end, std::initializer_list<std::span<const WarmImpulse>> before,
                  std::span<const std::uint64_t> features, double factor, std::span<ContactState> pair) {
    const auto place = [&](const WarmImpulse& w) {
        return static_cast<std::size_t>(std::ranges::find(features, w.feature_key) - features.begin());
    };
    const auto add = [&](std::span<const WarmImpulse> impulses) {
        for (const WarmImpulse& w : impulses)
            if (const std::size_t i = place(w); i < pair.size()) pair[i].impulse += factor * w.impulse;
    };
    add(end);
    Vec3 gone;
    for (const auto impulses : before)
        for (const WarmImpulse& w : impulses)
            if (place(w) == pair.size()) gone += factor * w.impulse;
    share(gone, pair);
    for (const auto impulses : before) add(impulses);
}

/// What solves of static contact found.
struct Carried {
    const WarmImpulses& stages;           ///< of the last inner step, or of that in which sleepers fell asleep
    std::span<const WarmImpulse> earlier; ///< of inner steps before it
    double times;                         ///< so often all of that
};

/// Appends the contacts of a list that is sorted by bodies.
void append(std::span<const Contact> contacts, const Carried& carried, const Stepper& stepper, bool sleep,
            std::vector<ContactState>& out) {
    // All of a step's is stage 7's where velocities are those of its end.
    const bool halves = stepper.model().settings.velocity_update == VelocityUpdate::trapezoidal;
    ImpulsesByPair starts(halves ? std::span<const WarmImpulse>(carried.stages[ContactStage::kept])
                                 : std::span<const WarmImpulse>());
    ImpulsesByPair ends(carried.stages[ContactStage::final]), earlier(carried.earlier);
    std::vector<std::uint64_t> features;
    for (std::size_t first = 0; first < contacts.size(); first += features.size()) {
        const auto pair = bodies(contacts[first]);
        features.clear();
        const std::size_t place = out.size();
        const double rest = pair_lengths(stepper.model(), stepper.state(), pair.first, pair.second).rest;
        const bool thin = is_thin_pair(stepper.model(), pair.first, pair.second, contacts[first].friction, rest);
        for (std::size_t i = first; i < contacts.size() && bodies(contacts[i]) == pair; ++i) {
            const Contact c = thin ? with_two_points(contacts[i]) : contacts[i];
            features.push_back(c.feature_key);
            out.push_back(state_of(c, sleep));
        }
        set_impulses(ends.of(pair), {starts.of(pair), earlier.of(pair)}, features, carried.times,
                     std::span(out).subspan(place));
    }
}

/// What pairs carried in the step that have no contacts at its end: what lands or parts in it, or goes with a script
/// farther than the contact search sees. `touching`: the contacts at its end. At the places where the features are now.
void append_parted(const Stepper& stepper, std::span<const Contact> touching, std::vector<ContactState>& out) {
    const Model& model = stepper.model();
    const State& state = stepper.state();
    std::vector<WarmImpulse> carried = state.earlier, scratch;
    if (model.settings.velocity_update == VelocityUpdate::trapezoidal)
        add_impulses(state.warm[ContactStage::kept], 1, carried, scratch);
    const auto placed = [&](std::int32_t body) { return PosedShape{model.shape_of(at(body)), state.pose[at(body)]}; };
    auto next = touching.begin();
    for (const WarmImpulse& w : carried) {
        while (next != touching.end() && bodies(*next) < bodies(w)) ++next;
        if (w.impulse == Vec3{} || (next != touching.end() && bodies(*next) == bodies(w))) continue;
        if (!model.bodies[at(w.a)].movable() && !model.bodies[at(w.b)].movable()) continue; // asleep since
        if (model.ignores(w.a, w.b)) continue;                                              // edited since
        const FeaturePair features = features_of(w.feature_key);
        const ClosestPoints p = closest_points(features, placed(w.a), placed(w.b));
        const double distance = std::sqrt(p.distance_sq);
        const ProximityPoint point{features, p.a, p.b, normalized(p.b - p.a), distance};
        const double friction = pair_friction(model, w.a, w.b);
        const double rest = pair_lengths(model, state, w.a, w.b).rest;
        const Contact c = contact_of(w.a, w.b, point, friction);
        out.push_back(state_of(is_thin_pair(model, w.a, w.b, friction, rest) ? with_two_points(c) : c, false));
        out.back().impulse = w.impulse;
    }
}

} // namespace

void list_contact_states(const Stepper& stepper, std::vector<ContactState>& out) {
    out.clear();
    const State& state = stepper.state();
    const auto by_pair = [](const ContactState& x, const ContactState& y) {
        return std::pair(x.body_a, x.body_b) < std::pair(y.body_a, y.body_b);
    };
    const auto join = [&](std::ptrdiff_t first) {
        std::inplace_merge(out.begin(), out.begin() + first, out.end(), by_pair);
    };
    append(stepper.contacts().contacts, {state.warm, state.earlier, 1}, stepper, false, out);
    const std::ptrdiff_t touching = std::ssize(out);
    append_parted(stepper, stepper.contacts().contacts, out);
    join(touching);
    const std::ptrdiff_t awake = std::ssize(out);
    append(stepper.sleeping_contacts(), {state.waiting, {}, static_cast<double>(stepper.substeps())}, stepper, true,
           out);
    join(awake);
}

} // namespace flotilla
