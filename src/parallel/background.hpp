// SPDX-License-Identifier: MIT
// Jobs done in order beside their caller, on a thread of oneTBB: what a run writes while the next step computes.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace flotilla {

class Beside;

/// Used from one thread. No two jobs run at a time; after one that threw, none is begun.
class Background {
  public:
    /// At most so many jobs wait: add() then waits for the first of them or, where no thread has come for them, does
    /// it.
    explicit Background(std::size_t most_waiting);
    /// Does what was added and swallows errors; finish() reports them.
    ~Background();
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    /// Throws what an earlier job threw.
    void add(std::function<void()> job);
    /// Returns when all jobs are done; throws what one of them threw.
    void finish();

  private:
    struct Jobs;
    std::shared_ptr<Jobs> jobs_;
    std::unique_ptr<Beside> beside_;
};

} // namespace flotilla
