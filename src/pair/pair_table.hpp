// SPDX-License-Identifier: MIT
// What a step knows of body pairs: proofs, by the versions they are about.
#pragma once

#include <vector>

#include "state/model.hpp"

namespace flotilla {

struct PairRecord {
    std::int32_t a = -1, b = -1;
    std::uint64_t proved_a = 0, proved_b = 0; ///< versions for which the CCD found no hit (way b of DESIGN 4.2)
    std::uint64_t left_a = 0, left_b = 0;     ///< versions for which an operation changed nothing: left to stage 5
    bool processed = false;                   ///< examined by stage 1 and found hitting or near: stage 7 acts on it
    PairLengths lengths{};                    ///< m
};

/// Open addressing by (a, b). Nothing ever iterates over it: order comes from sorted lists of pairs.
class PairTable {
  public:
    /// Forgets everything; keeps the memory.
    void clear();
    /// The record of a pair, made on first use.
    PairRecord& get(const Model& model, const State& state, std::int32_t a, std::int32_t b);
    [[nodiscard]] const PairRecord* find(std::int32_t a, std::int32_t b) const;

  private:
    [[nodiscard]] std::size_t slot(std::int32_t a, std::int32_t b) const;
    void grow();

    std::vector<std::int32_t> slots_; ///< index into records_, or -1; a power of two of them
    std::vector<PairRecord> records_;
};

} // namespace flotilla
