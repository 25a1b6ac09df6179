// SPDX-License-Identifier: MIT
// How bodies turn in the step, as far as is known before stage 3 solves.
//
// A contact row is linear: u = v + w x r at x^n. The point itself goes on an arc, and comes by the mean of its velocity
// over the step. What stands on a point, a block that tips over its edge or a top on its tip, has to keep it where it
// is by the end of the step (RATTLE, Andersen 1983), not now: else the point creeps by 1/2 dt^2 w x (w x r) a step.
// The difference of both is known to the order of the step's own error where the turn is: that of a free body of the
// momentum at hand and of the impulses that the solve begins with, on its way over the step. A block of 0.2 x 0.2 x 0.6
// m that tips for 0.4 s creeps by 5.8 mm at 1/25 s and 0.33 mm at 1/480 s without this, by 0.1 mm and less than 5 um
// with it; a top of 150 rad/s precesses at 1/480 s with 3.739 rad/s, as is due, and falls without.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "state/contact.hpp"
#include "state/model.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

class ExpectedTurns {
  public:
    /// Nobody is expected to turn.
    void clear(std::size_t bodies);
    /// The body is in contact, and turns. Side by side.
    void mark(std::int32_t body);
    [[nodiscard]] bool any() const { return any_; }
    /// Of the bodies marked. `impulses`: N s, on b, by contact (pair by pair), which the solve begins with.
    void find(Team* team, const Model& model, const VelocityArrays& bodies, std::span<const Contact> contacts,
              std::span<const Vec3> impulses);
    /// m/s, of a point of the body at `arm` (m) from its centre of mass, against that: its mean velocity in the step,
    /// less the one now. Nothing where the body turns by more than a radian: J at x^n knows little of its end then.
    [[nodiscard]] Vec3 mean_less_now(std::int32_t body, const Vec3& arm) const;

  private:
    void add_impulses(Team* team, const VelocityArrays& bodies, std::span<const Contact> contacts,
                      std::span<const Vec3> impulses);

    struct Turn {
        Vec3 angular_velocity; ///< rad/s, at the start
        Quat rotation;         ///< in the step
    };
    struct Torque {
        Vec3 a, b; ///< N m s, on either body of a pair
    };
    double time_step_ = 0;            ///< s
    bool any_ = false;                ///< is marked
    std::vector<std::uint8_t> turns_; ///< by body
    std::vector<Turn> turn_;          ///< by body
    std::vector<Vec3> torque_;        ///< N m s, by body
    std::vector<Torque> pair_torque_; ///< at the first contact of each pair
};

} // namespace flotilla
