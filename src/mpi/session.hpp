// SPDX-License-Identifier: MIT
// MPI from its start to its end, and what ranks say to each other outside of a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace flotilla::mpi {

/// One in a process. Calls are made on the thread that made it.
class Session {
  public:
    Session(int& argc, char**& argv);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] bool first() const { return rank_ == 0; }

    /// Rank 0's value, on every rank.
    [[nodiscard]] std::int64_t from_first(std::int64_t value) const;
    void from_first(std::vector<std::byte>& bytes) const;
    /// Ends the processes of all ranks, where others wait for what this one cannot do.
    [[noreturn]] void abort(int exit_code) const;
    /// Ends MPI: from here on ranks are processes that share a machine or a file system, and nothing else.
    void end();

  private:
    int rank_ = 0, size_ = 1;
    bool ended_ = false;
};

} // namespace flotilla::mpi
