// SPDX-License-Identifier: MIT
// Starts flotilla-mpi on some ranks as a user does. The test's target defines FLOTILLA_MPIRUN and FLOTILLA_MPI_COMMAND.
#pragma once

#include <string>

#include "support/command.hpp"

namespace flotilla::test {

/// More ranks than cores, each on whatever core is free, also as root. `options`: of mpirun.
inline std::string ranks_line(int ranks, const std::string& arguments, const std::string& options = "") {
    return "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 " FLOTILLA_MPIRUN
           " --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 " +
           options + " -np " + std::to_string(ranks) + " " FLOTILLA_MPI_COMMAND " " + arguments;
}

inline CommandOutput run_ranks(int ranks, const std::string& arguments, const std::string& options = "") {
    return run_line(ranks_line(ranks, arguments, options));
}

} // namespace flotilla::test
