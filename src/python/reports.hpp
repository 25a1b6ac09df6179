// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include <flotilla/report.hpp>

#include "python/casters.hpp"

namespace flotilla::python {

/// Milliseconds by the names of the phases.
[[nodiscard]] py::dict phases_of(const std::array<double, kNumPhases>& milliseconds);

} // namespace flotilla::python
