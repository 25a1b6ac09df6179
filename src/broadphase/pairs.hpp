// SPDX-License-Identifier: MIT
// Candidate body pairs: swept boxes that overlap, found with a Cartesian grid (paper, section 3).
//
// Bodies much larger than the others (a bowl, the ground) would fill the grid; they are never rasterized but held
// against everybody's box. Bodies that stand still have a grid of their own, which is kept as long as they do: what a
// search costs goes by the bodies that move.
#pragma once

#include <array>
#include <vector>

#include "state/candidate_pairs.hpp"

namespace flotilla {

/// Bodies by the cells that their inflated boxes touch.
class BodyGrid {
  public:
    struct Cell {
        std::int64_t key;
        std::int32_t body;
    };
    /// The cells that an inflated box touches.
    struct CellRange {
        std::array<std::int64_t, 3> low, high;
        std::int64_t count = 0; ///< 0: too many, the body is large
    };
    /// An inflated box, and whether the size of cells goes by it.
    struct Item {
        std::int32_t body;
        Box box;
        bool sizes_cells;
    };

    /// Bodies that touch more than `most_cells` cells, and all where there are fewer than `fewest` of them, are large.
    void build(Team& team, const std::vector<Item>& items, std::int64_t most_cells, std::size_t fewest);

    [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; } ///< sorted
    [[nodiscard]] const std::vector<std::int32_t>& large() const { return large_; }
    [[nodiscard]] std::int64_t cell_key_of(const Vec3& p) const;
    /// Calls visit(body) for all bodies that share a cell with the box, for some several times, and for the large ones.
    template <typename Visit>
    void for_near(const Box& box, Visit&& visit) const;

  private:
    void choose_cells(const std::vector<Item>& items);
    [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Vec3& p) const;
    [[nodiscard]] CellRange cells_of(const Box& box) const;

    std::int64_t most_cells_ = 0;

    double cell_size_ = 1;
    Vec3 origin_;
    std::vector<CellRange> ranges_;   ///< by item
    std::vector<std::size_t> offset_; ///< by item: its first cell
    std::vector<Cell> cells_, sorted_cells_;
    std::vector<std::int32_t> large_;
    std::vector<double> sizes_;
};

class Broadphase : public PairFinder {
  public:
    const std::vector<CandidatePair>& find(Team& team, const PairSearch& search) override;
    const std::vector<CandidatePair>& update(Team& team, const PairSearch& search,
                                             std::span<const std::int32_t> changed) override;
    /// Bodies that stand still and fill no cells, ascending.
    [[nodiscard]] const std::vector<std::int32_t>& large_still() const { return still_.large(); }

  private:
    void build_grid(Team& team, const PairSearch& search, BodyGrid& grid);
    void sort_in_still(Team& team, const PairSearch& search);
    void sort_in_active(Team& team, const PairSearch& search);
    /// These fill the next entries of found_ and return how many.
    std::size_t pair_cells(Team& team, const PairSearch& search);
    std::size_t pair_large(Team& team, const PairSearch& search, std::size_t first_chunk);
    std::size_t pair_still(Team& team, const PairSearch& search, std::size_t first_chunk);
    void pair_run(std::size_t begin, std::size_t end, const PairSearch& search, std::vector<CandidatePair>& out) const;
    void pair_with_still(std::int32_t body, const PairSearch& search, std::vector<CandidatePair>& out) const;
    /// Fills the first entries of found_ with the pairs of the changed bodies and returns how many.
    std::size_t pair_changed(Team& team, const PairSearch& search, std::span<const std::int32_t> changed);
    /// Makes pairs_ of what the first `chunks` entries of found_ hold, in their order.
    void gather(Team& team, std::size_t chunks);

    BodyGrid active_, still_;
    std::vector<BodyGrid::Item> items_;
    std::uint64_t still_version_ = 0; ///< of still_
    bool has_still_ = false;
    std::vector<std::vector<CandidatePair>> found_; ///< by chunk of a loop
    std::vector<std::size_t> places_;               ///< in pairs_, by chunk of found_
    std::vector<CandidatePair> pairs_, sorted_pairs_;
    std::vector<CandidatePair> kept_;       ///< pairs of bodies that did not change
    std::vector<std::uint8_t> has_changed_; ///< by body
};

} // namespace flotilla
