// SPDX-License-Identifier: MIT
// Heaps of meshes that nobody made for this: cards, bowls, mugs, gears, soup of triangles, solids that intersect
// themselves. SI units.
#pragma once

#include <string>
#include <vector>

#include "mesh/triangle_mesh.hpp"
#include "step/audited_run.hpp"

namespace flotilla::extremes {

/// The meshes below a folder, sorted by name, each scaled to a bounding sphere of 1 m; empty where there is no such
/// folder.
[[nodiscard]] std::vector<TriangleMesh> foreign_meshes(const std::string& folder);

/// `bodies` of them, chosen and turned at random, in layers above an open box.
[[nodiscard]] SceneDescription foreign_heap(const std::vector<TriangleMesh>& meshes, int bodies, std::uint64_t seed);

struct HeapOutcome {
    scenario::RunTotals totals;
    std::size_t findings = 0;         ///< of the audit
    bool finite = true;               ///< all states
    bool within_bounds = true;        ///< those of the ladder (G4), in all steps
    double growth = 0;                ///< J, largest of energy less lift in a step
    double first_energy = 0;          ///< J, after the first step
    double mean_ms = 0, worst_ms = 0; ///< of steps
    double kinetic_energy = 0;        ///< J, at the end
    std::int64_t most_held = 0;       ///< in a step
    std::int64_t asleep = 0;          ///< bodies, at the end
};
[[nodiscard]] HeapOutcome run_heap(const SceneDescription& scene, int steps);

} // namespace flotilla::extremes
