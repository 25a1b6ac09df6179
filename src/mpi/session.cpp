// SPDX-License-Identifier: MIT
#include "mpi/session.hpp"

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

void Session::end() {
    if (ended_) return;
    ended_ = true;
    MPI_Finalize();
}

} // namespace flotilla::mpi
