// SPDX-License-Identifier: MIT
// Bodies as stages 3 and 7 see them: velocities to be changed, and the inertia of the poses where the contacts are.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "state/model.hpp"
#include "static_contact/solver_state.hpp"

namespace flotilla {

struct VelocityArrays {
    std::vector<Vec3> position, velocity, angular_velocity;
    std::vector<double> inverse_mass;
    std::vector<Mat3> inverse_inertia;
    std::vector<Mat3> inertia; ///< with locked axes the block of the free ones
    std::vector<AxisMask> locked;
    std::vector<double> rest_speed; ///< m/s, see ContactBodies; empty where no body has loads of its own
    std::vector<Vec3> unloaded;     ///< rad/s, see turn_of(); empty where no body has a torque of its own

    std::vector<Vec3> loaded_angular_velocity; ///< of the active bodies
    /// What a body's inertia follows from. Shapes stay what they are.
    struct Turned {
        Quat rotation;
        std::int32_t shape = -1;
        AxisMask locked = 0; ///< rotation about these axes
        bool movable = false;
    };
    std::vector<Turned> turned;      ///< of which the inertia is: nobody turns between stage 7 and the next stage 3
    std::uint64_t still_version = 0; ///< of the bodies loaded that stand still

    /// Of the active bodies, and of those that stand still where these are of another version.
    void load(Team* team, const Model& model, std::uint64_t version, std::span<const Pose> poses,
              std::span<const Motion> motion);
    /// Makes the inertia of a body anew where it follows from something else than the last time.
    void set_inertia(const Model& model, std::size_t body, const Quat& rotation);
    void set_rest_speeds(Team* team, const Model& model, const ContactTuning& tuning);
    /// `accelerated`: s, for which loads have acted on the velocities loaded.
    void set_unloaded(Team* team, const Model& model, double accelerated);
    /// rad/s, how the body turns as far as it is known before contacts answer to loads: without what its own torque has
    /// added, which what stands on a floor will not keep, as it does not keep what gravity has added.
    [[nodiscard]] const Vec3& turn_of(std::int32_t body) const {
        const auto i = static_cast<std::size_t>(body);
        return unloaded.empty() ? angular_velocity[i] : unloaded[i];
    }
    /// Writes back; a momentum changes only where the angular velocity did, so that untouched bodies keep theirs to the
    /// bit.
    void store(Team* team, const Model& model, std::span<Motion> motion) const;
    /// What the solver changes.
    [[nodiscard]] ContactBodies bodies() {
        return {position, velocity, angular_velocity, inverse_mass, inverse_inertia, locked, rest_speed};
    }
};

} // namespace flotilla
