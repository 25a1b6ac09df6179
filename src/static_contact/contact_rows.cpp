// SPDX-License-Identifier: MIT
#include "static_contact/contact_rows.hpp"

#include <algorithm>
#include <cmath>

namespace flotilla {
namespace {

struct FrameTorques {
    Vec3 n, t1, t2;             ///< arm x direction
    Vec3 inv_n, inv_t1, inv_t2; ///< inverse inertia times it
};

FrameTorques frame_torques(const ContactRow& r, const Vec3& arm, const Sym3& inv_inertia) {
    FrameTorques f;
    f.n = cross(arm, r.normal);
    f.t1 = cross(arm, r.tangent_1);
    f.t2 = cross(arm, r.tangent_2);
    f.inv_n = inv_inertia * f.n;
    f.inv_t1 = inv_inertia * f.t1;
    f.inv_t2 = inv_inertia * f.t2;
    return f;
}

} // namespace

void set_effective_mass(const ContactBlock& block, ContactRow& row) {
    const FrameTorques a = frame_torques(row, row.arm_a, block.inv_inertia_a);
    const FrameTorques b = frame_torques(row, row.arm_b, block.inv_inertia_b);
    const double m = block.inv_mass_a + block.inv_mass_b;
    LocalContact& c = row.local;
    c.mass_diagonal = {m + (dot(a.n, a.inv_n) + dot(b.n, b.inv_n)), m + (dot(a.t1, a.inv_t1) + dot(b.t1, b.inv_t1)),
                       m + (dot(a.t2, a.inv_t2) + dot(b.t2, b.inv_t2))};
    c.inv_mass_diagonal = {1 / c.mass_diagonal.x, 1 / c.mass_diagonal.y, 1 / c.mass_diagonal.z};
    c.coupling = {dot(a.n, a.inv_t1) + dot(b.n, b.inv_t1), dot(a.n, a.inv_t2) + dot(b.n, b.inv_t2),
                  dot(a.t1, a.inv_t2) + dot(b.t1, b.inv_t2)};
}

TangentTurn principal_turn(const LocalContact& c) {
    const double w12 = c.coupling.z;
    if (w12 == 0) return {};
    const double tau = (c.mass_diagonal.z - c.mass_diagonal.y) / (2 * w12);
    const double t =
        std::copysign(1.0, tau) / (std::abs(tau) + std::sqrt(1 + tau * tau)); // the smaller of the two turns
    const double cosine = 1 / std::sqrt(1 + t * t);
    return {cosine, -t * cosine};
}

void turn_tangents(const TangentTurn& turn, ContactRow& row) {
    const auto [c, s] = turn;
    const Vec3 t1 = row.tangent_1, t2 = row.tangent_2;
    row.tangent_1 = c * t1 + s * t2;
    row.tangent_2 = c * t2 - s * t1;
}

Vec3 cut_to_cone(Cone cone, const Vec3& impulse, double friction) {
    const double n = std::max(0.0, impulse.x);
    const double bound = friction * n;
    if (cone != Cone::disc) return {n, std::clamp(impulse.y, -bound, bound), std::clamp(impulse.z, -bound, bound)};
    const double size = std::sqrt(impulse.y * impulse.y + impulse.z * impulse.z);
    const double shrink = size > bound ? bound / size : 1.0;
    return {n, shrink * impulse.y, shrink * impulse.z};
}

} // namespace flotilla
