// SPDX-License-Identifier: MIT
// Contacts and body pairs as the set-up sees them, one at a time. For the sweeps they are packed (contact_packets.hpp).
#pragma once

#include <cstdint>

#include "base/axis_locks.hpp"
#include "geometry/ccd.hpp"

namespace flotilla {

/// Shape of the friction bound.
enum class Cone : std::uint8_t {
    pyramid, ///< |lambda_1| <= mu lambda_n, |lambda_2| <= mu lambda_n (eqs 18-20)
    disc,    ///< |(lambda_1, lambda_2)| <= mu lambda_n; tangents are turned so that W_12 = 0
    bounded, ///< disc, where friction is below zero with a given bound instead of mu lambda_n: bodies are raised
    frozen,  ///< pyramid with a given bound: shock propagation
    none,    ///< no friction at all: the normal's row alone
};

/// Components x, y, z of a vector in contact coordinates are normal, tangent 1, tangent 2.
struct LocalContact {
    Vec3 mass_diagonal;     ///< 1/kg: W_nn, W_11, W_22, each > 0
    Vec3 inv_mass_diagonal; ///< kg: their inverses
    Vec3 coupling;          ///< 1/kg: W_n1, W_n2, W_12
    Vec3 impulse;           ///< N s: lambda_n >= 0, lambda_1, lambda_2
    Vec3 target;            ///< m/s: u_n >= target.x; friction brings u_1, u_2 to the others
    double friction = 0;    ///< mu; with Cone::frozen the bound, N s, with Cone::bounded mu or minus the bound
};

/// A symmetric matrix.
struct Sym3 {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};
constexpr Vec3 operator*(const Sym3& a, const Vec3& v) {
    return {(a.xx * v.x + a.xy * v.y) + a.xz * v.z, (a.xy * v.x + a.yy * v.y) + a.yz * v.z,
            (a.xz * v.x + a.yz * v.y) + a.zz * v.z};
}

/// Velocity of a body while it is solved. A cache line per body, so that parallel packets never share one.
///
/// No component is ever -0: the copy from the world adds +0, and a sum is -0 only where both parts are. Adding a zero
/// impulse of either sign then changes no bit, which is what lets a packet's idle lanes run along.
struct alignas(64) BodyVelocity {
    Vec3 linear; ///< m/s
    double pad_0 = 0;
    Vec3 angular; ///< rad/s
    double pad_1 = 0;
};
static_assert(sizeof(BodyVelocity) == 64);

/// A body pair with its masses. An inverse mass of 0 means prescribed velocity, read but never written.
struct ContactBlock {
    std::int32_t a = 0, b = 0;             ///< index of the bodies' velocities
    std::int32_t first = 0, end = 0;       ///< rows of the pair
    std::int32_t parked = 0;               ///< the first inactive one, see solve_contacts.hpp
    std::int32_t color = 0;                ///< blocks of one colour share no movable body
    double inv_mass_a = 0, inv_mass_b = 0; ///< 1/kg
    Sym3 inv_inertia_a, inv_inertia_b;     ///< 1/(kg m^2), world
    AxisMask locked_a = 0, locked_b = 0;   ///< axes along which a body does not move
    Vec3 offset;                           ///< m: centre of mass of a minus that of b, as the contacts see them
};

/// One contact.
struct ContactRow {
    LocalContact local;
    Vec3 normal, tangent_1, tangent_2; ///< unit, right-handed: tangent_2 = normal x tangent_1
    Vec3 arm_a, arm_b; ///< m: contact point minus centre of mass; arm_b = arm_a + offset of the pair + across
    Vec3 across;       ///< m (Contact)
};

/// Whether the tangents are turned to the principal axes of W_tt.
constexpr bool is_disc(Cone cone) { return cone == Cone::disc || cone == Cone::bounded; }
/// N s, of a contact's friction.
constexpr double friction_bound(Cone cone, double friction, double normal_impulse) {
    if (cone == Cone::frozen) return friction;
    return cone == Cone::bounded && friction < 0 ? -friction : friction * normal_impulse;
}

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

/// A turn of both tangents about the normal.
struct TangentTurn {
    double cosine = 1, sine = 0;
};
/// That to the principal axes of W_tt: W_12 = 0 then, and one step of the disc is the same whatever the tangents were.
/// By less than an eighth of a turn (Jacobi's rotation).
TangentTurn principal_turn(const LocalContact& contact);
/// Sets the tangents only: set_effective_mass() belongs after it.
void turn_tangents(const TangentTurn& turn, ContactRow& row);

/// Sets W of the row's frame for the masses of the block.
void set_effective_mass(const ContactBlock& block, ContactRow& row);
/// W_nn alone: the rest is that of a row without contact.
void set_normal_mass(const ContactBlock& block, ContactRow& row);
/// Turns the tangents to the principal axes of W_tt before. Sets the impulse to zero.
void set_principal_mass(const ContactBlock& block, ContactRow& row);
/// Each of the three, whichever goes with the cone, where a body is locked along some axis. Along a normal that no
/// impulse moves the row does nothing. Along one of two tangents the friction goes by the other one's mass: the slip
/// that no impulse changes takes its part of the disc.
void set_locked_mass(Cone cone, const ContactBlock& block, ContactRow& row);

/// set_principal_mass() of many rows, several at a time: add() asks for one, flush() does what is left.
class PrincipalMasses {
  public:
    explicit PrincipalMasses(Isa isa) : isa_(isa) {}
    /// Both must stay until they are done.
    void add(const ContactBlock& block, ContactRow& row);
    void flush();

  private:
    static constexpr int kLanes = 4;
    Isa isa_;
    int waiting_ = 0;
    const ContactBlock* blocks_[kLanes] = {};
    ContactRow* rows_[kLanes] = {};
};

/// Of four lanes, compiled for AVX2; call only where the processor has it. `which`: a bit for each lane that is wanted;
/// the others repeat one.
void set_principal_masses_avx2(const ContactBlock* const* blocks, ContactRow* const* rows, unsigned which);

/// The impulse nearest to a given one (contact coordinates) that the bounds allow: what a warm start may begin with.
Vec3 cut_to_cone(Cone cone, const Vec3& impulse, double friction);

} // namespace flotilla
