// SPDX-License-Identifier: MIT
#include "static_contact/cone_program.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.hpp"
#include "static_contact/lorentz_cone.hpp"

namespace flotilla {
namespace {

Vec3 to_contact(const ConeContact& c, const Vec3& v) {
    return {dot(c.normal, v), dot(c.tangent_1, v), dot(c.tangent_2, v)};
}
Vec3 to_world(const ConeContact& c, const Vec3& v) { return (v.x * c.normal + v.y * c.tangent_1) + v.z * c.tangent_2; }

struct InertiaFactor {
    std::array<Vec3, 3> columns;
    std::int32_t rank = 0;
};

// Columns l_k with A = sum l_k l_k^T: Cholesky with the largest pivot first, which keeps what a needle's inertia has of
// small digits; directions whose remainder is rounding are left out.
InertiaFactor factor_inertia(Mat3 a) {
    InertiaFactor f;
    const double rounding = 0x1p-52 * std::max({a.m[0], a.m[4], a.m[8]});
    for (std::size_t k = 0; k < 3; ++k) {
        std::size_t pivot = 0;
        for (std::size_t i = 1; i < 3; ++i)
            if (a.m[4 * i] > a.m[4 * pivot]) pivot = i;
        if (!(a.m[4 * pivot] > rounding)) break;
        const Vec3 column = row(a, static_cast<int>(pivot)) / std::sqrt(a.m[4 * pivot]);
        a = a - outer(column, column);
        for (std::size_t i = 0; i < 3; ++i) a.m[3 * pivot + i] = a.m[3 * i + pivot] = 0;
        f.columns[k] = column;
        ++f.rank;
    }
    return f;
}

// The rows of one contact in the columns of one of its bodies, which start at `column`.
void add_body(const ConeContact& c, const ConeBody& body, const Vec3& arm, double sign, std::int32_t column,
              ConeProgram& p) {
    if (body.inv_mass > 0) {
        const double root = sign * std::sqrt(body.inv_mass);
        for (int axis = 0; axis < 3; ++axis, ++column)
            if (!is_locked(body.locked, axis))
                p.entries.push_back({column, root * Vec3{component(c.normal, axis), component(c.tangent_1, axis),
                                                         component(c.tangent_2, axis)}});
    }
    const InertiaFactor f = factor_inertia(body.inv_inertia);
    for (std::size_t k = 0; k < at(f.rank); ++k)
        p.entries.push_back({column++, sign * to_contact(c, cross(f.columns[k], arm))});
}

Vec3 body_diagonal(const ConeContact& c, const ConeBody& body, const Vec3& arm) {
    const auto along = [&](const Vec3& direction) {
        const Vec3 turn = cross(arm, direction);
        const double free = body.locked == 0 ? 1.0 : length_sq(free_part(body.locked, direction));
        return body.inv_mass * free + dot(turn, body.inv_inertia * turn);
    };
    return {along(c.normal), along(c.tangent_1), along(c.tangent_2)};
}

} // namespace

void ConeProgram::clear() {
    num_columns = 0;
    contacts.clear();
    first_entry.assign(1, 0);
    entries.clear();
}

void build_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, ConeProgram& program,
                        std::vector<ConeDiagonal>& diagonals) {
    program.clear();
    diagonals.clear();
    // Six columns per body: those of directions in which it does not move stay empty, and cost nothing but a unit
    // pivot.
    program.num_columns = static_cast<std::int32_t>(6 * bodies.size());
    for (const ConeContact& c : contacts) {
        Vec3 w;
        const auto add = [&](std::int32_t body, const Vec3& arm, double sign) {
            if (body < 0) return;
            add_body(c, bodies[at(body)], arm, sign, 6 * body, program);
            w += body_diagonal(c, bodies[at(body)], arm);
        };
        add(c.a, c.arm_a, -1);
        add(c.b, c.arm_b, 1);
        program.contacts.push_back({c.free_velocity, c.friction, c.pressed, c.bound});
        program.first_entry.push_back(static_cast<std::int32_t>(program.entries.size()));
        diagonals.push_back({w.x, std::max(w.y, w.z)});
    }
}

void set_diagonals(const ConeProgram& program, std::vector<ConeDiagonal>& diagonals) {
    diagonals.clear();
    for (std::size_t i = 0; i < program.contacts.size(); ++i) {
        Vec3 w;
        for (std::size_t k = at(program.first_entry[i]); k < at(program.first_entry[i + 1]); ++k) {
            const Vec3& h = program.entries[k].h;
            w += {h.x * h.x, h.y * h.y, h.z * h.z};
        }
        diagonals.push_back({w.x, std::max(w.y, w.z)});
    }
}

void cone_velocities(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, std::span<const Vec3> r,
                     std::vector<ConeMotion>& motion, std::span<Vec3> u) {
    motion.assign(bodies.size(), {});
    const auto push = [&](std::int32_t body, const Vec3& arm, const Vec3& impulse) {
        if (body < 0) return;
        motion[at(body)].linear += impulse;
        motion[at(body)].angular += cross(arm, impulse);
    };
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Vec3 impulse = to_world(contacts[i], r[i]);
        push(contacts[i].a, contacts[i].arm_a, -impulse);
        push(contacts[i].b, contacts[i].arm_b, impulse);
    }
    for (std::size_t k = 0; k < bodies.size(); ++k)
        motion[k] = {free_part(bodies[k].locked, bodies[k].inv_mass * motion[k].linear),
                     bodies[k].inv_inertia * motion[k].angular};
    const auto point = [&](std::int32_t body, const Vec3& arm) {
        return body < 0 ? Vec3{} : motion[at(body)].linear + cross(motion[at(body)].angular, arm);
    };
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const ConeContact& c = contacts[i];
        u[i] = c.free_velocity + to_contact(c, point(c.b, c.arm_b) - point(c.a, c.arm_a));
    }
}

double cone_violation(const ConeDiagonal& w, double friction, const Vec3& r, const Vec3& u, double given) {
    if (!(w.normal > 0)) return 0;
    const double normal = std::abs(std::max(r.x - u.x / w.normal, 0.0) - r.x) * w.normal;
    if (!(w.tangential > 0)) return normal;
    const Vec3 z{0, r.y - u.y / w.tangential, r.z - u.z / w.tangential};
    const double bound = friction * r.x + given, size = tangential_length(z), f = size > bound ? bound / size : 1;
    const double tangential = tangential_length({0, f * z.y - r.y, f * z.z - r.z}) * w.tangential;
    return normal >= tangential ? normal : tangential; // tangential too where it is no number
}

} // namespace flotilla
