// SPDX-License-Identifier: MIT
// Runs of scenes in processes of their own, so that one that crashes or hangs is an outcome like any other.
#pragma once

#include <functional>

#include "extremes/check.hpp"

namespace flotilla::extremes {

/// What `run` returns; broken where its process crashes, hangs, or takes more than so many seconds of processor time.
/// The calling process must have no threads: those of oneTBB would be missing in the new one.
[[nodiscard]] Outcome run_apart(const std::function<Outcome()>& run, int most_seconds);

} // namespace flotilla::extremes
