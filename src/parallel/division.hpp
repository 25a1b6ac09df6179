// SPDX-License-Identifier: MIT
// How the work of a step is divided among ranks: by owners of bodies.
//
// Every rank holds the whole scene. What costs little, each does by itself, and so has the same; what costs much is
// done by the owner of a body, or of a pair, and what came of it is exchanged. Owners follow from measured times, yet
// no bit of a result does: who computes something does not change it, as with the threads of a team (task_order.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <flotilla/error.hpp>
#include <flotilla/types.hpp>

#include "base/byte_stream.hpp"
#include "parallel/ranks.hpp"
#include "parallel/work_log.hpp"

namespace flotilla {

/// Cuts points into as many parts as there are ranks by recursive bisection along the longest side of their box, so
/// that the parts weigh about the same. Returns the part of each. A pure function of its arguments: equal coordinates
/// are cut by number.
[[nodiscard]] std::vector<std::int32_t> bisect(std::span<const Vec3> points, std::span<const double> weights,
                                               int parts);

/// Owners of bodies by what they cost of late, and when these change.
class Owners {
  public:
    explicit Owners(int ranks) : ranks_(ranks) {}

    /// Rank 0 before the first step; that of infinite mass, a negative number, as well.
    [[nodiscard]] int operator[](std::int32_t body) const {
        const auto i = static_cast<std::size_t>(body);
        return i < owner_.size() ? owner_[i] : 0;
    }
    /// Between steps. `positions`: m, of all bodies; `active`: of them, those that move; `cost`: ns that each of these
    /// cost since the step before, in the order of `active`. Owners change where some have much more to do than others.
    void begin_step(std::span<const Vec3> positions, std::span<const std::int32_t> active,
                    std::span<const std::int64_t> cost);
    /// Of the last begin_step: the most that a rank had to do by the mean.
    [[nodiscard]] double imbalance() const { return imbalance_; }

  private:
    [[nodiscard]] double measured_imbalance(std::span<const std::int32_t> active) const;

    int ranks_;
    std::vector<std::int32_t> owner_; ///< by body
    std::vector<double> weight_;      ///< by body, ns of recent steps
    double imbalance_ = 1;
    int steps_since_cut_ = 0;
};

class Division {
  public:
    explicit Division(Ranks& ranks) : ranks_(ranks), owners_(ranks.size()) {}

    [[nodiscard]] Ranks& ranks() const { return ranks_; }
    [[nodiscard]] int rank() const { return ranks_.rank(); }
    [[nodiscard]] int size() const { return ranks_.size(); }

    [[nodiscard]] int owner(std::int32_t body) const { return owners_[body]; }
    /// Of a pair of bodies, or of clusters by their lowest members; a negative number stands for infinite mass. In turn
    /// those of a and of b, for pairs across a cut.
    [[nodiscard]] int owner(std::int32_t a, std::int32_t b) const { return owner(payer(a, b)); }
    /// The body of a pair whose owner owns it; negative where both are.
    [[nodiscard]] static std::int32_t payer(std::int32_t a, std::int32_t b) {
        if (a < 0) return b;
        return b < 0 || (a + b) % 2 == 0 ? a : b;
    }
    [[nodiscard]] bool owns(std::int32_t a, std::int32_t b) const { return owner(a, b) == rank(); }

    /// Null, as at first: what is done is logged nowhere. Else one thread and one rank do it.
    void log_to(WorkLog* log) { log_ = log; }
    [[nodiscard]] WorkLog* log() const { return log_; }
    /// Where something is logged, the items since the last such call as a loop.
    void log_loop(std::size_t bytes) {
        if (log_ != nullptr) log_->sections.emplace_back(LoggedLoop{std::exchange(log_->items, {}), bytes});
    }

    /// ns, of the calling thread: with a log its processor time, whose reading costs ten times as much.
    [[nodiscard]] std::int64_t clock() const;

    /// Adds ns that this rank spent on a body; a negative number stands for none.
    void add_cost(std::int32_t body, std::int64_t ns) {
        const auto i = static_cast<std::size_t>(body);
        if (body < 0 || i >= cost_.size()) return;
        std::atomic_ref(cost_[i]).fetch_add(ns, std::memory_order_relaxed);
    }
    /// Between steps: what all spent, and maybe other owners (Owners::begin_step).
    void begin_step(std::span<const Vec3> positions, std::span<const std::int32_t> active);
    [[nodiscard]] double imbalance() const { return owners_.imbalance(); }

  private:
    Ranks& ranks_;
    Owners owners_;
    std::vector<std::int64_t> cost_; ///< by body, ns since the last begin_step
    WorkLog* log_ = nullptr;
};

/// ns of processor time of the calling thread, which does not count where it has to wait for a core.
[[nodiscard]] std::int64_t thread_ns();

/// Adds the time of a block to the cost of a body, and to the log.
class CostOf {
  public:
    CostOf(Division& division, std::int32_t body) : division_(division), body_(body) {}
    ~CostOf() {
        const std::int64_t ns = division_.clock() - begin_;
        division_.add_cost(body_, ns);
        if (WorkLog* log = division_.log()) log->items.push_back({body_, ns});
    }
    CostOf(const CostOf&) = delete;
    CostOf& operator=(const CostOf&) = delete;

  private:
    Division& division_;
    std::int32_t body_;
    std::int64_t begin_ = division_.clock();
};

/// Reads bytes that a rank of the same program wrote.
[[nodiscard]] inline auto reader_of(std::span<const std::byte> bytes) {
    const auto fail = [] { throw Error("a rank sent less than was expected"); };
    return ByteReader<decltype(fail)>(bytes, fail);
}

} // namespace flotilla
