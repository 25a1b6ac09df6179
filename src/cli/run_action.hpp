// SPDX-License-Identifier: MIT
// The one place where exceptions become exit codes, with a message on stderr.
#pragma once

#include "cli/commands.hpp"

namespace flotilla::cli {

/// What a program's main does: `action` with some memory kept for the way out, and its exit code.
[[nodiscard]] int run_action(const Action& action);

} // namespace flotilla::cli
