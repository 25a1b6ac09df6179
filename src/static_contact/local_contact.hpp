// SPDX-License-Identifier: MIT
// One contact in its own frame (normal, tangent 1, tangent 2): the projection of eqs 17-20 and nothing else. It knows
// the contact's relative velocity u, its impulse and the 3x3 matrix W that turns a change of the one into a change of
// the other; where u comes from (bodies, or a matrix of a test problem) is the caller's business. Written once for
// every vector width P: lanes are independent contacts.
//
// A visit does the three scalar rows of projected Gauss-Seidel in the order normal, tangent 1, tangent 2; each row sees
// what the rows before it did. Deviation from eqs 18-20: Cone::disc replaces the pyramid by |lambda_t| <= mu lambda_n
// with the friction opposite to the slip, because the pyramid's friction is up to sqrt(2) too large along its diagonal
// (4/pi on average over random tangents). Both its tangents are then solved together, which needs no more sweeps than
// an exact solve of the local cone (tests/static_contact/friction_problem_test.cpp).
//
// Include after a pack header; everything on packs has internal linkage.
#pragma once

#include "geometry/pack_vec.hpp"
#include "static_contact/contact_rows.hpp"

namespace flotilla {

namespace {

/// A LocalContact per lane.
template <class P>
struct LocalPack {
    PackVec<P> mass_diagonal, inv_mass_diagonal, coupling, impulse, target;
    P friction;
};

/// The violation is |change of impulse| W_ii in m/s: |u_n - target| where the contact holds, the approach where it does
/// not, nothing where a sliding contact already has its full friction.
template <class P>
struct LocalUpdate {
    PackVec<P> change; ///< N s
    P violation;       ///< m/s, largest of the three rows, each seen at its turn
};

/// Tangential parts.
template <class P>
struct PackVec2 {
    P x, y;
};
template <class P>
inline P length_sq(const PackVec2<P>& a) {
    return a.x * a.x + a.y * a.y;
}
template <class P>
inline P clamp(P x, P bound) {
    return max(min(x, bound), P::all(0) - bound);
}

template <Cone kCone, class P>
inline P friction_bound(const LocalPack<P>& c, P normal_impulse) {
    if constexpr (kCone == Cone::frozen) return c.friction;
    const P of_load = c.friction * normal_impulse;
    if constexpr (kCone != Cone::bounded) return of_load;
    return select(c.friction < P::all(0), P::all(0) - c.friction, of_load);
}

/// The change of the normal impulse that eq. 17 asks for at normal velocity u_n.
template <class P>
inline P normal_change(const LocalPack<P>& c, P u_n) {
    return max(c.impulse.x - (u_n - c.target.x) * c.inv_mass_diagonal.x, P::all(0)) - c.impulse.x;
}

/// `l` where it lies in the disc, else the nearest point of it.
template <class P>
inline PackVec2<P> project_on_disc(const PackVec2<P>& l, P bound) {
    const P size = sqrt(length_sq(l));
    const P shrink = select(bound < size, bound / size, P::all(1));
    return {shrink * l.x, shrink * l.y};
}

/// The tangential impulse of the disc |lambda| <= bound for slip velocity u at the present impulse, W_tt being
/// diagonal. Where the impulse that stops the slip, lambda_old - W^-1 u, lies in the disc it is taken: the minimiser of
/// 1/2 lambda W lambda + b lambda, b = u - W lambda_old. Else a step down that function's gradient by no more than its
/// curvature allows, projected on the disc. Its fixed points are those of Coulomb's law, friction opposite to the slip;
/// neither form of step adds energy.
template <class P>
inline PackVec2<P> disc_impulse(const LocalPack<P>& c, const PackVec2<P>& u, P bound) {
    const PackVec2<P> stick{c.impulse.y - u.x * c.inv_mass_diagonal.y, c.impulse.z - u.y * c.inv_mass_diagonal.z};
    const auto inside = length_sq(stick) <= bound * bound;
    if (mask_bits(mask_not(inside)) == 0) return stick;
    const P step = min(c.inv_mass_diagonal.y, c.inv_mass_diagonal.z); // the inverse of the larger eigenvalue
    const PackVec2<P> slip = project_on_disc({c.impulse.y - u.x * step, c.impulse.z - u.y * step}, bound);
    return {select(inside, stick.x, slip.x), select(inside, stick.y, slip.y)};
}

/// One visit: the change that eqs 17-20 ask for at relative velocity u (of the present impulse). Does not apply it.
template <Cone kCone, class P>
[[gnu::always_inline]] inline LocalUpdate<P> visit(const LocalPack<P>& c, const PackVec<P>& u) {
    LocalUpdate<P> r;
    r.change.x = normal_change(c, u.x);
    const P normal = abs(r.change.x) * c.mass_diagonal.x;
    if constexpr (kCone == Cone::none) {
        r.change.y = r.change.z = P::all(0);
        r.violation = normal;
        return r;
    }
    const P bound = friction_bound<kCone>(c, c.impulse.x + r.change.x);
    const P u1 = (u.y - c.target.y) + c.coupling.x * r.change.x;
    const P u2 = (u.z - c.target.z) + c.coupling.y * r.change.x;
    if constexpr (is_disc(kCone)) {
        const PackVec2<P> l = disc_impulse(c, {u1, u2}, bound);
        r.change.y = l.x - c.impulse.y;
        r.change.z = l.y - c.impulse.z;
    } else {
        r.change.y = clamp(c.impulse.y - u1 * c.inv_mass_diagonal.y, bound) - c.impulse.y;
        const P u2_after = u2 + c.coupling.z * r.change.y;
        r.change.z = clamp(c.impulse.z - u2_after * c.inv_mass_diagonal.z, bound) - c.impulse.z;
    }
    r.violation = max(max(normal, abs(r.change.y) * c.mass_diagonal.y), abs(r.change.z) * c.mass_diagonal.z);
    return r;
}

/// Constraint violation at relative velocity u with nothing applied, m/s: for every row |lambda - P(lambda - u / W)| W,
/// which is zero exactly at a solution of eqs 17-20 (of the disc law, with W the larger tangential diagonal, for
/// Cone::disc). The friction bound is that of the present normal impulse.
template <Cone kCone, class P>
[[gnu::always_inline]] inline P violation(const LocalPack<P>& c, const PackVec<P>& u) {
    const P normal = abs(normal_change(c, u.x)) * c.mass_diagonal.x;
    if constexpr (kCone == Cone::none) return normal;
    const P bound = friction_bound<kCone>(c, c.impulse.x);
    const P u1 = u.y - c.target.y, u2 = u.z - c.target.z;
    PackVec2<P> l, scale{c.mass_diagonal.y, c.mass_diagonal.z};
    if constexpr (is_disc(kCone)) {
        scale.x = scale.y = max(c.mass_diagonal.y, c.mass_diagonal.z);
        const P step = min(c.inv_mass_diagonal.y, c.inv_mass_diagonal.z);
        l = project_on_disc({c.impulse.y - u1 * step, c.impulse.z - u2 * step}, bound);
    } else {
        l = {clamp(c.impulse.y - u1 * c.inv_mass_diagonal.y, bound),
             clamp(c.impulse.z - u2 * c.inv_mass_diagonal.z, bound)};
    }
    return max(max(normal, abs(l.x - c.impulse.y) * scale.x), abs(l.y - c.impulse.z) * scale.y);
}

} // namespace
} // namespace flotilla
