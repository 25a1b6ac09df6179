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
    const std::vector<CandidatePair>& find(const std::vector<SweptBody>& bodies) override;

  private:
    struct Cell {
        std::int64_t key;
        std::int32_t body;
    };
    void choose_grid(const std::vector<SweptBody>& bodies);
    void rasterize(const std::vector<SweptBody>& bodies);
    void pair_cells(const std::vector<SweptBody>& bodies);
    void pair_large(const std::vector<SweptBody>& bodies);
    [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Vec3& p) const;

    double cell_size_ = 1;
    Vec3 origin_;
    std::vector<Cell> cells_;
    std::vector<std::int32_t> large_;
    std::vector<double> sizes_;
    std::vector<CandidatePair> pairs_;
};

} // namespace flotilla
