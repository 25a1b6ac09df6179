// SPDX-License-Identifier: MIT
// What a step would take on some ranks: from a log of its divided work (parallel/work_log.hpp), the owners that these
// ranks would have, and a network.
//
// Every rank has a clock. What it does by itself moves that on, a message arrives a latency and its bytes after it was
// sent, and who needs it waits; where all are told something, all clocks go on from the latest one, by one latency for
// each doubling of the ranks and by the bytes. What is not divided counts on every rank as it does on one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <flotilla/types.hpp>

#include "parallel/division.hpp"

namespace flotilla::mpi {

struct Network {
    double latency = 2e-6;   ///< s, of a message between two ranks, whatever its size
    double bandwidth = 10e9; ///< bytes/s, into or out of a rank
};

/// A step as one rank made it.
struct LoggedStep {
    const WorkLog& log;
    std::span<const Vec3> positions;      ///< m, of all bodies
    std::span<const std::int32_t> active; ///< bodies that move
    double alone = 0;                     ///< s, of one process that divides nothing
    double divided = 0;                   ///< s, of the one rank that the log is of
    double place = 0;                     ///< s, to place a body whose end state came from elsewhere
};

/// Sums over steps.
struct ModelTotals {
    std::int64_t steps = 0;
    double alone = 0, seconds = 0; ///< s, of one process and predicted
    double common = 0;             ///< s of it, what every rank does by itself
    double work = 0;               ///< s of divided work, of all ranks together
    /// Of the rank that has most of each in a step.
    std::int64_t messages = 0, bytes = 0;
    std::int64_t gathers = 0, gathered_bytes = 0; ///< bytes that every rank receives
};

class CostModel {
  public:
    CostModel(int ranks, const Network& network) : ranks_(ranks), network_(network), owners_(ranks) {}

    /// A step that is not `counted` tells what bodies cost, and nothing else.
    void add(const LoggedStep& step, bool counted = true);
    [[nodiscard]] int ranks() const { return ranks_; }
    [[nodiscard]] const Network& network() const { return network_; }
    [[nodiscard]] const ModelTotals& totals() const { return totals_; }

  private:
    struct Handed {
        int from = 0, to = 0;
        std::size_t pieces = 0; ///< clusters, or bodies
        std::size_t needed = 0; ///< the stage whose work waits for them
    };
    /// Packets of one colour, or tasks of one wave: what ranks do, and what they hand on afterwards.
    struct Stage {
        std::vector<double> work; ///< s, by rank
        std::vector<Handed> handed;
    };

    void add(const LoggedLoop& loop);
    void add(const LoggedSweep& sweep);
    void add(const LoggedContacts& contacts);
    void pass(std::span<const Stage> stages, std::size_t piece_bytes, double piece_seconds, std::int64_t times);
    void gather(std::size_t bytes, std::int64_t times = 1);
    void gather_unknown(std::size_t bytes, std::int64_t times = 1);
    void count(std::int32_t body, double seconds);

    int ranks_;
    Network network_;
    ModelTotals totals_;
    Owners owners_;
    std::vector<std::int64_t> cost_;             ///< by body, ns in the step
    std::vector<double> clock_;                  ///< s, by rank
    std::vector<std::int64_t> messages_, bytes_; ///< by rank, in the step
    double place_ = 0, work_ = 0;                ///< s, in the step
};

} // namespace flotilla::mpi
