// SPDX-License-Identifier: MIT
// Exact solve of small frictional contact problems, whatever the mass ratio, the redundancy of the contacts and the
// friction: what the sweeps (solve_contacts.hpp) only approach, in some ten factorisations of a matrix as large as the
// bodies' degrees of freedom. The law of a contact, for its impulse r and its relative velocity u = q + W r:
//     0 <= r_n  perpendicular to  u_n >= 0,   |r_t| <= mu r_n,   r_t = -mu r_n u_t / |u_t| where u_t != 0.
// How it is solved is told in interior_point.cpp.
#pragma once

#include <memory>
#include <span>

#include "static_contact/cone_program.hpp"

namespace flotilla {

struct ConeSolveOptions {
    double tolerance = 0;     ///< m/s: residual asked for
    int max_iterations = 100; ///< factorisations in all
    /// m/s: a residual that is not worth more than `most_beyond` factorisations in all, nor other methods than the
    /// first where they seldom gain, nor in motion the third.
    double enough = 0;
    int most_beyond = 100;
    /// Newton steps alone, for as long as each divides the residual by so much; 0: all methods.
    double polish = 0;
    bool newton = false; ///< no other methods than Newton's steps, as many as gain, nor contacts that yield
    bool rests = false;  ///< bodies at rest, of which the estimate is what held them up in the step before
};

struct ConeSolveStats {
    int iterations = 0; ///< factorisations
    double residual =
        0; ///< m/s: largest cone_violation(); infinite where the problem holds something that is not finite
    double rounding = 0;      ///< m/s: residual that rounding alone may leave, 4 eps max W |r|. It matters for a light
                              ///< body under a heavy one: a load of 1e9 weights is not known to 1e-7 weights
    bool solved = false;      ///< the residual is no larger than the tolerance, or than the rounding
    bool yielded = false;     ///< not solved: contacts yielded to their impulses
    double yielding_left = 0; ///< m/s: residual of that
};

/// Working memory, to be kept from solve to solve.
class ConeScratch {
  public:
    struct Storage;
    ConeScratch();
    ~ConeScratch();
    ConeScratch(const ConeScratch&) : ConeScratch() {} ///< memory of its own: nothing in it outlives a solve
    ConeScratch& operator=(const ConeScratch&) { return *this; }
    ConeScratch(ConeScratch&&) noexcept;
    ConeScratch& operator=(ConeScratch&&) noexcept;
    Storage& storage() { return *storage_; }

  private:
    std::unique_ptr<Storage> storage_;
};

/// Solves for the impulses (N s, contact frame). Their input values are an estimate to start from, zero where there is
/// none.
///
/// Guarantees, solved or not: r_n >= 0, and |r_t| <= mu r_n to rounding; a residual no larger, to 1e-6 of it, than that
/// of the estimate cut to the cones, nor than that of r = 0, but up to twice that for every body and once more where
/// contacts yielded; at most options.max_iterations factorisations, and as many again for contacts that yield; the same
/// bits for the same input; and the same result in other units, exactly where lengths and times are scaled by powers of
/// two and masses by powers of four. A problem without a solution, which large friction and prescribed motions can
/// make, ends unsolved: with the impulses of contacts that yield (`yielded`), or the best r met.
ConeSolveStats solve_cone_program(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                                  const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch);
ConeSolveStats solve_cone_program(const ConeProgram& program, const ConeSolveOptions& options, std::span<Vec3> impulses,
                                  ConeScratch& scratch);

} // namespace flotilla
