// SPDX-License-Identifier: MIT
#include "mpi/mpi_ranks.hpp"

#include <limits>

#include <mpi.h>

#include <flotilla/error.hpp>

namespace flotilla::mpi {
namespace {

int rank_of_this() {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    return rank;
}

int num_ranks() {
    int size = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    return size;
}

int as_count(std::size_t bytes) {
    if (bytes > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw Error("more than 2 GiB in a message between ranks");
    return static_cast<int>(bytes);
}

/// Of one pair of ranks messages are received in the order in which they were sent: one tag does.
constexpr int kTag = 0;

class PersistentExchange : public RankExchange {
  public:
    PersistentExchange(std::span<const RankMessage> sends, std::span<const RankMessage> receives, RankTraffic& traffic)
        : traffic_(traffic), messages_(std::ssize(sends)) {
        for (const RankMessage& m : receives)
            MPI_Recv_init(m.bytes.data(), as_count(m.bytes.size()), MPI_BYTE, m.partner, kTag, MPI_COMM_WORLD,
                          &requests_.emplace_back());
        for (const RankMessage& m : sends) {
            MPI_Send_init(m.bytes.data(), as_count(m.bytes.size()), MPI_BYTE, m.partner, kTag, MPI_COMM_WORLD,
                          &requests_.emplace_back());
            bytes_ += std::ssize(m.bytes);
        }
    }
    ~PersistentExchange() override {
        for (MPI_Request& request : requests_) MPI_Request_free(&request);
    }
    PersistentExchange(const PersistentExchange&) = delete;
    PersistentExchange& operator=(const PersistentExchange&) = delete;

    void start() override {
        traffic_.messages += messages_;
        traffic_.bytes += bytes_;
        MPI_Startall(static_cast<int>(requests_.size()), requests_.data());
    }
    void wait() override { MPI_Waitall(static_cast<int>(requests_.size()), requests_.data(), MPI_STATUSES_IGNORE); }

  private:
    RankTraffic& traffic_;
    std::int64_t messages_, bytes_ = 0;
    std::vector<MPI_Request> requests_;
};

} // namespace

MpiRanks::MpiRanks() : Ranks(rank_of_this(), num_ranks()) {}

std::unique_ptr<RankExchange> MpiRanks::prepare(std::span<const RankMessage> sends,
                                                std::span<const RankMessage> receives) {
    return std::make_unique<PersistentExchange>(sends, receives, traffic_);
}

void MpiRanks::gather(std::span<const std::byte> own, std::span<const std::size_t> sizes, std::span<std::byte> all) {
    ++traffic_.gathers;
    traffic_.gathered_bytes += std::ssize(own);
    std::vector<int> counts, begin;
    std::size_t sum = 0;
    for (const std::size_t size : sizes) {
        counts.push_back(as_count(size));
        begin.push_back(as_count(sum));
        sum += size;
    }
    MPI_Allgatherv(own.data(), as_count(own.size()), MPI_BYTE, all.data(), counts.data(), begin.data(), MPI_BYTE,
                   MPI_COMM_WORLD);
}

} // namespace flotilla::mpi
