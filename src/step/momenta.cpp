// SPDX-License-Identifier: MIT
// What v^ becomes at the end of a step where contact turned bodies, or the failsafe held them.
#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "state/loads.hpp"
#include "step/stepper.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBodyGrain = 16; // bodies of a task

} // namespace

/// Angular momentum turns with the body where contact turned it. What v^{n+1} begins with, `kept`, has an angular
/// momentum that belongs to the orientation which the body would have reached by it alone. Contact in stages 3 and 5
/// may have turned it otherwise, and with the momentum kept in the world its energy would be that of another
/// orientation: for a bar of aspect 1,000 many times as much. The further turn is O(dt^2) where contact acts steadily,
/// so the momentum turned with it is as exact as the scheme, and the energy is kept. `accelerated`: the part of the
/// step whose torques `kept` has in it. What came late to a body without loads turned it less in this step and
/// is no such turn: the impulse belongs to where bodies met. Energy is kept there as well, by the least change of the
/// momentum.
void Stepper::turn_momenta(std::span<const Motion> kept, double accelerated, std::span<Motion> motion) {
    const double dt = model_.settings.time_step;
    workers_.team.for_each("turn momenta", model_.active.size(), kBodyGrain, [&](std::size_t k, int) {
        const std::size_t i = at(model_.active[k]);
        if (!model_.bodies[i].movable()) return;
        const Cluster& c = clusters_[clusters_.of(i)];
        const Body& body = model_.bodies[i];
        if (num_free(body.locked.rotation) < 2) return; // about a hinge a momentum is that of any orientation
        const Vec3& before = kept[i].momentum;
        const bool driven = body.torque != Vec3{};
        const Vec3 added = driven ? dt * turning_torque(model_, i) : Vec3{};
        const Vec3 mean = driven ? before + (0.5 - accelerated) * added : before;
        if (c.members.size() == 1 && c.rung == Rung::free && clusters_.motion()[i].momentum == mean) return;
        const Quat &start = state_.pose[i].rotation, &end = trajectories_.end_pose(i).rotation;
        const WorldInertia inertia = world_inertia(model_.shape_of(i), body.locked.rotation, start);
        const Vec3 late = any_late_ && acceleration(model_, i) == Vec3{} ? buffers_.late[i].momentum : Vec3{};
        const Quat alone = normalized(rotate_free(inertia, body.locked.rotation, mean - late, dt).rotation * start);
        const Vec3 turned_on = rotate(end, rotate(conjugate(alone), before));
        if (body.locked.rotation != 0)
            motion[i].momentum = within_energy(i, before, turned_on);
        else
            motion[i].momentum = late == Vec3{} ? turned_on : with_energy(i, before, turned_on);
        if (driven) motion[i].momentum += (1 - accelerated) * added;
    });
}

/// The angular momentum at x^{n+1} next to `momentum`, to first order, that has the energy of `before` at x^n, or less
/// where there is none.
Vec3 Stepper::with_energy(std::size_t i, const Vec3& before, const Vec3& momentum) const {
    const auto spin_at = [&](const Quat& rotation, const Vec3& l) { return angular_velocity(model_, i, rotation, l); };
    const Quat& end = trajectories_.end_pose(i).rotation;
    const double due = dot(before, spin_at(state_.pose[i].rotation, before)); // twice the energy, as all here
    // Along the gradient of the energy, which is the spin: a quadratic equation.
    const Vec3 spin = spin_at(end, momentum);
    const double slope = length_sq(spin), curve = dot(spin, spin_at(end, spin));
    if (!(curve > 0)) return momentum;
    const double excess = dot(momentum, spin) - due;
    const double root = std::sqrt(std::max(0.0, slope * slope - curve * excess));
    const Vec3 out = momentum - ((slope - root) / curve) * spin;
    const double has = dot(out, spin_at(end, out));
    return has > due ? std::sqrt(due / has) * out : out;
}

/// With two free axes not all of a momentum turns on: what of it is about them, with no more than the energy at x^n.
Vec3 Stepper::within_energy(std::size_t i, const Vec3& before, const Vec3& turned_on) const {
    const Vec3 momentum = free_part(model_.bodies[i].locked.rotation, turned_on);
    const auto energy = [&](const Quat& rotation, const Vec3& l) {
        return dot(l, angular_velocity(model_, i, rotation, l));
    };
    const double allowed = energy(state_.pose[i].rotation, before);
    const double has = energy(trajectories_.end_pose(i).rotation, momentum);
    return has > allowed ? std::sqrt(allowed / has) * momentum : momentum;
}

/// A line has no momentum about itself (MassProperties::line); impulses at places within the step, where it lay
/// otherwise, gave it some.
void Stepper::drop_line_spin(std::span<const Pose> end, std::span<Motion> motion) const {
    for (const std::int32_t id : model_.active) {
        const std::size_t i = at(id);
        const Vec3& line = model_.shape_of(i).line;
        if (line == Vec3{} || !model_.bodies[i].movable() || model_.bodies[i].locked.rotation != 0) continue;
        const Vec3 along = rotate(end[i].rotation, line);
        motion[i].momentum -= dot(along, motion[i].momentum) * along;
    }
}

/// Whether nothing but bodies of finite mass had to do with where a cluster went: no rails either.
bool Stepper::keeps_momentum(const Cluster& c) const {
    const auto slowed = [&](std::int32_t member) { return slowed_[at(member)] != 0; };
    const bool free = !c.infinite() && !c.met_infinite && !c.locked.any() && c.resolved_against.empty();
    return free && std::ranges::none_of(c.members, slowed);
}

/// What is in the motion that a cluster made and not in the velocities of those who took the other side of it: what
/// clusters of finite mass gave it in stage 5, and what raised its bodies in stage 3.
Impulses Stepper::impulses_not_kept(const Cluster& c, std::span<const Motion> from, double accelerated) const {
    if (!keeps_momentum(c)) return {};
    Impulses sum = c.exchanged;
    const double dt = (0.5 - accelerated) * model_.settings.time_step;
    for (const std::int32_t member : c.members) {
        const std::size_t i = at(member);
        const Motion& half = buffers_.half[i];
        const Vec3 linear = model_.bodies[i].mass * (half.velocity - from[i].velocity - dt * acceleration(model_, i));
        sum.linear += linear;
        sum.angular += half.momentum - from[i].momentum + cross(trajectories_.start_pose(i).com - c.com0, linear);
        if (model_.bodies[i].torque != Vec3{}) sum.angular -= dt * turning_torque(model_, i);
    }
    return sum;
}

/// A body that the failsafe kept from falling must not go on accelerating: a cluster takes the velocity of the motion
/// it really made if that holds less kinetic energy than what it would have (src/failsafe/README.md). Beyond that rule:
/// the failsafe displaces bodies as neither velocity knows of, so the velocities taken are scaled, where momentum is
/// kept against their mean, to at most the kinetic energy of v^ plus the work of gravity along the displacement really
/// made; otherwise a body that was held up would keep the energy of a fall that it did not make. What the second half
/// of the step adds is left to stage 7: what stands on something is carried there, and without that load it would stand
/// on nothing, in every step anew.
void Stepper::held_velocities(std::span<const Motion> collided, std::span<const Motion> from, double accelerated,
                              std::span<Motion> motion, std::span<const Pose> end, StepReport& report) {
    const double dt = model_.settings.time_step;
    const auto kinetic = [&](std::size_t i, const Motion& m) {
        const Vec3 omega = angular_velocity(model_, i, end[i].rotation, m.momentum);
        return 0.5 * model_.bodies[i].mass * length_sq(m.velocity) + 0.5 * dot(omega, m.momentum);
    };
    const auto pulled = [&](std::size_t i) { // by the half of the step that stage 7 carries
        const bool driven = model_.bodies[i].torque != Vec3{};
        return Motion{0.5 * dt * acceleration(model_, i), driven ? 0.5 * dt * turning_torque(model_, i) : Vec3{}};
    };
    const auto kinetic_at_start = [&](std::size_t i) {
        const Vec3 omega = angular_velocity(model_, i, state_.pose[i].rotation, collided[i].momentum);
        return 0.5 * model_.bodies[i].mass * length_sq(collided[i].velocity) + 0.5 * dot(omega, collided[i].momentum);
    };
    for (const std::int32_t id : model_.active) {
        const Cluster& c = clusters_[id];
        if (c.members.empty() || !moved_otherwise(at(id))) continue;
        double planned = 0, real = 0, allowed = 0;
        std::vector<Motion> made;
        const Impulses alien = impulses_not_kept(c, from, accelerated);
        const Vec3 given = c.inverse_mass * alien.linear, spun = c.inertia.inverse * alien.angular;
        for (std::int32_t m : c.members) {
            const auto i = static_cast<std::size_t>(m);
            const Pose& start = trajectories_.start_pose(i);
            const PrincipalInertia inertia = turned(model_.shape_of(i).principal, end[i].rotation);
            const Body& body = model_.bodies[i];
            const Vec3 way = end[i].com - start.com, &turn = trajectories_.turn(i);
            const Motion pull = pulled(i);
            const Vec3 velocity =
                way / dt - free_part(body.locked.translation, given + cross(spun, start.com - c.com0));
            made.push_back(
                {velocity + pull.velocity,
                 free_part(body.locked.rotation, angular_momentum(inertia, turn / dt - spun)) + pull.momentum});
            planned += kinetic(i, motion[i]);
            real += kinetic(i, made.back());
            allowed += kinetic_at_start(i) + body.mass * dot(model_.gravity, way);
            if (body.driven()) allowed += load_work(i, collided[i], end[i]);
        }
        const auto member = [&](std::size_t k) { return static_cast<std::size_t>(c.members[k]); };
        if (real < planned)
            for (std::size_t k = 0; k < c.members.size(); ++k) motion[member(k)] = made[k];
        const double taken = std::min(real, planned);
        if (taken > allowed) {
            const bool keeps = keeps_momentum(c);
            Vec3 kept; // m/s, of all members
            for (const std::int32_t m : c.members)
                if (keeps) kept += c.inverse_mass * (model_.bodies[at(m)].mass * motion[at(m)].velocity);
            const double least = keeps ? 0.5 / c.inverse_mass * length_sq(kept) : 0.0;
            const double share = std::sqrt(std::max(0.0, allowed - least) / (taken - least));
            for (std::size_t k = 0; k < c.members.size(); ++k) {
                const Motion pull = pulled(member(k));
                const Vec3 stays = keeps ? kept : pull.velocity;
                Motion& m = motion[member(k)];
                m.velocity = stays + std::min(1.0, share) * (m.velocity - stays);
                m.momentum = pull.momentum + std::min(1.0, share) * (m.momentum - pull.momentum);
            }
        }
        if (real < planned || taken > allowed) report.warnings |= kReboundLost;
    }
    for (auto& impulses : state_.warm) std::erase_if(impulses, [&](const WarmImpulse& w) { return of_failsafe(w); });
}

} // namespace flotilla
