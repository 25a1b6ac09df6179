// SPDX-License-Identifier: MIT
// The survey's results: one CSV row per scene, and a page of Markdown tables.
#pragma once

#include <iosfwd>
#include <span>

#include "energy_record.hpp"

namespace flotilla::survey {

/// A larger rise, as a share of the scale, is a fault.
inline constexpr double kMostRise = 1e-6;

/// Whether the scene shows energy out of nothing.
[[nodiscard]] inline bool rises(const EnergyRecord& r) { return !r.scripted && r.rise > kMostRise; }

void write_csv(std::ostream& out, std::span<const EnergyRecord> records);

/// Per group: scenes, rises, quantiles, last resorts, momentum, time. Then the worst scenes, the failures, and how
/// often energy rises for each value of what the scenes were drawn from.
void write_summary(std::ostream& out, std::span<const EnergyRecord> records);

} // namespace flotilla::survey
