// SPDX-License-Identifier: MIT
// The ranks of a step as MPI has them.
#pragma once

#include "parallel/ranks.hpp"

namespace flotilla::mpi {

class MpiRanks : public Ranks {
  public:
    /// All of this job; MPI must outlive it.
    MpiRanks();

    /// Persistent requests.
    [[nodiscard]] std::unique_ptr<RankExchange> prepare(std::span<const RankMessage> sends,
                                                        std::span<const RankMessage> receives) override;
    void gather(std::span<const std::byte> own, std::span<const std::size_t> sizes, std::span<std::byte> all) override;
};

} // namespace flotilla::mpi
