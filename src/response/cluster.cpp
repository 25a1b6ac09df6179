// SPDX-License-Identifier: MIT
#include "response/cluster.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/inverse.hpp"

namespace flotilla {
namespace {

// radians: below it a rigid motion keeps linear trajectories apart: at every time all members are under one injective
// affine map, the blend of that of x^n and that of the end, and distances shrink at most by cos(turn / 2). Turning ones
// it does not keep apart: the centres of mass go straight and the bodies turn about them.
constexpr double kLargestRigidTurn = 2;

} // namespace

void Clusters::start(const Model& model, const Trajectories& trajectories, std::span<const Motion> motion) {
    resize(model);
    for (std::size_t i = 0; i < motion.size(); ++i) start(i, trajectories, motion[i]);
}

void Clusters::resize(const Model& model) {
    model_ = &model;
    const std::size_t n = model.size();
    clusters_.resize(n);
    cluster_of_.resize(n);
    base_.resize(n);
    inertia_.resize(n);
    base_turn_.resize(n);
    work_.resize(n);
    motion_.resize(n);
}

void Clusters::start(std::size_t i, const Trajectories& trajectories, const Motion& motion) {
    const Pose& pose = trajectories.start_pose(i);
    const RigidShape& shape = model_->shape_of(i);
    const bool movable = model_->bodies[i].movable();
    cluster_of_[i] = static_cast<std::int32_t>(i);
    base_[i] = pose;
    base_turn_[i] = {};
    work_[i] = 0;
    motion_[i] = motion;
    if (movable) inertia_[i] = world_inertia(shape, model_->bodies[i].locked.rotation, pose.rotation);
    Cluster& c = clusters_[i];
    c.members.assign(1, static_cast<std::int32_t>(i));
    c.resolved_against.clear();
    c.rung = Rung::free;
    c.rigid = c.internal_proved = true;
    c.inverse_mass = movable ? model_->bodies[i].inverse_mass : 0.0;
    c.com0 = c.base_com = pose.com;
    c.inertia = inertia_[i];
    c.locked = model_->bodies[i].locked;
    c.velocity = motion.velocity;
    c.momentum = motion.momentum;
    c.late = {};
    c.exchanged = {};
    c.met_infinite = false;
}

void Clusters::set_script(std::int32_t id, const Motion& motion) {
    motion_[at(id)] = motion;
    (*this)[id].velocity = motion.velocity;
    (*this)[id].momentum = motion.momentum;
}

Impulsive Clusters::impulsive(std::int32_t id) const {
    const Cluster& c = (*this)[id];
    if (!c.infinite())
        return {c.inverse_mass, c.inertia.inverse, c.velocity, c.inertia.inverse * c.momentum, c.locked.translation};
    // Scripted bodies keep their angular velocity in place of a momentum; held ones stand still.
    if (c.rung == Rung::held) return {};
    return {0, {}, c.velocity, c.momentum};
}

void Clusters::apply(std::int32_t id, const Vec3& arm, const Vec3& impulse) {
    Cluster& c = (*this)[id];
    if (c.infinite()) return;
    const Vec3 twist = cross(arm, impulse);
    const Vec3 dv = free_part(c.locked.translation, c.inverse_mass * impulse), dw = c.inertia.inverse * twist;
    c.velocity += dv;
    c.momentum += twist;
    for (std::int32_t i : c.members) { // equation 14
        Motion& m = motion_[at(i)];
        m.velocity += dv + cross(dw, base_[at(i)].com - c.base_com);
        m.momentum += free_part(model_->bodies[at(i)].locked.rotation, inertia_[at(i)].tensor * dw);
    }
}

void Clusters::note_exchanged(std::int32_t id, const Vec3& arm, const Vec3& impulse) {
    Impulses& sum = (*this)[id].exchanged;
    sum.linear += impulse;
    sum.angular += cross(arm, impulse);
}

void Clusters::delay(std::int32_t id, const Vec3& arm, const Vec3& impulse) {
    Cluster& c = (*this)[id];
    if (c.infinite()) return;
    c.late.velocity += free_part(c.locked.translation, c.inverse_mass * impulse);
    c.late.momentum += cross(arm, impulse);
}

void Clusters::evolve(std::int32_t id, double dt, Trajectories& trajectories) {
    Cluster& c = (*this)[id];
    if (c.infinite()) return;
    const Vec3 com = c.com0 + dt * c.way_velocity(); // equation 3
    const RotationStep r = rotate_free(c.inertia, c.locked.rotation, c.momentum - c.late.momentum, dt);
    const bool turns = r.rotation != Quat{};
    for (std::int32_t i : c.members) {
        const Pose& base = base_[at(i)];
        const Vec3 arm = base.com - c.base_com;
        Quat q = turns ? normalized(r.rotation * base.rotation) : base.rotation;
        Vec3 moved = com + (turns ? rotate(r.rotation, arm) : arm);
        Vec3 turn = base_turn_[at(i)];
        if (turns)
            turn = turn == Vec3{}
                       ? r.vector
                       : rotation_vector_near(q * conjugate(trajectories.start_pose(at(i)).rotation), turn + r.vector);
        if (model_->bodies[at(i)].locked.any()) keep_locked(at(i), trajectories.start_pose(at(i)), moved, q, turn);
        trajectories.set_end(at(i), make_pose(model_->shape_of(at(i)), moved, q), turn);
    }
    const bool affine = c.rigid && model_->settings.trajectory == Trajectory::linear;
    const bool keeps_apart = affine ? length(r.vector) < kLargestRigidTurn : !turns;
    if (c.members.size() > 1 && !keeps_apart) c.internal_proved = false;
}

void Clusters::take(std::int32_t id, const ClusterChange& change) {
    Cluster& c = (*this)[id];
    c.velocity = change.velocity;
    c.momentum = change.momentum;
    c.late = change.late;
    c.exchanged = change.exchanged;
    c.met_infinite = change.met_infinite;
    c.internal_proved = change.internal_proved;
    work_[at(id)] = change.work;
}

/// Takes the rounding out of what does not move.
void Clusters::keep_locked(std::size_t body, const Pose& start, Vec3& com, Quat& rotation, Vec3& turn) const {
    const AxisLocks locked = model_->bodies[body].locked;
    com = free_part(locked.translation, com) + free_part(locked.translation ^ kAllAxes, start.com);
    if (num_free(locked.rotation) > 1 || rotation == start.rotation) return;
    rotation = allowed_rotation(locked.rotation, model_->bodies[body].first_rotation, rotation);
    turn = free_part(locked.rotation, turn);
}

/// What is locked of a member is locked of all, for they move together; and where a member's centre of mass is locked
/// along some axis the cluster does not turn, which would move it.
void Clusters::gather(Cluster& c, const Trajectories& trajectories) const {
    double mass = 0;
    Vec3 sum;
    c.locked = {};
    for (std::int32_t i : c.members) {
        const AxisLocks& locked = model_->bodies[at(i)].locked;
        c.locked.translation |= locked.translation;
        c.locked.rotation |= locked.translation != 0 ? kAllAxes : locked.rotation;
        mass += model_->bodies[at(i)].mass;
        sum += model_->bodies[at(i)].mass * trajectories.start_pose(at(i)).com;
    }
    c.inverse_mass = 1 / mass; // equation 5
    c.com0 = sum / mass;       // equation 6
    Mat3 tensor{};
    for (std::int32_t i : c.members) { // equation 7
        const Mat3 r = cross_matrix(trajectories.start_pose(at(i)).com - c.com0);
        tensor = tensor + (inertia_[at(i)].tensor + model_->bodies[at(i)].mass * (r * transpose(r)));
    }
    c.inertia = {tensor,
                 c.locked.rotation == 0 ? inverse_of_transpose(tensor) : free_inverse(c.locked.rotation, tensor),
                 c.locked.rotation == 0 ? principal_form(tensor) : PrincipalInertia{}};
}

void Clusters::set_rigid(Cluster& c, const Trajectories& trajectories) {
    c.rigid = c.internal_proved = true;
    c.base_com = c.com0;
    Vec3 linear, angular;
    for (std::int32_t i : c.members) { // equation 8
        const Motion& m = motion_[at(i)];
        const Pose& pose = trajectories.start_pose(at(i));
        const Vec3 p = model_->bodies[at(i)].mass * m.velocity;
        linear += p;
        angular += cross(pose.com - c.com0, p) + m.momentum;
        base_[at(i)] = pose;
        base_turn_[at(i)] = {};
    }
    c.velocity = free_part(c.locked.translation, c.inverse_mass * linear);
    c.momentum = angular;
    const Vec3 omega = c.inertia.inverse * angular;
    for (std::int32_t i : c.members) { // equation 10
        motion_[at(i)].velocity = c.velocity + cross(omega, base_[at(i)].com - c.com0);
        motion_[at(i)].momentum = free_part(model_->bodies[at(i)].locked.rotation, inertia_[at(i)].tensor * omega);
    }
}

void Clusters::set_kinematic(Cluster& c, double dt, const Trajectories& trajectories) {
    c.rigid = false;
    Vec3 sum;
    for (std::int32_t i : c.members) {
        base_[at(i)] = trajectories.end_pose(at(i));
        base_turn_[at(i)] = trajectories.turn(at(i));
        sum += model_->bodies[at(i)].mass * base_[at(i)].com;
    }
    c.base_com = c.inverse_mass * sum;       // equation 11
    c.velocity = (c.base_com - c.com0) / dt; // equation 12
    c.momentum = {};
}

std::int32_t Clusters::merge(std::int32_t a, std::int32_t b, bool rigid, double dt, const Trajectories& trajectories) {
    const std::int32_t low = std::min(a, b), high = std::max(a, b);
    Cluster &to = (*this)[low], &from = (*this)[high];
    for (std::int32_t i : from.members) cluster_of_[at(i)] = low;
    to.members.insert(to.members.end(), from.members.begin(), from.members.end());
    std::sort(to.members.begin(), to.members.end());
    from.members.clear();
    to.rung = std::max({to.rung, from.rung, rigid ? Rung::rigid : Rung::kinematic});
    to.internal_proved = to.internal_proved && from.internal_proved;
    to.resolved_against.clear();
    const Vec3 to_com = to.com0;
    gather(to, trajectories);
    // What the two exchanged is in both, with opposite signs.
    to.exchanged.angular += from.exchanged.angular + cross(to_com - to.com0, to.exchanged.linear) +
                            cross(from.com0 - to.com0, from.exchanged.linear);
    to.exchanged.linear += from.exchanged.linear;
    to.met_infinite = to.met_infinite || from.met_infinite;
    if (rigid)
        set_rigid(to, trajectories);
    else
        set_kinematic(to, dt, trajectories);
    return low;
}

void Clusters::make_rigid(std::int32_t id, const Trajectories& trajectories) {
    Cluster& c = (*this)[id];
    c.rung = std::max(c.rung, Rung::rigid);
    set_rigid(c, trajectories);
}

void Clusters::hold(std::int32_t id, Trajectories& trajectories) {
    Cluster& c = (*this)[id];
    c.rung = Rung::held;
    c.internal_proved = true;
    c.inverse_mass = 0;
    c.velocity = c.momentum = {};
    for (std::int32_t i : c.members) {
        motion_[at(i)] = {};
        trajectories.hold(at(i));
    }
}

} // namespace flotilla
