// SPDX-License-Identifier: MIT
// Impulses on clusters, and the end states that follow from them.
#pragma once

#include "pair/worker.hpp"
#include "response/cluster.hpp"

namespace flotilla {

/// What an operation of a sweep writes, of its own two clusters: their velocities, and the end states that follow.
class Movers {
  public:
    Movers(Clusters& clusters, Trajectories& trajectories, double dt)
        : clusters_(clusters), trajectories_(trajectories), dt_(dt) {}

    [[nodiscard]] Clusters& clusters() { return clusters_; }
    [[nodiscard]] Trajectories& trajectories() { return trajectories_; }
    void evolve(std::int32_t cluster) { clusters_.evolve(cluster, dt_, trajectories_); }

  private:
    Clusters& clusters_;
    Trajectories& trajectories_;
    double dt_; ///< s
};

/// Applies an impulse to two clusters.
void apply_impulse(Clusters& clusters, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
                   const Vec3& impulse);
/// The same, and re-evolves them.
void push(Movers& movers, Worker& worker, std::int32_t a, std::int32_t b, const ContactPoint& point,
          const Vec3& impulse);

} // namespace flotilla
