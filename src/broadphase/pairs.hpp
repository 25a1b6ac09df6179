// SPDX-License-Identifier: MIT
// Candidate body pairs: swept boxes that overlap, found with a Cartesian grid (paper, section 3).
//
// Bodies much larger than the others (a bowl, the ground) would fill the grid; they are never rasterized but held against
// everybody's box.
#pragma once

#include <array>
#include <vector>

#include "state/candidate_pairs.hpp"

namespace flotilla {

class Broadphase : public PairFinder {
  public:
    const std::vector<CandidatePair>& find(Team& team, const std::vector<SweptBody>& bodies) override;
    const std::vector<CandidatePair>& update(Team& team, const std::vector<SweptBody>& bodies,
                                             std::span<const std::int32_t> changed) override;

  private:
    struct Cell {
        std::int64_t key;
        std::int32_t body;
    };
    /// The cells that a body's inflated box touches.
    struct CellRange {
        std::array<std::int64_t, 3> low, high;
        std::int64_t count = 0; ///< 0: too many, the body is large
    };
    void choose_grid(const std::vector<SweptBody>& bodies);
    void rasterize(Team& team, const std::vector<SweptBody>& bodies);
    /// These fill the next entries of found_ and return how many.
    std::size_t pair_cells(Team& team, const std::vector<SweptBody>& bodies);
    std::size_t pair_large(Team& team, const std::vector<SweptBody>& bodies, std::size_t first_chunk);
    void pair_run(std::size_t begin, std::size_t end, const std::vector<SweptBody>& bodies,
                  std::vector<CandidatePair>& out) const;
    /// Fills the first entries of found_ with the pairs of the changed bodies and returns how many.
    std::size_t pair_changed(Team& team, const std::vector<SweptBody>& bodies, std::span<const std::int32_t> changed);
    /// Makes pairs_ of what the first `chunks` entries of found_ hold, in their order.
    void gather(Team& team, std::size_t chunks);
    [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Vec3& p) const;
    [[nodiscard]] CellRange cells_of(const SweptBody& body) const;

    double cell_size_ = 1;
    Vec3 origin_;
    std::vector<CellRange> ranges_;   ///< by body
    std::vector<std::size_t> offset_; ///< by body: its first cell
    std::vector<Cell> cells_, sorted_cells_;
    std::vector<std::int32_t> large_;
    std::vector<double> sizes_;
    std::vector<std::vector<CandidatePair>> found_; ///< by chunk of a loop
    std::vector<std::size_t> places_;               ///< in pairs_, by chunk of found_
    std::vector<CandidatePair> pairs_, sorted_pairs_;
    std::vector<CandidatePair> kept_;       ///< pairs of bodies that did not change
    std::vector<std::uint8_t> has_changed_; ///< by body
};

} // namespace flotilla
