// SPDX-License-Identifier: MIT
// Exact solves of islands whose pairs have many contacts each.
//
// Bodies that rest on each other by finely meshed sides have hundreds of contacts. Few of them carry, and the others
// follow: along one normal those inside the hull of the rest, for whatever they could push is a mean of what the rest
// pushes. So a solve begins with some contacts of each pair, half of them those whose pushes are as different as there
// are, and takes in those that its result leaves approaching, until nothing does: a solution of all contacts, in which
// most have no load. The problem is then also easier, since little is redundant: eight nested cups of 24 sides (1,000
// contacts), whose solves ended at 1e-3 m/s after 40 to 80 factorisations, end at 1e-6 and less.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "static_contact/cone_program.hpp"
#include "static_contact/interior_point.hpp"

namespace flotilla {

/// Contacts of a pair that are taken in at once. The solve begins with as many that are far from each other, and as
/// many more by turns: no law says how flat sides share their load, all contacts would share it evenly, and the
/// farthest alone brake a side that spins at its rim.
inline constexpr std::size_t kContactsAtOnce = 8;
/// Up to so many contacts in all are solved as they are, in some milliseconds.
inline constexpr std::size_t kContactsAsTheyAre = 256;

class GrowingProgram {
  public:
    /// As solve_cone_program(). `contacts`: those of a pair one after another. The residual is that of all contacts,
    /// the factorisations are those of all rounds.
    ConeSolveStats solve(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                         const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch);

    /// Contacts that the last solve took in; all, where it began with them.
    [[nodiscard]] std::size_t taken_in() const { return part_.size(); }

  private:
    void list_pairs(std::span<const ConeContact> contacts);
    void choose_first(std::span<const ConeContact> contacts, std::span<const Vec3> impulses);
    void choose_of_pair(std::span<const ConeContact> contacts, std::span<const Vec3> impulses, std::size_t first,
                        std::size_t end);
    void gather_loads(std::span<const ConeContact> contacts, std::span<Vec3> impulses);
    ConeSolveStats solve_part(std::span<const ConeBody> bodies, std::span<const ConeContact> contacts,
                              const ConeSolveOptions& options, std::span<Vec3> impulses, ConeScratch& scratch);
    [[nodiscard]] double largest_approach_of_others() const;
    void take_in(double limit);

    std::vector<std::size_t> pairs_;   ///< where each begins, and the end of the last
    std::vector<std::uint8_t> chosen_; ///< by contact
    std::vector<double> difference_;   ///< m^2, of pushes, from those of its pair that are chosen
    std::vector<std::size_t> part_, approaching_;
    std::vector<ConeContact> contacts_; ///< of the part
    std::vector<Vec3> impulses_;        ///< N s, of the part
    std::vector<Vec3> velocities_;      ///< m/s, by contact
    std::vector<ConeMotion> motion_;
};

} // namespace flotilla
