// SPDX-License-Identifier: MIT
// The matrix-free form of the contact system (paper, eqs 15 and 21-22): all contacts of a body pair are one block, solved
// one after the other on velocities that stay in registers.
//
// A visit computes the relative velocity at the contact once, does the three rows on it in the contact's own frame
// (local_contact.hpp) and applies the sum of their impulses once. This is the row by row sweep of [29] in exact
// arithmetic, with a third of the body updates and half of the memory. Blocks of one colour share no movable body: they
// may run in any order, and one block per vector lane does for every lane what this code does.
#pragma once

#include <cstdint>
#include <span>

#include "base/vec3.hpp"
#include "static_contact/local_contact.hpp"

namespace flotilla {

/// A symmetric matrix.
struct Sym3 {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};
constexpr Vec3 operator*(const Sym3& a, const Vec3& v) {
    return {(a.xx * v.x + a.xy * v.y) + a.xz * v.z, (a.xy * v.x + a.yy * v.y) + a.yz * v.z,
            (a.xz * v.x + a.yz * v.y) + a.zz * v.z};
}

/// Velocity of a body while it is solved. A cache line per body, so that parallel blocks never share one.
struct alignas(64) BodyVelocity {
    Vec3 linear; ///< m/s
    double pad_0 = 0;
    Vec3 angular; ///< rad/s
    double pad_1 = 0;
};
static_assert(sizeof(BodyVelocity) == 64);

/// A body pair. Masses are copied in: the sweep then touches velocities and rows only. An inverse mass of 0 means
/// prescribed velocity, read but never written.
struct ContactBlock {
    std::int32_t a = 0, b = 0;             ///< index of the bodies' velocities
    std::int32_t first = 0, end = 0;       ///< rows of the pair
    double inv_mass_a = 0, inv_mass_b = 0; ///< 1/kg
    Sym3 inv_inertia_a, inv_inertia_b;     ///< 1/(kg m^2), world
};
static_assert(sizeof(ContactBlock) == 128);

/// One contact: 29 doubles, read in order once per visit; only the impulse is written.
struct ContactRow {
    LocalContact local;
    Vec3 normal, tangent_1, tangent_2; ///< unit, right-handed
    Vec3 arm_a, arm_b;                 ///< m: contact point minus centre of mass
};
static_assert(sizeof(ContactRow) == 29 * sizeof(double));

/// Components of a world vector in the contact's frame, and back.
inline Vec3 to_contact(const ContactRow& r, const Vec3& v) {
    return {dot(r.normal, v), dot(r.tangent_1, v), dot(r.tangent_2, v)};
}
inline Vec3 to_world(const ContactRow& r, const Vec3& v) {
    return (v.x * r.normal + v.y * r.tangent_1) + v.z * r.tangent_2;
}

/// Velocity of b against a at the contact (eq. 15), world.
inline Vec3 relative_velocity(const ContactRow& r, const BodyVelocity& a, const BodyVelocity& b) {
    return (b.linear + cross(b.angular, r.arm_b)) - (a.linear + cross(a.angular, r.arm_a));
}

/// V += M^-1 J^T l of eq. 22 (the paper leaves out J^T), for a world impulse l on b and -l on a.
inline void apply_impulse(const ContactBlock& block, const ContactRow& r, const Vec3& l, BodyVelocity& a,
                          BodyVelocity& b) {
    a.linear -= block.inv_mass_a * l;
    a.angular -= block.inv_inertia_a * cross(r.arm_a, l);
    b.linear += block.inv_mass_b * l;
    b.angular += block.inv_inertia_b * cross(r.arm_b, l);
}

/// Sets W of the row's frame for the masses of the block.
void set_effective_mass(const ContactBlock& block, ContactRow& row);

/// One sweep over a block in row order; returns the largest violation met, m/s.
template <Cone kCone>
double sweep_block(const ContactBlock& block, std::span<ContactRow> rows, std::span<BodyVelocity> bodies) {
    BodyVelocity& body_a = bodies[static_cast<std::size_t>(block.a)];
    BodyVelocity& body_b = bodies[static_cast<std::size_t>(block.b)];
    BodyVelocity a = body_a, b = body_b;
    double worst = 0;
    for (std::int32_t k = block.first; k < block.end; ++k) {
        ContactRow& row = rows[static_cast<std::size_t>(k)];
        const LocalUpdate update = visit<kCone>(row.local, to_contact(row, relative_velocity(row, a, b)));
        row.local.impulse += update.change;
        apply_impulse(block, row, to_world(row, update.change), a, b);
        worst = std::max(worst, update.violation);
    }
    if (block.inv_mass_a > 0) body_a = a;
    if (block.inv_mass_b > 0) body_b = b;
    return worst;
}

/// The largest violation of a block at the present velocities, m/s; changes nothing.
template <Cone kCone>
double block_violation(const ContactBlock& block, std::span<const ContactRow> rows,
                       std::span<const BodyVelocity> bodies) {
    double worst = 0;
    for (std::int32_t k = block.first; k < block.end; ++k) {
        const ContactRow& row = rows[static_cast<std::size_t>(k)];
        const Vec3 v = relative_velocity(row, bodies[static_cast<std::size_t>(block.a)],
                                         bodies[static_cast<std::size_t>(block.b)]);
        worst = std::max(worst, violation<kCone>(row.local, to_contact(row, v)));
    }
    return worst;
}

/// Applies the rows' present impulses to the velocities: the warm start.
void apply_block(const ContactBlock& block, std::span<const ContactRow> rows, std::span<BodyVelocity> bodies);

} // namespace flotilla
