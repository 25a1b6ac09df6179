// SPDX-License-Identifier: MIT
// A scene of every type of body that steps in milliseconds with sanitizers, whatever becomes of it.
#pragma once

#include <flotilla/scene.hpp>

namespace flotilla::fuzz {

/// Limits of loops that a step of few bodies ends at soon, jammed or in each other: no input is worth more than that.
void cut_limits(Settings& settings);

/// Two boxes "low" and "high", one on the other and both on a "floor", with a "lid" that comes down on them; the
/// shapes are "box" and "plate". Contacts are solved by sweeps alone.
[[nodiscard]] SceneDescription small_pile();

} // namespace flotilla::fuzz
