// SPDX-License-Identifier: MIT
// A campaign as one HTML page, without a network, any other file or a script.
#pragma once

#include <filesystem>

#include <flotilla/sweep.hpp>

#include "sweep/plan.hpp"
#include "sweep/record.hpp"

namespace flotilla::sweep {

void write_sweep_page(const std::filesystem::path& folder, const Plan& plan, const Record& record,
                      const SweepReport& report);

} // namespace flotilla::sweep
