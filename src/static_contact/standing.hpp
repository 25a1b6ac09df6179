// SPDX-License-Identifier: MIT
// What stands on an edge or on a point of another body, and is to be there again by the end of the step.
//
// A contact row is linear: u = v + w x r at x^n. The point itself goes on an arc, and comes by the mean of its velocity
// over the step. A block that tips over its edge or a top on its tip has to keep that where it is by the end of the
// step (RATTLE, Andersen 1983), not now: else it creeps by 1/2 dt^2 w x (w x r) a step. A block of 0.2 x 0.2 x 0.6 m
// that tips for 0.4 s creeps by 5.8 mm at 1/25 s and 0.33 mm at 1/480 s without this, by 0.1 mm and less than 5 um with
// it; a top of 150 rad/s precesses at 1/480 s with 3.734 rad/s, where 3.739 is due, and falls without.
//
// How bodies turn is known before the solve but for what the solve itself does. So what a pair's contacts forbid is
// left out of it: bodies that carry each other at points of a plane turn as one, and nothing is asked of them. (Asked
// by what each was expected to turn alone, corners of boxes that spin with a turntable were to part or to meet, which
// no motion does: four boxes were flung from it.) On an edge they turn against each other about that alone, on a point
// as they are expected to (expected_turns.hpp).
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "response/arc.hpp"
#include "state/contact.hpp"
#include "static_contact/expected_turns.hpp"
#include "static_contact/sticking.hpp"
#include "static_contact/velocity_arrays.hpp"

namespace flotilla {

/// About what a body may turn on points that carry it.
struct Pivot {
    enum class Kind : std::uint8_t { none, point, edge, held }; ///< nothing carries; ...; points of a plane do

    Kind kind = Kind::none;
    Vec3 origin; ///< m, one of the points
    Vec3 edge;   ///< m, from there to the farthest one
    double arm =
        std::numeric_limits<double>::infinity(); ///< m, of bodies that turn: places nearer than a little of it are one

    [[nodiscard]] bool turns() const { return kind == Kind::point || kind == Kind::edge; }
    void add(const Vec3& point);
    void add(const Pivot& other);
    /// Whether a point is on it.
    [[nodiscard]] bool has(const Vec3& point) const;
};

/// What is known of bodies that turn, beside their velocities.
struct TurningBodies {
    ExpectedTurns expected;
    LastVelocities last;
    std::vector<Pivot> pair_pivots; ///< at the first contact of each pair
    std::vector<Pivot> pivots;      ///< by body: of all its pairs

    void clear(std::size_t bodies, std::size_t contacts);
    /// Of all pairs, in order.
    void join(std::size_t bodies, std::span<const Contact> contacts);
};

/// m, the shorter one, from the centres of mass of bodies that can move.
[[nodiscard]] double arm_of(const Contact& contact, const VelocityArrays& bodies);

/// About what a pair may pivot, if at all, and which of its contacts are there.
class Standing {
  public:
    /// `at_end` of the step: stage 7.
    Standing(std::span<const Contact> pair, const VelocityArrays& bodies, const TurningBodies& turning,
             double time_step, bool at_end);

    /// Looks about what the pair may pivot.
    void find();
    /// Whether contact i of the pair stands: is where it pivots.
    [[nodiscard]] bool stands(std::size_t i) const { return pivot_.has(pair_[i].point); }
    /// The same: then it has no arc that would let it down. In stage 3 ArcContact::stands is set, of a point that slid
    /// by more in the last step than that along the other body the part along the normal: what slides comes to another
    /// place of it.
    bool on(std::size_t i, ArcContact& arc) const;
    /// Of all contacts where the pair pivots.
    void on_all(std::span<ArcContact> arcs);

  private:
    [[nodiscard]] bool goes_round() const;
    void turn_about_edge();
    [[nodiscard]] Vec3 mean_less_now(const Contact& c, bool of_b) const;

    std::span<const Contact> pair_;
    const VelocityArrays& bodies_;
    const TurningBodies& turning_;
    double time_step_;
    bool at_end_;
    bool slides_ = false;    ///< nothing holds it, or what is prescribed turns
    bool turns_far_ = false; ///< a body, by more than a radian in the step
    Pivot pivot_;
    Vec3 edge_;              ///< unit
    Vec3 spin_[2], rate_[2]; ///< rad/s, rad/s^2, of a and b on an edge
};

} // namespace flotilla
