// SPDX-License-Identifier: MIT
// What the tests of the physics share beside their problems (problems/): runs with their account of energy, and tests
// that are registered once for each preset and time step. Every run prints one line of what was measured, whether its
// checks pass or not. SI units.
//
// A check states what is due, not what the solver gives: none is to be loosened so that it passes.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "base/rotation.hpp"
#include "physics/problems/history.hpp"
#include "step/scenario.hpp"

namespace flotilla::physics {

// ---- tests --------------------------------------------------------------------------------

/// Where a test belongs: `fast` ones run in less than 3 s each and a minute together; all of them make the full set.
enum class Slice { fast, full };

/// balanced, accurate and reference at each of `rates`.
[[nodiscard]] std::vector<Run> runs(const std::vector<int>& rates = {24, 120, 480});

/// Registers `body` as the test SUITE.NAME.
void add_test(const std::string& suite, const std::string& name, Slice slice, std::function<void()> body);
/// What takes too long for the fast slice.
inline constexpr bool kSlow = false;
/// Registers `body` as SUITE.NAME/RUN for each of `list`; the first one, if `fast`, in the fast slice.
void add_runs(const std::string& suite, const std::string& name, const std::vector<Run>& list, bool fast,
              const std::function<void(const Run&)>& body);

// ---- runs --------------------------------------------------------------------------------

/// What a run came to.
struct Outcome {
    int steps = 0;
    double rise = 0;        ///< largest rise of energy above the lowest so far and the lift, as a share of `scale`
    int rise_step = 0;      ///< where
    double scale = 0;       ///< J, the larger of the range of the energy and the largest kinetic energy
    double start = 0;       ///< J, kinetic energy
    double end = 0;         ///< J, kinetic energy
    double start_total = 0; ///< J, with the potential energy, zero at the origin
    double end_total = 0;
    double fastest = 0;       ///< m/s, centre of mass of a dynamic body at the end
    double fastest_sizes = 0; ///< the same in diameters of that body a second, or of its surface as it turns
    std::int64_t merges = 0, held = 0;
    std::int64_t held_steps = 0; ///< with a body held
    std::int64_t above = 0;      ///< steps that ended above the solver's tolerance
    std::int64_t asleep = 0;     ///< bodies at the end
    double seconds = 0;          ///< of the stepping thread
};

/// A World and its account. Energy is that of StepReport; before the first step it is computed here.
class Motion {
  public:
    explicit Motion(const SceneDescription& scene);
    StepReport step();
    /// Steps until `time` (s, to half a step). Fails the test and ends early when it takes more than `most` s of the
    /// stepping thread, and when the energy has risen by half of the scale without scripts: what follows an explosion
    /// teaches nothing.
    void run(double time, const std::function<void(const StepReport&)>& each = {}, double most = 900);
    /// The same, from the start on, with all states on the way.
    History record(double time);

    [[nodiscard]] World& world() { return world_; }
    [[nodiscard]] BodyState body(std::size_t i) const { return world_.body(i); }
    [[nodiscard]] const SceneDescription& scene() const { return scene_; }
    [[nodiscard]] const Outcome& outcome() const { return out_; }
    [[nodiscard]] double mass(std::size_t i) const { return bodies_[i].mass; } ///< kg; 0 for fixed and scripted bodies
    [[nodiscard]] double size(std::size_t i) const { return bodies_[i].size; } ///< m, diameter
    [[nodiscard]] double total_mass() const;
    /// N, mean force on `body` in the last step, from the impulses of contacts().
    [[nodiscard]] Vec3 force_on(std::size_t body) const;
    /// The farthest that a dynamic body is from its start, m.
    [[nodiscard]] double farthest() const;
    /// The same, aside of gravity.
    [[nodiscard]] double farthest_aside() const;

    /// Prints the line of this run: what Outcome holds and what the test adds.
    void print() const { print("%s", ""); }
    void print(const char* format, ...) const __attribute__((format(printf, 2, 3)));

  private:
    struct Body {
        double mass = 0, size = 0;
        Vec3 start;
        Vec3 half; ///< m, of the box around the centre of mass, in mesh axes
    };
    void add(double total, double kinetic);
    static double surface_speed(const Body& body, const BodyState& state);

    SceneDescription scene_;
    World world_;
    std::vector<Body> bodies_;
    Outcome out_;
    bool scripted_ = false; ///< bodies may work on others
    double lift_ = 0;       ///< J: every body raised once by its rest distance
    double lowest_ = 0, low_ = 0, high_ = 0, kinetic_ = 0, rise_ = 0;
};

/// Of the scale: what rounding may add.
inline constexpr double kRise = 1e-6;
/// Energy never rises beyond the lift.
void expect_no_rise(const Motion& motion);
/// No dynamic body moves by more than 1e-4 of its size a second.
void expect_rest(const Motion& motion);
/// The contacts carry the weight of all dynamic bodies on body `ground`, to 0.1 %.
void expect_weight_on(const Motion& motion, std::size_t ground);

} // namespace flotilla::physics
