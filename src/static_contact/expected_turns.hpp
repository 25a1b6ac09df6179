// SPDX-License-Identifier: MIT
// How bodies turn in the step, as far as is known before stage 3 solves: as free bodies of the momentum at hand, and of
// their own torques and the impulses that the solve begins with. Where those two together do more than that momentum,
// nothing is known, and they are left out: a torque alone would turn what stands on a floor.
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
    /// By up to a radian, further than which J at x^n knows little of its end.
    [[nodiscard]] bool turns(std::int32_t body) const;
    /// rad/s, at the start of the step; of one that does not turn what `bodies` have.
    [[nodiscard]] const Vec3& angular_velocity(const VelocityArrays& bodies, std::int32_t body) const;
    /// rad/s, of which a body's arcs are (rolling.hpp): VelocityArrays::turn_of(), and what the impulses leave of what
    /// its own torque has added, from nothing to all. They act where arcs have brought their contacts, and not where
    /// these are: of bodies without a torque they tell nothing here. A cylinder of 512 sides and 3 cm that a torque of
    /// 0.3 m g r drives comes to 0.961 of the speed that is due in 0.5 s at 1/24 s without that part, and to 0.985.
    [[nodiscard]] const Vec3& on_arcs(const VelocityArrays& bodies, std::int32_t body) const;
    /// Of the bodies marked. `impulses`: N s, on b, by contact (pair by pair), which the solve begins with.
    void find(Team* team, const Model& model, const VelocityArrays& bodies, std::span<const Contact> contacts,
              std::span<const Vec3> impulses);
    /// m/s, of a point of the body at `arm` (m) from its centre of mass, against that: its mean velocity in the step,
    /// less the one now. Of an arm that turns by less than a radian, however far the body does about it.
    [[nodiscard]] Vec3 mean_less_now(std::int32_t body, const Vec3& arm) const;

  private:
    void add_impulses(Team* team, const VelocityArrays& bodies, std::span<const Contact> contacts,
                      std::span<const Vec3> impulses);

    struct Turn {
        Vec3 angular_velocity; ///< rad/s, at the start
        Quat rotation;         ///< in the step
        Vec3 on_arcs;          ///< rad/s
    };
    struct Torque {
        Vec3 a, b; ///< N m s, on either body of a pair
    };
    double time_step_ = 0;            ///< s
    bool any_ = false;                ///< is marked
    std::vector<std::uint8_t> turns_; ///< by body: not, by up to a radian, or farther
    std::vector<Turn> turn_;          ///< by body
    std::vector<Vec3> torque_;        ///< N m s, by body
    std::vector<Torque> pair_torque_; ///< at the first contact of each pair
};

} // namespace flotilla
