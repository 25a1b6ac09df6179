// SPDX-License-Identifier: MIT
// Processes that step the same scene together (ranks), as one of them sees the others. What they say to one another
// over is somebody else's (src/mpi); the core knows this interface alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace flotilla {

/// Bytes to or from another rank.
struct RankMessage {
    int partner = 0;
    std::span<std::byte> bytes;
};

/// Messages between the same ranks and buffers, exchanged again and again.
class RankExchange {
  public:
    virtual ~RankExchange() = default;
    /// Begins to send and receive all of them. Of two ranks the first message that one begins to send is the first that
    /// the other begins to receive, and so on.
    virtual void start() = 0;
    /// Until what was started is sent and received.
    virtual void wait() = 0;
    void run() {
        start();
        wait();
    }
};

/// What a rank said to others since the beginning.
struct RankTraffic {
    std::int64_t messages = 0, bytes = 0;         ///< to single ranks
    std::int64_t gathers = 0, gathered_bytes = 0; ///< of all ranks; bytes that this one gave
};

/// Calls are made on one thread, by all ranks in the same order.
class Ranks {
  public:
    virtual ~Ranks() = default;

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] const RankTraffic& traffic() const { return traffic_; }

    /// The buffers stay where they are as long as the exchange lives. At most one message to, and one from, a partner.
    [[nodiscard]] virtual std::unique_ptr<RankExchange> prepare(std::span<const RankMessage> sends,
                                                                std::span<const RankMessage> receives) = 0;
    /// Fills `all` with the bytes of all ranks, one after another; `sizes` of them are known everywhere.
    virtual void gather(std::span<const std::byte> own, std::span<const std::size_t> sizes,
                        std::span<std::byte> all) = 0;

  protected:
    Ranks(int rank, int size) : rank_(rank), size_(size) {}
    RankTraffic traffic_;

  private:
    int rank_, size_;
};

/// The bytes of every rank, whatever their sizes.
struct GatheredBytes {
    std::vector<std::byte> all;
    std::vector<std::size_t> begin; ///< by rank, and the end

    [[nodiscard]] std::span<const std::byte> of(int rank) const {
        const auto r = static_cast<std::size_t>(rank);
        return std::span(all).subspan(begin[r], begin[r + 1] - begin[r]);
    }
};
[[nodiscard]] GatheredBytes gather_bytes(Ranks& ranks, std::span<const std::byte> own);

} // namespace flotilla
