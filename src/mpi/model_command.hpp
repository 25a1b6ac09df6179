// SPDX-License-Identifier: MIT
// flotilla-mpi model: what one scene would take on some ranks.
#pragma once

#include "cli/commands.hpp"

namespace flotilla::mpi {

void register_model(CLI::App& app, cli::Action& action);

} // namespace flotilla::mpi
