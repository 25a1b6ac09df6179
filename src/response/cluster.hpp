// SPDX-License-Identifier: MIT
// Bodies that move together: single bodies, kinematic clusters and rigid clusters (paper, section 4.2, equations 5-14).
//
// Every movable body belongs to one cluster, at first to its own. All clusters move by one formula: the cluster's frame
// goes from (com0, identity) to (com0 + dt v, R), R by equation 4 from its angular momentum, and carries its members'
// base poses,
//     X_i = X_c(new) X_c(base)^-1 X_i(base).
// Base poses at x^n make it rigid (equation 9); base poses at the end states found so far make it kinematic (equation
// 13): the members keep their own relative motion and only what is added later is common. A body alone is both.
#pragma once

#include <vector>

#include "response/impulse.hpp"
#include "state/locked_rotation.hpp"
#include "state/trajectories.hpp"

namespace flotilla {

/// The failsafe's ladder; a cluster only goes down (G4).
enum class Rung : std::uint8_t { free, kinematic, rigid, held };

/// Linear and angular impulse, kg m/s and kg m^2/s, the latter about the com0 of the cluster that had it.
struct Impulses {
    Vec3 linear, angular;
};

struct Cluster {
    std::vector<std::int32_t> members; ///< ascending; empty after it was merged into another
    Rung rung = Rung::free;
    bool rigid = true;           ///< base poses are those at x^n
    bool internal_proved = true; ///< all pairs of members are proved for the present end states (certificate.hpp, c)
    double inverse_mass = 0;     ///< 0: static, scripted or held
    Vec3 com0, base_com;         ///< m, equations 6 and 11
    WorldInertia inertia;        ///< equation 7, about com0 at x^n
    Vec3 velocity, momentum;     ///< m/s; kg m^2/s about com0
    Motion late;                 ///< what of these the way of the step is without: see delay()
    Impulses exchanged;          ///< with other clusters of finite mass since start(), those merged into it aside
    bool met_infinite = false;   ///< had an impulse of a body of infinite mass since start()
    AxisLocks locked;            ///< its members' together, see gather()
    std::vector<std::int32_t> resolved_against; ///< infinite-mass bodies since the last merge (G4)

    [[nodiscard]] bool infinite() const { return inverse_mass == 0; }
    [[nodiscard]] bool any_late() const { return late.velocity != Vec3{} || late.momentum != Vec3{}; }
    [[nodiscard]] Vec3 way_velocity() const { return velocity - late.velocity; } ///< m/s, of the way of the step
};

/// What apply() and evolve() change of a cluster, beside the motions and end states of its members.
struct ClusterChange {
    Vec3 velocity, momentum;
    Motion late;
    Impulses exchanged;
    bool met_infinite = false;
    double work = 0;
    bool internal_proved = true;
};

class Clusters {
  public:
    /// One cluster per body with the given motion.
    void start(const Model& model, const Trajectories& trajectories, std::span<const Motion> motion);
    /// The same in two parts. Makes room for the clusters of the model's bodies; start() begins each.
    void resize(const Model& model);
    /// A cluster of one body with the given motion (v, L); different bodies may be started side by side. Infinite-mass
    /// bodies have infinite clusters.
    void start(std::size_t body, const Trajectories& trajectories, const Motion& motion);

    [[nodiscard]] std::int32_t of(std::size_t body) const { return cluster_of_[body]; }
    [[nodiscard]] const Cluster& operator[](std::int32_t id) const { return clusters_[static_cast<std::size_t>(id)]; }
    [[nodiscard]] Cluster& operator[](std::int32_t id) { return clusters_[static_cast<std::size_t>(id)]; }
    [[nodiscard]] const std::vector<Motion>& motion() const { return motion_; } ///< of the members, equations 10 and 14

    /// Work, J, of bodies of prescribed motion on the cluster's bodies since start().
    void add_work(std::int32_t id, double work) { work_[static_cast<std::size_t>(id)] += work; }
    [[nodiscard]] double work(std::int32_t id) const { return work_[static_cast<std::size_t>(id)]; }
    /// m/s, of a point of a cluster of infinite mass.
    [[nodiscard]] Vec3 velocity_at(std::int32_t id, const Vec3& arm) const {
        return point_velocity(impulsive(id), arm);
    }

    /// Prescribes the motion of a scripted body: velocity and, in place of the momentum, angular velocity.
    void set_script(std::int32_t id, const Motion& motion);

    [[nodiscard]] Impulsive impulsive(std::int32_t id) const;
    /// Applies an impulse at `arm` from the cluster's centre of mass; the trajectory follows with evolve().
    void apply(std::int32_t id, const Vec3& arm, const Vec3& impulse);
    /// Notes that an impulse on the cluster came from a body of infinite mass.
    void note_infinite(std::int32_t id) { (*this)[id].met_infinite = true; }
    /// Notes that the impulse came from another cluster of finite mass.
    void note_exchanged(std::int32_t id, const Vec3& arm, const Vec3& impulse);
    /// Takes an impulse of a cluster of one body back out of the way of this step, not out of its velocity: it came
    /// late in the step.
    void delay(std::int32_t id, const Vec3& arm, const Vec3& impulse);
    /// Commits the end states that follow from the cluster's velocity, without what came late of it.
    void evolve(std::int32_t id, double dt, Trajectories& trajectories);

    /// What another rank changed in its copy (parallel/division.hpp), from there to here.
    [[nodiscard]] ClusterChange change(std::int32_t id) const {
        const Cluster& c = (*this)[id];
        return {c.velocity, c.momentum, c.late, c.exchanged, c.met_infinite, work(id), c.internal_proved};
    }
    void take(std::int32_t id, const ClusterChange& change);
    void take_motion(std::size_t body, const Motion& motion) { motion_[body] = motion; }

    /// Joins b into a; the union has the lower id of the two, which is returned. Rigid: base poses at x^n and the
    /// combined momentum (equations 5-8). Kinematic: base poses at the present end states (equations 11, 12).
    std::int32_t merge(std::int32_t a, std::int32_t b, bool rigid, double dt, const Trajectories& trajectories);
    /// Makes a kinematic cluster rigid.
    void make_rigid(std::int32_t id, const Trajectories& trajectories);
    /// Puts all members back to x^n, for the rest of the step.
    void hold(std::int32_t id, Trajectories& trajectories);

  private:
    void keep_locked(std::size_t body, const Pose& start, Vec3& com, Quat& rotation, Vec3& turn) const;
    void gather(Cluster& c, const Trajectories& trajectories) const;
    void set_rigid(Cluster& c, const Trajectories& trajectories);
    void set_kinematic(Cluster& c, double dt, const Trajectories& trajectories);

    const Model* model_ = nullptr;
    std::vector<Cluster> clusters_;
    std::vector<std::int32_t> cluster_of_;
    std::vector<Motion> motion_;
    std::vector<WorldInertia> inertia_; ///< of the bodies at x^n; with locked axes the inverse is that of what is free
    std::vector<Pose> base_;
    std::vector<Vec3> base_turn_;
    std::vector<double> work_; ///< by cluster
};

} // namespace flotilla
