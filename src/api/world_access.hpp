// SPDX-License-Identifier: MIT
// What the library itself, and nobody who embeds it, may do with a World.
#pragma once

#include <flotilla/world.hpp>

#include "parallel/team.hpp"

namespace flotilla {

struct WorldAccess {
    /// The threads that run its steps.
    [[nodiscard]] static Team& team(World& world);
};

} // namespace flotilla
