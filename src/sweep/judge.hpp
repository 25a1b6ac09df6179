// SPDX-License-Identifier: MIT
// From what was measured of the members to errors, a front, and what to change first.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <flotilla/sweep.hpp>

#include "sweep/measure.hpp"
#include "sweep/plan.hpp"

namespace flotilla::sweep {

/// By point and start; nothing where a run is not complete.
using Measured = std::vector<std::vector<std::optional<Measures>>>;

/// Fills what SweepReport says about points. `wanted`: positions in sweep_metrics(), all where it is empty.
void judge(const Plan& plan, const Problem& problem, const Measured& measured, const std::vector<std::size_t>& wanted,
           SweepReport& report);

/// Over the values that are no nan.
[[nodiscard]] SweepValue statistics(const std::vector<double>& values);
/// The distance from the truth. For metrics whose true value is zero the values are the errors; otherwise values and
/// truths are paired by start, so that what a start does to both is no error.
[[nodiscard]] SweepValue error_of(const SweepMetric& metric, const std::vector<double>& values,
                                  const std::vector<double>& truths);

/// Whether an error over several starts could be chance: within twice its standard error.
[[nodiscard]] bool within_chance(const SweepValue& error);

/// Three significant digits: "0.0123", "1.2e-07".
[[nodiscard]] std::string brief(double value);
/// "0.0123 ± 0.0004 m"; the second part where there are two starts or more.
[[nodiscard]] std::string with_spread(const SweepValue& value, std::string_view unit);

} // namespace flotilla::sweep
