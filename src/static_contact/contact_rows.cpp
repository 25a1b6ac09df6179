// SPDX-License-Identifier: MIT
#include "static_contact/contact_rows.hpp"

#include <algorithm>
#include <cmath>

namespace flotilla {
namespace {

/// What an impulse along a direction turns: arm x direction, and the inverse inertia times it, of both bodies.
struct Torques {
    Vec3 a, b, inv_a, inv_b;

    Torques(const ContactBlock& block, const ContactRow& row, const Vec3& direction)
        : a(cross(row.arm_a, direction)),
          b(cross(row.arm_b, direction)),
          inv_a(block.inv_inertia_a * a),
          inv_b(block.inv_inertia_b * b) {}
};

double product(const Torques& p, const Torques& q) { return dot(p.a, q.inv_a) + dot(p.b, q.inv_b); }

double inverse_mass(const ContactBlock& block) { return block.inv_mass_a + block.inv_mass_b; }

void set_mass(double m, const Torques& n, const Torques& t1, const Torques& t2, LocalContact& c) {
    c.mass_diagonal = {m + product(n, n), m + product(t1, t1), m + product(t2, t2)};
    c.inv_mass_diagonal = {1 / c.mass_diagonal.x, 1 / c.mass_diagonal.y, 1 / c.mass_diagonal.z};
    c.coupling = {product(n, t1), product(n, t2), product(t1, t2)};
}

} // namespace

void set_effective_mass(const ContactBlock& block, ContactRow& row) {
    const Torques n(block, row, row.normal), t1(block, row, row.tangent_1), t2(block, row, row.tangent_2);
    set_mass(inverse_mass(block), n, t1, t2, row.local);
}

void set_normal_mass(const ContactBlock& block, ContactRow& row) {
    const Vec3 turn_a = cross(row.arm_a, row.normal), turn_b = cross(row.arm_b, row.normal);
    const double w =
        inverse_mass(block) + (dot(turn_a, block.inv_inertia_a * turn_a) + dot(turn_b, block.inv_inertia_b * turn_b));
    row.local.mass_diagonal = {w, 1, 1};
    row.local.inv_mass_diagonal = {1 / w, 1, 1};
    row.local.coupling = {};
}

void set_principal_mass(const ContactBlock& block, ContactRow& row) {
    const double m = inverse_mass(block);
    const Torques n(block, row, row.normal);
    {
        const Torques t1(block, row, row.tangent_1), t2(block, row, row.tangent_2);
        row.local.mass_diagonal = {0, m + product(t1, t1), m + product(t2, t2)};
        row.local.coupling = {0, 0, product(t1, t2)};
        turn_tangents(principal_turn(row.local), row);
    }
    set_mass(m, n, {block, row, row.tangent_1}, {block, row, row.tangent_2}, row.local);
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
    const double bound = friction * n;
    if (cone != Cone::disc) return {n, std::clamp(impulse.y, -bound, bound), std::clamp(impulse.z, -bound, bound)};
    const double size = std::sqrt(impulse.y * impulse.y + impulse.z * impulse.z);
    const double shrink = size > bound ? bound / size : 1.0;
    return {n, shrink * impulse.y, shrink * impulse.z};
}

} // namespace flotilla
