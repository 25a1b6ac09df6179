// SPDX-License-Identifier: MIT
// Exact solve of small frictional contact problems, whatever the mass ratio, the redundancy of the contacts and the friction:
// what the sweeps (solve_contacts.hpp) only approach, in some ten factorisations of a matrix as large as the bodies.
//
// The law of a contact, in its frame (n, t1, t2), for its impulse r and its relative velocity u = q + W r:
//     0 <= r_n  perpendicular to  u_n >= 0,   |r_t| <= mu r_n,   r_t = -mu r_n u_t / |u_t| where u_t != 0.
// How it is solved is told in interior_point.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/vec3.hpp"

namespace flotilla {

/// A body that the impulses may move.
struct ConeBody {
    double inv_mass = 0; ///< 1/kg, >= 0
    Mat3 inv_inertia;    ///< 1/(kg m^2), world, symmetric and positive semidefinite
};

struct ConeContact {
    std::int32_t a = -1, b = -1;       ///< index of the bodies, -1: infinite mass. The impulse acts on b, its opposite on a
    Vec3 normal, tangent_1, tangent_2; ///< orthonormal
    Vec3 arm_a, arm_b;                 ///< m: contact point minus centre of mass
    double friction = 0;               ///< mu >= 0
    Vec3 free_velocity;                ///< m/s, contact frame: of b against a without any impulse, less the normal target
};

/// The same problem without bodies: u = q + H H^T r. A column of H is a degree of freedom in coordinates where its mass is 1.
struct ConeProgram {
    struct Entry {
        std::int32_t column = 0;
        Vec3 h; ///< kg^-1/2: what the contact's rows n, t1, t2 have in the column
    };
    struct Contact {
        Vec3 q; ///< m/s
        double friction = 0;
    };
    std::int32_t num_columns = 0;
    std::vector<Contact> contacts;
    std::vector<std::int32_t> first_entry; ///< of each contact, and the end of the last
    std::vector<Entry> entries;            ///< columns ascending and distinct within a contact

    void clear();
};

struct ConeSolveOptions {
    double tolerance = 0;     ///< m/s: residual asked for
    int max_iterations = 100; ///< factorisations in all
};

struct ConeSolveStats {
    int iterations = 0;  ///< factorisations
    double residual = 0; ///< m/s, see cone_residual(); infinite where the problem holds something that is not finite
    bool solved = false; ///< residual <= tolerance
};

/// Working memory, to be kept from solve to solve: a solve no larger than those before it allocates next to nothing.
class ConeScratch {
  public:
    ConeScratch();
    ~ConeScratch();
    ConeScratch(ConeScratch&&) noexcept;
    ConeScratch& operator=(ConeScratch&&) noexcept;
    struct Storage;
    Storage& storage() { return *storage_; }

  private:
    std::unique_ptr<Storage> storage_;
};

/// Solves for the impulses (N s, contact frame). Their input values are an estimate to start from, zero where there is none.
///
/// Guarantees, solved or not: r_n >= 0 and |r_t| <= mu r_n to the last bit but one; a residual no larger than that of the
/// estimate cut to the cones, nor than that of r = 0; at most options.max_iterations factorisations; the same bits for the
/// same input; and the same result in other units, exactly where lengths and times are scaled by powers of two and masses
/// by powers of four. A problem without solution, which a large friction can make, ends unsolved with the best r met.
ConeSolveStats solve_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                  const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch);
ConeSolveStats solve_cone_program(const ConeProgram& program, const ConeSolveOptions& options,
                                  std::span<Vec3> impulses, ConeScratch& scratch);

/// The largest over the contacts of |r_n - max(r_n - u_n / W_nn, 0)| W_nn and |r_t - P(r_t - u_t / W_t)| W_t, m/s, where P
/// projects on the disc of radius mu r_n, W is the contact's own block and W_t its larger tangential diagonal element: zero
/// exactly where the law holds, and the `violation` of local_contact.hpp with Cone::disc.
double cone_residual(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                     std::span<const Vec3> impulses);

} // namespace flotilla
