// SPDX-License-Identifier: MIT
// W of contacts side by side, one in each lane, written once for every vector width. Include after a pack header;
// everything has internal linkage (pack_avx2.hpp).
#pragma once

#include <cstddef>

#include "geometry/pack_vec.hpp"
#include "static_contact/contact_rows.hpp"

namespace flotilla {
namespace {

template <class P>
using LanePointers = const double * [P::kWidth];

/// Three doubles of each lane's item, from `get(item)` on.
template <class P, class Item, class Get>
inline PackVec<P> load_lanes(const Item* const* items, Get&& get) {
    LanePointers<P> from;
    for (int lane = 0; lane < P::kWidth; ++lane) from[lane] = get(items[lane]);
    P out[3];
    load_transposed(from, out);
    return {out[0], out[1], out[2]};
}

template <class P>
struct PackSym3 {
    PackVec<P> diagonal, others; ///< xx yy zz, xy xz yz
};
template <class P>
inline PackVec<P> operator*(const PackSym3<P>& a, const PackVec<P>& v) {
    const auto& [xx, yy, zz] = a.diagonal;
    const auto& [xy, xz, yz] = a.others;
    return {(xx * v.x + xy * v.y) + xz * v.z, (xy * v.x + yy * v.y) + yz * v.z, (xz * v.x + yz * v.y) + zz * v.z};
}

/// What W of a contact is made of, apart from directions.
template <class P>
struct PackMasses {
    PackVec<P> arm_a, arm_b;
    PackSym3<P> inv_inertia_a, inv_inertia_b;
    P inv_mass; ///< of both together
};

/// What an impulse along a direction turns: arm x direction, and the inverse inertia times it, of both bodies.
template <class P>
struct PackTorques {
    PackVec<P> a, b, inv_a, inv_b;

    PackTorques(const PackMasses<P>& m, const PackVec<P>& direction)
        : a(cross(m.arm_a, direction)),
          b(cross(m.arm_b, direction)),
          inv_a(m.inv_inertia_a * a),
          inv_b(m.inv_inertia_b * b) {}
};
template <class P>
inline P product(const PackTorques<P>& p, const PackTorques<P>& q) {
    return dot(p.a, q.inv_a) + dot(p.b, q.inv_b);
}

template <class P>
struct PackMass {
    PackVec<P> diagonal, coupling; ///< as LocalContact has them
};
template <class P>
inline PackMass<P> effective_mass(const PackMasses<P>& m, const PackTorques<P>& n, const PackVec<P>& tangent_1,
                                  const PackVec<P>& tangent_2) {
    const PackTorques<P> t1(m, tangent_1), t2(m, tangent_2);
    return {{m.inv_mass + product(n, n), m.inv_mass + product(t1, t1), m.inv_mass + product(t2, t2)},
            {product(n, t1), product(n, t2), product(t1, t2)}};
}

/// principal_turn().
template <class P>
inline void principal_turn(P w11, P w22, P w12, P& cosine, P& sine) {
    const P zero = P::all(0), one = P::all(1);
    const P tau = (w22 - w11) / (P::all(2) * w12);
    const P t = flip_sign(one, tau) / (abs(tau) + sqrt(one + tau * tau));
    const P c = one / sqrt(one + t * t);
    const auto none = mask_and(w12 <= zero, zero <= w12);
    cosine = select(none, one, c);
    sine = select(none, zero, flip_sign(t, P::all(-1)) * c);
}

template <class P>
inline PackMasses<P> load_masses(const ContactBlock* const* blocks, const ContactRow* const* rows) {
    PackMasses<P> m;
    m.arm_a = load_lanes<P>(rows, [](const ContactRow* r) { return &r->arm_a.x; });
    m.arm_b = load_lanes<P>(rows, [](const ContactRow* r) { return &r->arm_b.x; });
    const auto inertia = [&](auto&& get) {
        return PackSym3<P>{load_lanes<P>(blocks, [&](const ContactBlock* b) { return &get(b).xx; }),
                           load_lanes<P>(blocks, [&](const ContactBlock* b) { return &get(b).xy; })};
    };
    m.inv_inertia_a = inertia([](const ContactBlock* b) -> const Sym3& { return b->inv_inertia_a; });
    m.inv_inertia_b = inertia([](const ContactBlock* b) -> const Sym3& { return b->inv_inertia_b; });
    double inv_mass[P::kWidth];
    for (int lane = 0; lane < P::kWidth; ++lane) inv_mass[lane] = blocks[lane]->inv_mass_a + blocks[lane]->inv_mass_b;
    m.inv_mass = P::load(inv_mass);
    return m;
}

/// Puts the mass and the tangents in the rows of the lanes whose bits are set. What follows them in a row is written as
/// well: the impulse becomes 0, the arm what it is.
template <class P>
inline void store_masses(const PackMass<P>& w, const PackVec<P>& t1, const PackVec<P>& t2, const PackVec<P>& arm_a,
                         unsigned which, ContactRow* const* rows) {
    static_assert(offsetof(LocalContact, impulse) == 9 * sizeof(double));
    static_assert(offsetof(ContactRow, tangent_2) - offsetof(ContactRow, tangent_1) == 3 * sizeof(double));
    static_assert(offsetof(ContactRow, arm_a) - offsetof(ContactRow, tangent_1) == 6 * sizeof(double));
    const auto store = [&](P a, P b, P c, P d, std::size_t first, auto&& get) {
        const P four[4] = {a, b, c, d};
        double* to[P::kWidth];
        for (int lane = 0; lane < P::kWidth; ++lane) to[lane] = get(rows[lane]) + first;
        store_transposed(four, which, to);
    };
    const auto mass = [](ContactRow* r) { return &r->local.mass_diagonal.x; };
    const auto tangent = [](ContactRow* r) { return &r->tangent_1.x; };
    const P zero = P::all(0), one = P::all(1);
    store(w.diagonal.x, w.diagonal.y, w.diagonal.z, one / w.diagonal.x, 0, mass);
    store(one / w.diagonal.y, one / w.diagonal.z, w.coupling.x, w.coupling.y, 4, mass);
    store(w.coupling.z, zero, zero, zero, 8, mass);
    store(t1.x, t1.y, t1.z, t2.x, 0, tangent);
    store(t2.y, t2.z, arm_a.x, arm_a.y, 4, tangent);
}

template <class P>
inline PackVec<P> normals_of(const ContactRow* const* rows) {
    return load_lanes<P>(rows, [](const ContactRow* r) { return &r->normal.x; });
}
template <class P>
inline PackVec<P> first_tangents_of(const ContactRow* const* rows) {
    return load_lanes<P>(rows, [](const ContactRow* r) { return &r->tangent_1.x; });
}
template <class P>
inline PackVec<P> second_tangents_of(const ContactRow* const* rows) {
    return load_lanes<P>(rows, [](const ContactRow* r) { return &r->tangent_2.x; });
}

/// W in the rows' own frames, one in each lane.
template <class P>
inline PackMass<P> effective_masses_any(const ContactBlock* const* blocks, const ContactRow* const* rows) {
    const PackMasses<P> m = load_masses<P>(blocks, rows);
    return effective_mass(m, PackTorques<P>(m, normals_of<P>(rows)), first_tangents_of<P>(rows),
                          second_tangents_of<P>(rows));
}

/// set_principal_mass() of one row in each lane, those whose bits are set in `which`; the others repeat one of them.
template <class P>
inline void set_principal_masses_any(const ContactBlock* const* blocks, ContactRow* const* rows, unsigned which) {
    const PackMasses<P> m = load_masses<P>(blocks, rows);
    const PackTorques<P> n(m, normals_of<P>(rows));
    PackVec<P> t1 = first_tangents_of<P>(rows), t2 = second_tangents_of<P>(rows);
    P c, s;
    {
        const PackTorques<P> p(m, t1), q(m, t2);
        principal_turn(m.inv_mass + product(p, p), m.inv_mass + product(q, q), product(p, q), c, s);
    }
    const PackVec<P> was = t1;
    t1 = c * was + s * t2;
    t2 = c * t2 - s * was;
    store_masses(effective_mass(m, n, t1, t2), t1, t2, m.arm_a, which, rows);
}

} // namespace
} // namespace flotilla
