// SPDX-License-Identifier: MIT
// What the library itself, and nobody who embeds it, may do with a World.
#pragma once

#include <flotilla/world.hpp>

#include "mesh/triangle_mesh.hpp"
#include "parallel/team.hpp"
#include "step/certificate.hpp"

namespace flotilla {

struct WorldAccess {
    /// The threads that run its steps.
    [[nodiscard]] static Team& team(World& world);
    /// Of the body at a place, in the mesh's own coordinates; valid until the next edit.
    [[nodiscard]] static const TriangleMesh& mesh(const World& world, std::size_t place);
    /// How the last step proved the bodies at two places apart.
    [[nodiscard]] static ProofWay proved_by(const World& world, std::size_t a, std::size_t b);
};

} // namespace flotilla
