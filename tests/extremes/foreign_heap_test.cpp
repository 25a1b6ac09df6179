// SPDX-License-Identifier: MIT
#include "extremes/foreign_heap.hpp"

#include <cstdio>

namespace flotilla::extremes {
namespace {

TEST(ForeignHeap, ADozenOfMeshesKeepTheirPromises) {
    const std::string folder = std::string(FLOTILLA_TEST_DATA) + "/meshes";
    const std::vector<TriangleMesh> meshes = foreign_meshes(folder);
    if (meshes.empty()) GTEST_SKIP() << "no external meshes: " << folder;
    const HeapOutcome out = run_heap(foreign_heap(meshes, 12, 1), 48);
    EXPECT_EQ(out.findings, 0u);
    EXPECT_TRUE(out.finite);
    EXPECT_TRUE(out.within_bounds);
    EXPECT_LE(out.growth, 1e-9 * out.first_energy);
    EXPECT_GE(out.totals.collisions, 20);
}

} // namespace
} // namespace flotilla::extremes
