// SPDX-License-Identifier: MIT
// A frictional contact problem, u = q + W r, given by bodies or by a factor H of W = H H^T. Vectors of a contact are in
// its frame: x along the normal, y and z along the tangents.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/axis_locks.hpp"

namespace flotilla {

/// A body that the impulses may move.
struct ConeBody {
    double inv_mass = 0; ///< 1/kg, >= 0
    Mat3 inv_inertia;    ///< 1/(kg m^2), world, symmetric and positive semidefinite
    AxisMask locked = 0; ///< axes along which it does not move
};

struct ConeContact {
    std::int32_t a = -1, b = -1; ///< index of the bodies, -1: infinite mass. The impulse acts on b, its opposite on a
    Vec3 normal, tangent_1, tangent_2; ///< orthonormal
    Vec3 arm_a, arm_b;                 ///< m: contact point minus centre of mass
    double friction = 0;               ///< mu >= 0
    Vec3 free_velocity;                ///< m/s: of b against a without any impulse, less the normal target
    bool pressed = false;              ///< a script presses at it
    double bound = 0;                  ///< N s, >= 0: of friction, beside mu r_n
};

/// A column of H is a degree of freedom, in coordinates in which its mass is 1.
struct ConeProgram {
    struct Entry {
        std::int32_t column = 0;
        Vec3 h; ///< kg^-1/2: the contact's three rows in this column
    };
    struct Contact {
        Vec3 q; ///< m/s
        double friction = 0;
        bool pressed = false;
        double bound = 0; ///< N s
    };
    std::int32_t num_columns = 0;
    std::vector<Contact> contacts;
    std::vector<std::int32_t> first_entry{0}; ///< of each contact, and the end of the last
    std::vector<Entry> entries;               ///< no column twice in a contact

    void clear();
};

/// The diagonal of a contact's own block of W, 1/kg. Both are 0 where no body can be moved.
struct ConeDiagonal {
    double normal = 0, tangential = 0; ///< W_nn, max(W_11, W_22)
};

/// Linear and angular parts of the bodies' motion, or of the impulses on them.
struct ConeMotion {
    Vec3 linear, angular;
};

/// Fills the program and the diagonals. H is accurate to rounding relative to the largest inverse inertia of a body;
/// the diagonals and cone_velocities() use the inertia as given.
void build_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, ConeProgram& program,
                        std::vector<ConeDiagonal>& diagonals);

/// The diagonals of a program.
void set_diagonals(const ConeProgram& program, std::vector<ConeDiagonal>& diagonals);

/// u = q + W r.
void cone_velocities(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts, std::span<const Vec3> r,
                     std::vector<ConeMotion>& motion, std::span<Vec3> u);

/// How far a contact is from the law, m/s: |r_n - max(r_n - u_n / W_nn, 0)| W_nn or |r_t - P(r_t - u_t / W_t)| W_t,
/// whichever is larger, where P projects on the disc of radius mu r_n + given. It is zero exactly where the law holds,
/// and is the `violation` of local_contact.hpp for Cone::disc.
double cone_violation(const ConeDiagonal& w, double friction, const Vec3& r, const Vec3& u, double given = 0);

} // namespace flotilla
