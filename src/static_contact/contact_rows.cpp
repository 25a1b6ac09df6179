// SPDX-License-Identifier: MIT
#include "geometry/pack_scalar.hpp"

#include "static_contact/contact_rows.hpp"

#include <algorithm>
#include <cmath>

#include "static_contact/contact_rows_kernel.hpp"

namespace flotilla {

void set_effective_mass(const ContactBlock& block, ContactRow& row) {
    const ContactBlock* const blocks[] = {&block};
    const ContactRow* const rows[] = {&row};
    const PackMass<ScalarPack> w = effective_masses_any<ScalarPack>(blocks, rows);
    const auto vec = [](const PackVec<ScalarPack>& v) { return Vec3{v.x.v, v.y.v, v.z.v}; };
    LocalContact& c = row.local;
    c.mass_diagonal = vec(w.diagonal);
    c.inv_mass_diagonal = {1 / c.mass_diagonal.x, 1 / c.mass_diagonal.y, 1 / c.mass_diagonal.z};
    c.coupling = vec(w.coupling);
}

void set_normal_mass(const ContactBlock& block, ContactRow& row) {
    const Vec3 turn_a = cross(row.arm_a, row.normal), turn_b = cross(row.arm_b, row.normal);
    const double w = (block.inv_mass_a + block.inv_mass_b) +
                     (dot(turn_a, block.inv_inertia_a * turn_a) + dot(turn_b, block.inv_inertia_b * turn_b));
    row.local.mass_diagonal = {w, 1, 1};
    row.local.inv_mass_diagonal = {1 / w, 1, 1};
    row.local.coupling = {};
}

void set_principal_mass(const ContactBlock& block, ContactRow& row) {
    const ContactBlock* const blocks[] = {&block};
    ContactRow* const rows[] = {&row};
    set_principal_masses_any<ScalarPack>(blocks, rows, 1);
}

void PrincipalMasses::add(const ContactBlock& block, ContactRow& row) {
    if (isa_ == Isa::scalar) return set_principal_mass(block, row);
    blocks_[waiting_] = &block;
    rows_[waiting_++] = &row;
    if (waiting_ == kLanes) flush();
}

void PrincipalMasses::flush() {
    if (waiting_ == 0) return;
    for (int lane = waiting_; lane < kLanes; ++lane) {
        blocks_[lane] = blocks_[0];
        rows_[lane] = rows_[0];
    }
#if defined(__x86_64__)
    set_principal_masses_avx2(blocks_, rows_, (1U << waiting_) - 1);
#endif
    waiting_ = 0;
}

namespace {

/// 1/kg: what a unit impulse along d changes of the relative velocity along e.
double coupling(const ContactBlock& block, const ContactRow& row, const Vec3& d, const Vec3& e) {
    const auto one = [&](double inv_mass, const Sym3& inv_inertia, AxisMask locked, const Vec3& arm) {
        return inv_mass * dot(free_part(locked, d), e) + dot(cross(arm, d), inv_inertia * cross(arm, e));
    };
    return one(block.inv_mass_a, block.inv_inertia_a, block.locked_a, row.arm_a) +
           one(block.inv_mass_b, block.inv_inertia_b, block.locked_b, row.arm_b);
}

void set_tangential_masses(const ContactBlock& block, ContactRow& row) {
    const Vec3 &t1 = row.tangent_1, &t2 = row.tangent_2;
    row.local.mass_diagonal.y = coupling(block, row, t1, t1);
    row.local.mass_diagonal.z = coupling(block, row, t2, t2);
    row.local.coupling = {coupling(block, row, row.normal, t1), coupling(block, row, row.normal, t2),
                          coupling(block, row, t1, t2)};
}

} // namespace

void set_locked_mass(Cone cone, const ContactBlock& block, ContactRow& row) {
    const double least = kLeastMobility * (block.inv_mass_a + block.inv_mass_b);
    LocalContact& c = row.local;
    c.impulse = c.coupling = {};
    c.mass_diagonal = {coupling(block, row, row.normal, row.normal), 1, 1};
    c.inv_mass_diagonal = {1 / c.mass_diagonal.x, 0, 0};
    if (!(c.mass_diagonal.x > least)) {
        c.mass_diagonal.x = 1;
        c.inv_mass_diagonal.x = 0;
        return;
    }
    if (cone == Cone::none) return;
    set_tangential_masses(block, row);
    if (is_disc(cone)) {
        turn_tangents(principal_turn(c), row);
        set_tangential_masses(block, row);
    }
    const double larger = std::max(c.mass_diagonal.y, c.mass_diagonal.z);
    for (double* w : {&c.mass_diagonal.y, &c.mass_diagonal.z})
        if (!(*w > kLeastMobility * larger)) *w = larger;
    c.inv_mass_diagonal.y = larger > least ? 1 / c.mass_diagonal.y : 0;
    c.inv_mass_diagonal.z = larger > least ? 1 / c.mass_diagonal.z : 0;
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
    if (cone == Cone::none) return {n, 0, 0};
    const double bound = friction_bound(cone, friction, n);
    if (!is_disc(cone)) return {n, std::clamp(impulse.y, -bound, bound), std::clamp(impulse.z, -bound, bound)};
    const double size = std::sqrt(impulse.y * impulse.y + impulse.z * impulse.z);
    const double shrink = size > bound ? bound / size : 1.0;
    return {n, shrink * impulse.y, shrink * impulse.z};
}

} // namespace flotilla
