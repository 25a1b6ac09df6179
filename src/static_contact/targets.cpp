// SPDX-License-Identifier: MIT
#include "static_contact/targets.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "base/index.hpp"
#include "base/rotation.hpp"
#include "proximity/passing.hpp"
#include "state/loads.hpp"
#include "static_contact/rolling.hpp"
#include "static_contact/thin_bodies.hpp"

namespace flotilla {
namespace {

// The dead band of equation 16, m/s: targets within it are zero, others lose it. A target below the tolerance asks for
// less than a solve may leave undone, and would cost many sweeps: bodies that touch at many points cannot approach each
// other a little at some of them and not at others, and contacts that hold more than the tiny target allows hand their
// load to the others so slowly that the sweeps never end. So a contact within tolerance * time step of its rest
// distance (8 um at the defaults) is at rest, and a farther one may come that near. The band is at most a share of the
// rest distance, which scales with the bodies: what keeps small ones off each other must not be lost. A rolling body is
// not at rest: the side that lands next would brake it from where the band begins, so a tolerance above the default one
// (Settings::tolerance_share) widens no band there.
double rest_band(double rest, double time_step, double tolerance, const ContactTuning& tuning) {
    return std::min(tolerance, tuning.most_of_rest * rest / time_step);
}

// In dead bands: to raise bodies by less costs a solve, which would leave as much undone. Without it 252 boats at rest
// took ten sweeps a step and more, and two with it, at a hundredth of the energy (sweeps aimed at an eighth of the
// tolerance, four seeds); with a whole band they came to rest later, with an eighth of one they asked in most steps.
constexpr double kWorthRaising = 0.5;

// In tolerances: how fast pairs yield that hold a body between them, so that a solve does not take it for rest.
constexpr double kYields = 2;
// How far down, of what a pair may lack before it counts as squeezed.
constexpr double kComesDown = 0.5;

// In tolerances: how fast a script that was stopped presses on what is in its way. A solve does not leave so much
// undone, and bodies hardly move for it.
constexpr double kPress = 4;

double equation_16(double gap, double time_step, double band) { // gap: to the rest distance, m
    const double target = gap / time_step;
    return target > 0 ? std::max(target - band, 0.0) : std::min(target + band, 0.0);
}

/// rad/s, without what the body's own torque added in the step.
Vec3 turn_before(const Model& model, const VelocityArrays& bodies, std::int32_t body) {
    const Vec3& omega = bodies.angular_velocity[at(body)];
    const Vec3 torque = turning_torque(model, at(body));
    return torque == Vec3{} ? omega : omega - model.settings.time_step * (bodies.inverse_inertia[at(body)] * torque);
}

/// m/s^2, what loads do to a body that can move.
Vec3 gained(const Model& model, const VelocityArrays& bodies, std::int32_t body) {
    return bodies.inverse_mass[at(body)] > 0 ? acceleration(model, at(body)) : Vec3{};
}

/// m/s, the approach at a contact without what loads have added in the step, negative where it parts.
double approach_before(const Model& model, const Contact& c, const VelocityArrays& bodies) {
    const auto before = [&](std::int32_t body) {
        const Vec3 added = model.settings.time_step * gained(model, bodies, body);
        return (bodies.velocity[at(body)] - added) +
               cross(turn_before(model, bodies, body), point_on(c, body) - bodies.position[at(body)]);
    };
    return -dot(c.normal, before(c.b) - before(c.a));
}

/// The approach, m/s, that a pair which stage 1 has not seen takes into the next step. Stage 5 may have kept the bodies
/// from moving as far as their velocities say, which count the whole acceleration of the step: a body that is held up
/// would go on accelerating. What they keep is the approach that they began the step with and what gravity adds on the
/// way that they really made.
double kept_approach(const Model& model, const Contact& c, std::span<const Pose> start, std::span<const Pose> end,
                     const VelocityArrays& bodies) {
    const auto start_of = [&](std::int32_t body) { // of the body's point that is at the contact now
        const Pose &from = start[at(body)], &to = end[at(body)];
        return from.com + rotate(from.rotation * conjugate(to.rotation), point_on(c, body) - to.com);
    };
    const double approach = std::max(0.0, approach_before(model, c, bodies));
    const double way = std::max(0.0, dot(c.normal, start_of(c.b) - start_of(c.a)));
    const double pull =
        std::max({std::abs(dot(c.normal, model.gravity)), std::abs(dot(c.normal, gained(model, bodies, c.a))),
                  std::abs(dot(c.normal, gained(model, bodies, c.b)))});
    return std::sqrt(approach * approach + 2 * pull * way);
}

/// The targets of a set's contacts, pair by pair.
class PairTargets {
  public:
    PairTargets(const Model& model, const ContactSet& set, const VelocityArrays& bodies, const TargetInput& input,
                ContactTargets& out)
        : model_(model),
          set_(set),
          bodies_(bodies),
          input_(input),
          out_(out),
          dt_(model.settings.time_step),
          angle_cos_(sin_cos(model.settings.proximity_angle * std::numbers::pi / 180).cos),
          most_slip_(input.tuning.most_slip * length(model.gravity) * dt_) {}

    /// Notes where the pair whose contacts are those from `first` to `end` carries, and whether its bodies turn.
    void look_at_pair(std::size_t first, std::size_t end) const {
        const Contact& c = set_.contacts[first];
        const bool thin = is_thin(first);
        Pivot pivot;
        pivot.arm = arm_of(contact_of(first, thin), bodies_);
        for (std::size_t i = first; i < end; ++i)
            if (input_.carried[i] != Vec3{}) pivot.add(contact_of(i, thin).point);
        out_.turning.pair_pivots[first] = pivot;
        const double still = dt_ * rest_band(set_.rest[first], dt_, tolerance(first), input_.tuning);
        if (turn_little(model_, c.a, c.b, bodies_, still)) return;
        for (const std::int32_t body : {c.a, c.b})
            if (bodies_.inverse_mass[at(body)] > 0) out_.turning.expected.mark(body);
    }

    /// Of the pair whose contacts are those from `first` to `end`.
    void set_pair(std::size_t first, std::size_t end) const {
        const bool thin = is_thin(first);
        for (std::size_t i = first; i < end; ++i) {
            out_.contacts[i] = contact_of(i, thin);
            out_.contacts[i].tolerance = tolerance(i);
            turn_normal(i);
        }
        const double share = std::max(1.0, model_.settings.tolerance_share);
        const std::span<const Contact> pair = std::span(out_.contacts).subspan(first, end - first);
        const bool rolls = arcs_of_pair(
            model_, pair, {dt_ * band(first, 1), dt_ * band(first, share), angle_cos_, input_.final_stage, thin},
            bodies_, out_.turning, std::span(out_.arcs).subspan(first, end - first));
        const Contact& c = set_.contacts[first];
        const double due = due_distance(input_.squeezed, c.a, c.b, set_.rest[first]);
        const double rest = std::min(set_.rest[first], out_.between.room(first));
        const bool yields = (due < set_.rest[first] && holds_between(first, end)) || out_.between.yields(first);
        const bool pressed = c.friction > 0 && out_.between.pressed(first); // else nothing comes of a load
        for (std::size_t i = first; i < end; ++i)
            set(i, {std::min(due, rest), rest, yields, pressed}, band(i, rolls ? share : 1));
    }

  private:
    [[nodiscard]] bool is_thin(std::size_t i) const {
        const Contact& c = set_.contacts[i];
        return is_thin_pair(model_, c.a, c.b, c.friction, set_.rest[i]);
    }
    [[nodiscard]] Contact contact_of(std::size_t i, bool thin) const {
        return thin ? with_two_points(set_.contacts[i]) : set_.contacts[i];
    }

    /// To where the features of a contact meet on their way.
    void turn_normal(std::size_t i) const {
        Contact& c = out_.contacts[i];
        const auto placed = [&](std::int32_t body) {
            return PosedShape{model_.shape_of(at(body)), input_.poses[at(body)]};
        };
        const PointGap gap = gap_on_the_way(features_of(c.feature_key), placed(c.a), placed(c.b), way(c),
                                            set_.rest[i] - dt_ * band(i, 1), {c.normal, c.distance});
        c.normal = gap.normal;
        c.distance = gap.distance;
    }

    /// m, of b relative to a, in the step as far as it is known before contacts answer to loads.
    [[nodiscard]] Vec3 way(const Contact& c) const {
        const auto velocity = [&](std::int32_t body) {
            return unloaded(body) + cross(bodies_.turn_of(body), point_on(c, body) - bodies_.position[at(body)]);
        };
        return dt_ * (velocity(c.b) - velocity(c.a));
    }

    /// m/s, of the centre of mass, without what loads have added.
    [[nodiscard]] Vec3 unloaded(std::int32_t body) const {
        const Vec3 v = bodies_.velocity[at(body)];
        return bodies_.inverse_mass[at(body)] > 0 ? v - input_.accelerated * acceleration(model_, at(body)) : v;
    }

    /// Of bodies that turn alike: whether they do so about one axis, and do not slip on each other here. Two that roll
    /// on nothing and turn the same way slip by all that their points move.
    [[nodiscard]] bool go_as_one(const Contact& c) const {
        constexpr double kSlips = 1.0 / 16;
        double turning = 0; // m/s
        for (const std::int32_t body : {c.a, c.b})
            turning += length(bodies_.turn_of(body)) * length(point_on(c, body) - bodies_.position[at(body)]);
        const Vec3 between = way(c);
        return length(between - dot(between, c.normal) * c.normal) < kSlips * dt_ * turning;
    }

    /// m/s (Settings::static_tolerance).
    [[nodiscard]] double tolerance(std::size_t i) const {
        const Settings& s = model_.settings;
        const Contact& c = set_.contacts[i];
        const double due =
            s.static_tolerance >= 0 ? s.static_tolerance : s.tolerance_share * default_tolerance(c, set_.rest[i]);
        if (!tolerance_given(s) || !s.warm_start) return due;
        return std::max(due, input_.tuning.of_load * dot(c.normal, input_.carried[i]) * normal_mass(c));
    }
    /// 1/kg: W_nn, or more where axes are locked.
    [[nodiscard]] double normal_mass(const Contact& c) const {
        double mass = 0;
        for (const std::int32_t body : {c.a, c.b}) {
            const Vec3 turn = cross(point_on(c, body) - bodies_.position[at(body)], c.normal);
            mass += bodies_.inverse_mass[at(body)] + dot(turn, bodies_.inverse_inertia[at(body)] * turn);
        }
        return mass;
    }
    [[nodiscard]] double default_tolerance(const Contact& c, double rest) const {
        const double moves = input_.tuning.of_rest * rest / dt_;
        double gravity = length(model_.gravity) * dt_;
        if (!(gravity > 0)) gravity = most_acceleration(model_, c.a, c.b) * dt_;
        return gravity > 0 ? std::min(moves, input_.tuning.of_gravity * gravity) : moves;
    }

    /// m/s, of a contact whose tolerance is set, that being `widened` times what a band may be.
    [[nodiscard]] double band(std::size_t i, double widened) const {
        return rest_band(set_.rest[i], dt_, out_.contacts[i].tolerance / widened, input_.tuning);
    }

    /// Whether contacts of a pair oppose each other. Where there is no room for the rest distance on both sides, and
    /// neither may come nearer, any two impulses that balance each other are a solution, and with friction they carry
    /// the body: a peg hung in its hole for ever, pressed by 120 times its weight. So while such a pair waits it yields
    /// a little everywhere.
    [[nodiscard]] bool holds_between(std::size_t first, std::size_t end) const {
        return flotilla::holds_between(std::span(set_.contacts).subspan(first, end - first));
    }

    /// m: `distance`, to where the contact may raise bodies; `rest`, as far apart as they are when it carries. In
    /// between it stays as it is, or where the pair yields comes down to a little less than the former.
    struct Due {
        double distance, rest;
        bool yields;
        bool pressed; ///< by a script, if there is one
    };
    void set(std::size_t i, const Due& due, double band) const {
        Contact& c = out_.contacts[i];
        const ArcContact& arcs = out_.arcs[i];
        const double distance = c.distance - arcs.closer;
        const double least = (1 - kComesDown * input_.tuning.most_of_rest) * due.distance;
        double full = equation_16(std::clamp(distance, due.distance, due.rest) - distance, dt_, band);
        if (due.yields)
            full = std::min(full, std::max(equation_16(least - distance, dt_, band), -kYields * c.tolerance));
        full += arcs.approach;
        // Arcs that bring points together do so by the end of the step. More than the rest distance is not to be lost
        // there, but by bodies that go round as one.
        const bool as_one = arcs.alike && go_as_one(c);
        const double later = as_one ? 0.0 : std::clamp(-0.5 * dt_ * arcs.apart, 0.0, set_.rest[i] / dt_);
        const double missing = late(c);
        c.target = input_.final_stage || stays_level(c) ? std::min(0.0, full) : full + later;
        if (!input_.all_level) c.target += missing;
        if (input_.all_level && full + later + missing > kWorthRaising * band && !is_level(c))
            std::atomic_ref(out_.would_raise).store(true, std::memory_order_relaxed); // whoever comes first
        else if (input_.all_level)
            c.target = std::min(0.0, full + later);
        // What turns with the inside of a ring needs half of its centripetal impulse now, to be where the ring is at
        // the end of the step, and half then (RATTLE).
        if (as_one && !input_.final_stage) c.target += arcs.together;
        c.target += arcs.rises + dot(c.normal, arcs.stands);
        if (!out_.presses.empty()) out_.presses[i] = due.pressed ? (input_.raises ? 0.0 : most_press(i)) : press(i);
        out_.carries[i] = arcs.carries != 0 ? 1 : 0;
        c.friction *= arcs.friction;
        if ((input_.keep_approach || with_sleeper(c)) && (set_.processed[i] == 0 || comes_anew(c)))
            c.target = std::min(c.target, -kept_approach(model_, c, input_.start, input_.poses, bodies_));
        const Vec3 slip = input_.final_stage ? arcs.stands : arcs.stands + turned_under(c, as_one);
        c.slip = slip - dot(c.normal, slip) * c.normal;
        c.point += arcs.shift;
        c.sticks = model_.settings.tangents == Tangents::random &&
                   sticks(c, std::min(most_slip_, set_.rest[i] / dt_), bodies_, out_.turning.last);
    }

    /// Whether a pair that rebounds comes at a contact from another direction than those that stage 1 knew: faster than
    /// it leaves anything that it meets, and not where the pair touched before. A ball that hit one side of a corner
    /// came to the other side by gravity alone; as two bodies they are two pairs.
    [[nodiscard]] bool comes_anew(const Contact& c) const {
        const Settings& s = model_.settings;
        const double least =
            s.approach_threshold >= 0 ? s.approach_threshold : most_acceleration(model_, c.a, c.b) * dt_;
        if (!(approach_before(model_, c, bodies_) > least) || !(pair_restitution(model_, c.a, c.b) > 0)) return false;
        const auto by_pair = [](const PairNormal& known) { return std::pair(known.a, known.b); };
        const auto known = std::ranges::equal_range(input_.known_normals, std::pair(c.a, c.b), {}, by_pair);
        return std::ranges::none_of(
            known, [&](const PairNormal& of_pair) { return dot(of_pair.normal, c.normal) >= angle_cos_; });
    }

    /// m/s, by how much a prescribed body that turns is faster where the other one is in the middle of the step than it
    /// is under it now, b against a: what it carries round then goes along its chord in the step. With the velocity at
    /// the start it would creep outward on a turntable, by 9 % of the radius in 4 s at 1 rad/s and 1/24 s. What goes as
    /// one with it moves along the normal too, as far from the axis; what stands on a roller does not.
    [[nodiscard]] Vec3 turned_under(const Contact& c, bool as_one) const {
        const auto faster = [&](std::int32_t body, std::int32_t other) {
            if (bodies_.inverse_mass[at(body)] > 0) return Vec3{};
            const Vec3 &omega = bodies_.angular_velocity[at(body)], &n = c.normal;
            const Vec3 between = bodies_.velocity[at(other)] - bodies_.velocity[at(body)],
                       turned = cross(omega, bodies_.position[at(other)] - bodies_.position[at(body)]);
            return 0.5 * dt_ * cross(omega, between - dot(n, as_one ? between - turned : between) * n);
        };
        return faster(c.a, c.b) - faster(c.b, c.a);
    }

    /// m/s, by which a script that was stopped presses on what is in its way; negative: it is not. What stands nearer
    /// than its rest distance has no load of its own, and without load no friction.
    [[nodiscard]] double press(std::size_t i) const {
        const Contact& c = out_.contacts[i];
        double due = 0, has = 0;
        if (input_.due_motion.empty()) return -1;
        for (const std::int32_t body : {c.a, c.b}) {
            if (!model_.bodies[at(body)].scripted()) continue;
            const double side = body == c.a ? 1 : -1;
            const Vec3 arm = point_on(c, body) - bodies_.position[at(body)];
            const Motion& m = input_.due_motion[at(body)];
            due += side * dot(c.normal, m.velocity + cross(m.momentum, arm));
            has += side * dot(c.normal, bodies_.velocity[at(body)] + cross(bodies_.angular_velocity[at(body)], arm));
        }
        if (!(due > 0) || !(has < due)) return -1; // not in its way, or it has all its motion
        return input_.raises ? 0 : std::max(0.0, std::min(due, most_press(i)) - std::max(0.0, has));
    }
    [[nodiscard]] double most_press(std::size_t i) const {
        const Contact& c = out_.contacts[i];
        return kPress * std::max(c.tolerance, default_tolerance(c, set_.rest[i]));
    }

    /// m/s, of the separation that the velocities of the contact have and their way in this step has not.
    [[nodiscard]] double late(const Contact& c) const {
        if (input_.late.empty()) return 0;
        const auto velocity = [&](std::int32_t body) {
            const Motion& m = input_.late[at(body)];
            return m.velocity + cross(bodies_.inverse_inertia[at(body)] * m.momentum,
                                      point_on(c, body) - bodies_.position[at(body)]);
        };
        return dot(c.normal, velocity(c.b) - velocity(c.a));
    }

    /// In stage 7. What comes near a sleeper wakes it in the next step, and is not to stop at it before.
    [[nodiscard]] bool with_sleeper(const Contact& c) const {
        return input_.final_stage && (model_.bodies[at(c.a)].asleep || model_.bodies[at(c.b)].asleep);
    }
    [[nodiscard]] bool stays_level(const Contact& c) const { return input_.all_level || is_level(c); }
    [[nodiscard]] bool is_level(const Contact& c) const {
        return !input_.level.empty() && (input_.level[at(c.a)] != 0 || input_.level[at(c.b)] != 0);
    }

    const Model& model_;
    const ContactSet& set_;
    const VelocityArrays& bodies_;
    const TargetInput& input_;
    ContactTargets& out_;
    double dt_;        ///< s
    double angle_cos_; ///< of theta_proximity
    double most_slip_; ///< m/s, of a contact that sticks
};

} // namespace

void set_targets(Team* team, const Model& model, const ContactSet& set, const VelocityArrays& bodies,
                 const TargetInput& input, ContactTargets& out) {
    constexpr std::size_t kContactGrain = 256; // contacts of a task
    out.presses.clear();
    out.contacts.resize(set.size());
    out.arcs.resize(set.size());
    out.carries.resize(set.size());
    out.would_raise = false;
    if (set.contacts.empty()) return; // what sleeps costs nothing
    out.between.find(team, model, set, input.noted, input.squeezed, input.tuning.most_of_rest);
    out.presses.assign(input.due_motion.empty() && !out.between.presses() ? 0 : set.size(), -1);
    const PairTargets targets(model, set, bodies, input, out);
    const std::span<const Contact> contacts = set.contacts;
    const auto end_of_pair = [&](std::size_t i) {
        std::size_t end = i + 1;
        while (end < set.size() && !begins_pair(contacts, end)) ++end;
        return end;
    };
    out.turning.clear(model.size(), set.size());
    for_each(team, "look at pairs", set.size(), kContactGrain, [&](std::size_t i) {
        if (begins_pair(contacts, i)) targets.look_at_pair(i, end_of_pair(i));
    });
    if (out.turning.expected.any()) {
        out.turning.join(model.size(), set.contacts);
        if (!input.final_stage || !bodies.unloaded.empty())
            out.turning.expected.find(team, model, bodies, set.contacts, input.impulses);
    }
    if (model.settings.tangents == Tangents::random || out.turning.expected.any())
        out.turning.last.load(team, model, bodies, input.last_motion);
    for_each(team, "select contacts", set.size(), kContactGrain, [&](std::size_t i) {
        if (begins_pair(contacts, i)) targets.set_pair(i, end_of_pair(i));
    });
}

} // namespace flotilla
