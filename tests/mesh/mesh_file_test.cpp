// SPDX-License-Identifier: MIT
#include "mesh/mesh_file.hpp"

#include <gtest/gtest.h>

#include "mesh/mass_properties.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

TEST(MeshFile, ReadsTheBoat) {
    const TriangleMesh boat = read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj");
    EXPECT_FALSE(is_closed(boat));
    EXPECT_GT(shell_mass_properties(boat, 10, "boat").principal_inertia.x, 0);
}

} // namespace
} // namespace flotilla
