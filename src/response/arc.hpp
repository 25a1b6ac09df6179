// SPDX-License-Identifier: MIT
// Contact points of turning bodies move on arcs.
//
// A contact's constraint is linear in the velocities: d + dt u_n >= d_rest (eq. 16). A point of a body that turns at w
// is accelerated by w x (w x r) as well. Where that leads away from the other body, a point ahead of the contact of a
// rolling body comes down with a speed that it will have lost when it arrives. The linear form does not know that: all
// points within an angle 2 dt w ahead of the contact brake the body, and a cylinder of 512 sides keeps 37 % of its
// speed in 2 s at 1/24 s.
//
// So such a point is taken where its arc brings it nearest: its gap and its arm are those of that time. All points of a
// wheel that pass the ground in a step then press on it right below the axle, and it rolls.
//
// Where bodies go round as one the row is asked for what their arcs bring together by then, as the inside of a ring
// does with what it carries round, and let off what they take apart. Two blocks in a free hoop at 4 rad/s keep 0.9995
// of their angular momentum in 4 s at 1/60 s. They kept 0.72 where the half velocities alone had that: places were put
// right, and velocities not. A block that its friction holds on a plane of 45 degrees, which turns at 5.7 rad/s about
// the vertical, was flung from it within 4 s at 1/60 s where nothing was let off, and creeps by 4 mm.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3.hpp"

namespace flotilla {

/// w x (w x r): acceleration of a point of a body that turns at `omega` (rad/s), `arm` (m) from its centre of mass,
/// against that centre, m/s^2.
[[nodiscard]] inline Vec3 arc_acceleration(const Vec3& omega, const Vec3& arm) {
    return cross(omega, cross(omega, arm));
}

/// R(w) r - r for a rotation vector w of at most one radian, m. Series, to 3e-5 of the length of w x r.
[[nodiscard]] inline Vec3 arc_way(const Vec3& w, const Vec3& arm) {
    const double angle_sq = length_sq(w);
    const Vec3 along = cross(w, arm);
    const double a = 1.0 / 2 - angle_sq * (1.0 / 24 - angle_sq / 720);
    const double b = 1 - angle_sq * (1.0 / 6 - angle_sq * (1.0 / 120 - angle_sq / 5040));
    return a * cross(w, along) + b * along;
}

/// The approach, m/s, with which points `gap` metres apart meet that approach each other at `approach` > 0 while their
/// arcs take them apart at `acceleration`, m/s^2; 0 where the arcs stop them before.
[[nodiscard]] inline double approach_on_arrival(double approach, double gap, double acceleration) {
    if (!(gap > 0 && acceleration > 0)) return approach;
    return std::sqrt(std::max(0.0, approach * approach - 2 * acceleration * gap));
}

/// Whether two bodies turn as one. What comes nearer or parts on arcs then does so at all of their points alike. Of
/// bodies that turn on each other others follow: the inside of a drum that turns under a ball comes no nearer to it.
[[nodiscard]] inline bool turn_alike(const Vec3& a, const Vec3& b) {
    constexpr double kAlike = 1.0 / 16;
    return length_sq(b - a) < kAlike * kAlike * std::max(length_sq(a), length_sq(b));
}

/// A point of a body that turns.
struct TurningPoint {
    Vec3 omega; ///< rad/s
    Vec3 arm;   ///< m, from the centre of mass
};

/// Where the arcs of two bodies bring a contact point nearest.
struct ArcContact {
    double rate = 0;     ///< m/s, along the normal, of what turning does now
    double closer = 0;   ///< m, how much nearer the points are then, apart from what the centres of mass do
    double approach = 0; ///< m/s, along the normal, with which they still come nearer at the end of the step; <= 0
    Vec3 shift;          ///< m, to where the contact then is, seen from the centre of mass of the body whose arc it is
    double apart = 0;    ///< m/s^2, acceleration of the points away from each other
    bool ahead = false;  ///< they come nearer up to the end of the step
    /// m/s, along the normal, by which arcs of bodies that turn alike bring points together in the mean of the step;
    /// negative: by which they part.
    double together = 0;
    bool alike = false;  ///< they do
    double rises = 0;    ///< m/s, along the normal, how much faster the place of the shift moves than the point
    double friction = 1; ///< of that of the pair
    double carries = 0;  ///< share of the stage's load until another one lands; negative where this one does
    /// m/s, for a point that stands on the other body: of the two bodies' points against each other now, so that they
    /// come together again by the end of the step (static_contact/standing.hpp).
    Vec3 stands;
    Vec3 carries_at; ///< m, from the contact to where it then is in the mean
};

/// For a contact of a and b with the normal n from a to b.
[[nodiscard]] inline ArcContact meet_on_arcs(const TurningPoint& a, const TurningPoint& b, const Vec3& n, double dt) {
    const double apart_a = -dot(n, arc_acceleration(a.omega, a.arm)),
                 apart_b = dot(n, arc_acceleration(b.omega, b.arm));
    ArcContact out;
    out.apart = apart_a + apart_b;
    const auto approach = [&](const Vec3& way_a, const Vec3& way_b) {
        return dot(n, cross(b.omega, b.arm + way_b) - cross(a.omega, a.arm + way_a));
    };
    const double now = out.rate = approach({}, {});
    // Beyond a radian the series ends, and nothing that was near is near any more.
    const double fastest = std::sqrt(std::max(length_sq(a.omega), length_sq(b.omega)));
    const double longest = fastest * dt > 1 ? 1 / fastest : dt;
    out.alike = turn_alike(a.omega, b.omega);
    if (out.alike) out.together = -0.5 * out.apart * longest * longest / dt;
    if (!(now < 0 && out.apart > 0)) return out;
    const double time = std::min(-now / out.apart, longest);
    const Vec3 way_a = arc_way(time * a.omega, a.arm), way_b = arc_way(time * b.omega, b.arm);
    out.ahead = time == dt;
    out.closer = dot(n, way_a - way_b);
    out.approach = std::min(0.0, approach(way_a, way_b));
    out.shift = apart_b >= apart_a ? way_b : way_a;
    return out;
}

} // namespace flotilla
