// SPDX-License-Identifier: MIT
// The last resort that keeps G5: energy does not grow by itself, island by island.
//
// At the end of a step every island may have at most the energy that it had before, the work of scripted bodies and of
// the bodies' own forces and torques, and lift: stages 3 and 5 bring bodies that are too near to their rest distance,
// which may raise them. What of a rise of the energy is lift is booked for every body, at most its weight (and what
// else pulls on it) times d_rest in all, and cancelled again when the island loses energy. So the energy of a scene
// without scripts never exceeds its lowest value so far by more than the lift of all bodies.
//
// What rises beyond that is taken from the velocities of the island: relative to its centre of mass where nothing of
// infinite mass touches it and none of its bodies was held or slowed, which keeps its momentum, else relative to the
// world. How often that happens: bench/results/energy.md.
#pragma once

#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "state/model.hpp"

namespace flotilla {

struct EnergyCorrections {
    std::int64_t islands = 0; ///< that had to give up energy
    double removed = 0;       ///< J
    double lift = 0;          ///< J, of the bodies awake, booked at the end of the step
};

class EnergyAccount {
  public:
    /// Begins a step: every body is an island of its own. `before`: the poses and motions at x^n.
    void start(Team& team, const Model& model, std::span<const Pose> pose, std::span<const Motion> motion);
    /// The bodies exchanged momentum, or could have.
    void join(const Model& model, std::int32_t a, std::int32_t b);
    /// The body does not keep its momentum, as if it touched infinite mass: it was held in the step, or slowed down.
    void ground(std::int32_t body) { grounded_[static_cast<std::size_t>(body)] = 1; }
    /// Work of scripted bodies on a body, J. Counts where it is positive for the island.
    void add_work(std::int32_t body, double work) { work_[static_cast<std::size_t>(body)] += work; }

    /// Subtracts from what is late of each island's velocities (m/s, Cluster::late) its mean by mass, where nothing of
    /// infinite mass touches the island and none of its bodies is locked along an axis: its centre of mass then follows
    /// its momentum. Else a blow that is late for one body and not for the one it hits moves the centre of mass, and
    /// where that rises no velocity pays for it. After all join() of stage 1.
    void keep_centers(const Model& model, std::span<Motion> late);

    /// Work of a body's own force and torque, J (state/loads.hpp): that of a step which pulls up is negative.
    void add_loads(std::int32_t body, double work) { loads_[static_cast<std::size_t>(body)] += work; }

    /// By body, the share of the displacements `way` (m) of the centres of mass in the step that the energy and the
    /// lift of its island pay for, with all velocities given up. A scripted body pays for islands that touch it.
    [[nodiscard]] std::span<const double> paid(const Model& model, std::span<const Vec3> way,
                                               std::span<const double> lift);
    /// Bodies of islands that do not pay for all of it.
    [[nodiscard]] std::span<const std::int32_t> overdrawn(const Model& model, std::span<const Vec3> way,
                                                          std::span<const double> lift);
    /// By body, the share of the way from the half velocities `kept` to `raised` that its island pays for, with the
    /// lift that it has left and with what contact dissipates along `kept`. The rest of the kinetic energy stays: what
    /// slides on a stack would pay with its speed for raising all of it. The top one of eight boxes, pulled with twice
    /// its friction, went 10 mm where 88 were due.
    [[nodiscard]] std::span<const double> affordable(const Model& model, std::span<const Pose> pose,
                                                     std::span<const Motion> kept, std::span<const Motion> raised,
                                                     std::span<const double> lift);
    /// Bodies of islands that can hardly be raised any more: their energy and the lift they have left would raise them
    /// by no more than `share` of their rest distances.
    [[nodiscard]] std::span<const std::int32_t> spent(const Model& model, double share, std::span<const double> lift);
    /// Finds the islands that touch scripted bodies, anew where islands were joined since paid() or spent().
    void find_scripted(const Model& model);
    /// Whether the island of a movable body touches a scripted one, as paid(), spent() or find_scripted() found it.
    [[nodiscard]] bool touches_script(std::int32_t body) {
        return islands_[static_cast<std::size_t>(root(body))].grounded;
    }
    /// Cuts the velocities `motion` at the poses `end`; `lift` is what is booked for every body, J.
    EnergyCorrections settle(Team& team, const Model& model, std::span<const Pose> end, std::span<Motion> motion,
                             std::span<double> lift);

  private:
    /// Of a body, or of an island at the place of its lowest body.
    struct Balance {
        double gain = 0;     ///< J, since x^n, without the work of loads
        double kinetic = 0;  ///< J, at the end
        double work = 0;     ///< J, of scripted bodies
        double rounding = 0; ///< J, of kinetic energy and gain
        double mass = 0;     ///< kg
        Vec3 momentum;       ///< kg m/s
        double lift = 0, most_lift = 0;
        bool grounded = false; ///< touches infinite mass, or is locked along some axis or slowed, which is as much
    };
    /// What an island's bodies do with their velocities and their lift.
    struct Verdict {
        double scale = 1; ///< of velocities against `center`
        Vec3 center;      ///< m/s
        double draw = 0;  ///< J, lift to book, or to cancel where negative
        double debt = 0;  ///< J per kg, beyond what lift allows: paid back by the steps to come
    };

    [[nodiscard]] std::int32_t root(std::int32_t body);
    /// What islands have at x^n: kinetic energy, room for lift (`most_lift`) of all that there may be (`lift`), and
    /// whether they touch a scripted body.
    void weigh_islands(const Model& model, std::span<const double> lift);
    /// J, what a displacement costs a body.
    [[nodiscard]] static double cost_of(const Model& model, std::size_t body, const Vec3& way);
    [[nodiscard]] Balance balance(const Model& model, std::size_t body, const Pose& end, const Motion& motion,
                                  double lift) const;
    Verdict judge(const Balance& island, EnergyCorrections& out) const;

    std::vector<std::int32_t> parent_; ///< union-find, the lowest body is the root
    std::vector<double> kinetic_, work_, loads_;
    std::vector<Vec3> com_; ///< m, at x^n
    std::vector<std::uint8_t> grounded_;
    std::vector<Balance> bodies_, islands_;
    std::vector<Verdict> verdicts_;
    std::vector<std::int32_t> overdrawn_; ///< or spent
    std::vector<double> shares_;
    std::vector<std::uint8_t> scripted_; ///< touches a scripted body
};

} // namespace flotilla
