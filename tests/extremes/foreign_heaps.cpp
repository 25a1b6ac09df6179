// SPDX-License-Identifier: MIT
// Heaps of 50 bodies of external meshes under the audit: a table, a row a seed. Fails where a promise is broken.
// usage: foreign_heaps FILE [SEEDS [STEPS]]
#include "extremes/foreign_heap.hpp"

#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
    using namespace flotilla;
    if (argc < 2) return 2;
    const int seeds = argc > 2 ? std::atoi(argv[2]) : 20, steps = argc > 3 ? std::atoi(argv[3]) : 120;
    const std::string folder = std::string(FLOTILLA_TEST_DATA) + "/meshes";
    const std::vector<TriangleMesh> meshes = extremes::foreign_meshes(folder);
    if (meshes.empty()) {
        std::printf("skipped: no external meshes: %s\n", folder.c_str());
        return 77;
    }
    std::FILE* const page = std::fopen(argv[1], "w");
    if (page == nullptr) return 5;
    int broken = 0;
    const auto print = [&](std::FILE* to, int seed, const extremes::HeapOutcome& o) {
        std::fprintf(to, "| %d | %zu | %s | %s | %.1e | %lld | %lld | %lld | %lld | %.1f | %.0f | %.3g | %lld |\n",
                     seed, o.findings, o.finite ? "yes" : "NO", o.within_bounds ? "yes" : "NO",
                     o.growth / o.first_energy, static_cast<long long>(o.totals.held),
                     static_cast<long long>(o.most_held), static_cast<long long>(o.totals.merges),
                     static_cast<long long>(o.totals.rung_changes), o.mean_ms, o.worst_ms, o.kinetic_energy,
                     static_cast<long long>(o.asleep));
        std::fflush(to);
    };
    std::fprintf(
        page,
        "# Heaps of external meshes\n\n50 bodies of %zu meshes (1 m each, 0.3 friction, 0.2 restitution) thrown into a "
        "box, preset balanced, %d steps of 1/24 s, every step audited. Growth: largest of energy less lift in a step, "
        "of the energy after the first. Held: bodies, all steps together, and at most in one.\n\n"
        "| seed | findings | finite | G4 | growth | held | in a step | merges | rungs | mean ms | worst ms | kinetic J "
        "at end | asleep |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
        meshes.size(), steps);
    for (int seed = 1; seed <= seeds; ++seed) {
        const auto scene = extremes::foreign_heap(meshes, 50, static_cast<std::uint64_t>(seed));
        const extremes::HeapOutcome o = extremes::run_heap(scene, steps);
        broken += o.findings > 0 || !o.finite || !o.within_bounds || o.growth > 1e-9 * o.first_energy ? 1 : 0;
        print(page, seed, o);
        print(stdout, seed, o);
    }
    std::fclose(page);
    return broken == 0 ? 0 : 3;
}
