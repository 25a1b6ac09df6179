// SPDX-License-Identifier: MIT
// flotilla-mpi run: one scene over ranks, or an ensemble of runs.
#pragma once

#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "mpi/session.hpp"

namespace flotilla::mpi {

void register_run(CLI::App& app, cli::Action& action, Session& session, const std::vector<std::string>& command_line);

} // namespace flotilla::mpi
