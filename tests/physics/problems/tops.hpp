// SPDX-License-Identifier: MIT
// Tops, a block that tips over, Euler's disk, a ring that swings on a knife edge, and a hanging chain.
#pragma once

#include "physics/problems/history.hpp"

namespace flotilla::physics {

/// Inertia (1, 2, 3) kg m^2 and almost all spin about the middle axis: period 39.1057 s (elliptic integral), two flips
/// in it.
[[nodiscard]] SceneDescription asymmetric_top(const Start& start);
inline constexpr double kFlipPeriod = 39.1057; ///< s
inline const Vec3 kFlipMomentum{0.01, 2, 0.03};
/// s; 0 where it does not flip three times.
[[nodiscard]] double flip_period(const History& history);

/// A symmetric top precesses at L / I1, relative to which it turns about its own axis at (I3 - I1) w3 / I1.
[[nodiscard]] SceneDescription symmetric_top(const Start& start);
inline const Vec3 kTopMomentum{0.3, 0, 1.5};
/// Its axis's distance at the end from where it is due.
[[nodiscard]] double axis_off(const History& history);

/// An open cone, 1 m high, its tip at the origin.
[[nodiscard]] TriangleMesh make_cone(double radius, int segments);

/// A top of a flat cone's shape that stands on its tip, which does not slide, tilted by alpha, and precesses steadily:
/// about the vertical at the slower W of I1' W^2 cos(alpha) - I3 w3 W + m g l = 0, I1' about the tip.
[[nodiscard]] SceneDescription heavy_top(const Start& start);
inline constexpr double kHeavyTopTime = 8; ///< s, of more than half a turn
/// rad, of its axis from where it is due.
[[nodiscard]] double heavy_top_off(const History& history);
/// m, how far its tip is from where it stood.
[[nodiscard]] double tip_off(const History& history);

/// A block of 0.2 x 0.2 x 0.6 m let go on its edge, 0.3 rad past its balance: a physical pendulum about that edge, which
/// friction holds.
[[nodiscard]] SceneDescription tipping_block(const Start& start);
inline constexpr double kTippingTime = 0.4; ///< s, by when it has tipped by half a radian more
struct Tipping {
    double off = 0;   ///< m, of its centre from where it is due
    double speed = 0; ///< m/s, of its centre off what the energy gives it at its height, relative
    double edge = 0;  ///< m, how far along the ground the edge is from where it stood
};
[[nodiscard]] Tipping tipping(const History& history);

/// A disk that rolls at rest in the middle: tilted by alpha to the ground it precesses at W^2 sin(alpha) = 4 g / a with
/// the energy
/// 1.5 m g a sin(alpha), for ever without friction of rolling. It turns about the diameter to the point of contact at W
///     sin(alpha).
[[nodiscard]] SceneDescription eulers_disk(const Start& start);
struct Disk {
    double worst = 0; ///< relative error of W^2 sin(alpha), of means over a twelfth of a second or two steps
    double sine = 0;  ///< sin(alpha) at the end over that at the start
};
[[nodiscard]] Disk disk(const History& history);

/// A ring hung over the upper edge of a blade turns about the corner of its hole that lies on the edge.
[[nodiscard]] SceneDescription ring_on_knife_edge(const Start& start);
[[nodiscard]] double due_ring_period(); ///< s
inline constexpr double kRingPeriods = 7.3;
struct Swing {
    double kept = 0, period = 0; ///< amplitude over that at the start; s
};
[[nodiscard]] Swing swing(const History& history);

/// `links` links (odd ones turned by a right angle about the chain's axis) below a fixed one, in the shape of their
/// slowest small swing.
///
/// The lowest frequency of a hanging chain of length l is 1.2024 sqrt(g / l), first zero of J0 over 2, with the shape
/// J0(2.4048 sqrt(s / l)) at s above the end. A chain of N links from a fixed one is N + 1/4 pitches long to within a
/// quarter: it hangs from a point half a pitch below the fixed link's centre, but every other link is free to turn in
/// the plane of its ring and acts on a point. Links start in that shape, their vertices in each other's corners; period
/// from the zero crossings of the part of the motion along the shape.
class HangingChain {
  public:
    explicit HangingChain(int links);
    [[nodiscard]] SceneDescription scene(const Start& start) const;
    [[nodiscard]] double frequency() const; ///< rad/s, due
    struct Found {
        double frequency = 0;
        std::size_t crossings = 0;
    };
    [[nodiscard]] Found found(const History& history) const;

  private:
    int links_;
    TriangleMesh link_;
    double gap_, pitch_, length_; ///< m
    std::vector<double> shape_;
};

/// A chain's links lie along x or hang; the first is fixed. `pitch`: m, of their centres.
[[nodiscard]] SceneDescription chain_of(const Settings& settings, int links, const TriangleMesh& link, double pitch,
                                        bool hangs);
inline constexpr double kSteel = 7680; // kg/m^3

} // namespace flotilla::physics
