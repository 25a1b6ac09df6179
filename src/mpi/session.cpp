// SPDX-License-Identifier: MIT
#include "mpi/session.hpp"

#include <algorithm>
#include <cstdlib>

#include <mpi.h>

namespace flotilla::mpi {

Session::Session(int& argc, char**& argv) {
    int provided = 0;
    MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided); // faults end the job: MPI's own default
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Session::~Session() { end(); }

std::int64_t Session::from_first(std::int64_t value) const {
    MPI_Bcast(&value, 1, MPI_INT64_T, 0, MPI_COMM_WORLD);
    return value;
}

void Session::from_first(std::vector<std::byte>& bytes) const {
    constexpr std::size_t kMost = std::size_t{1} << 30; // of a call: MPI counts in int
    bytes.resize(static_cast<std::size_t>(from_first(static_cast<std::int64_t>(bytes.size()))));
    for (std::size_t begin = 0; begin < bytes.size(); begin += kMost)
        MPI_Bcast(bytes.data() + begin, static_cast<int>(std::min(kMost, bytes.size() - begin)), MPI_BYTE, 0,
                  MPI_COMM_WORLD);
}

void Session::abort(int exit_code) const {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::abort();
}

void Session::end() {
    if (ended_) return;
    ended_ = true;
    MPI_Finalize();
}

} // namespace flotilla::mpi
