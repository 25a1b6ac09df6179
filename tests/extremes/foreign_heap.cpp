// SPDX-License-Identifier: MIT
#include "extremes/foreign_heap.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>

#include "base/rotation.hpp"
#include "islands/sleeping.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/topology.hpp"

namespace flotilla::extremes {
namespace {

namespace fs = std::filesystem;
using scenario::add_body;
using scenario::add_shape;

constexpr int kColumns = 3;                                          // each way
constexpr double kSpacing = 1.2, kHalf = 2.2, kHeight = 12;          // m, of columns and layers; of the box
constexpr double kFriction = 0.3, kRestitution = 0.2, kDensity = 20; // of bodies; kg/m^2

void add_walls(SceneDescription& scene) {
    const std::int32_t floor = add_shape(scene, make_plate(2 * kHalf, 2 * kHalf));
    const std::int32_t wall = add_shape(scene, make_plate(2 * kHalf, kHeight));
    add_body(scene, floor, BodyType::fixed, {}, kFriction, 0);
    for (int k = 0; k < 4; ++k) { // an upright plate, then turned about z
        const Quat upright = rotation_from_vector({scenario::kPi / 2, 0, 0});
        const Quat turn = rotation_from_vector({0, 0, k * scenario::kPi / 2});
        const Vec3 place = rotate(turn, Vec3{0, kHalf, 0}) + Vec3{0, 0, kHeight / 2};
        add_body(scene, wall, BodyType::fixed, place, kFriction, 0).rotation = normalized(turn * upright);
    }
}

bool finite(const State& state) {
    const auto good = [](const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
    return std::all_of(state.pose.begin(), state.pose.end(),
                       [&](const Pose& p) { return good(p.com) && good(p.origin); }) &&
           std::all_of(state.motion.begin(), state.motion.end(),
                       [&](const Motion& m) { return good(m.velocity) && good(m.momentum); });
}

} // namespace

std::vector<TriangleMesh> foreign_meshes(const std::string& folder) {
    std::vector<fs::path> files;
    std::error_code missing;
    for (fs::recursive_directory_iterator it(folder, missing), end; !missing && it != end; it.increment(missing))
        if (it->path().extension() == ".obj") files.push_back(it->path());
    std::sort(files.begin(), files.end());
    std::vector<TriangleMesh> meshes;
    for (const fs::path& file : files) {
        TriangleMesh mesh = read_mesh(file);
        const BoundingSphere sphere = bounding_sphere(mesh);
        for (Vec3& v : mesh.vertices) v = (v - sphere.center) / (2 * sphere.radius);
        meshes.push_back(std::move(mesh));
    }
    return meshes;
}

SceneDescription foreign_heap(const std::vector<TriangleMesh>& meshes, int bodies, std::uint64_t seed) {
    SceneDescription scene;
    std::mt19937_64 random(seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * 0x1p-53 * static_cast<double>(random() >> 11);
    };
    std::vector<std::int32_t> shape_of(meshes.size(), -1);
    add_walls(scene);
    for (int k = 0; k < bodies; ++k) {
        const std::size_t m = random() % meshes.size();
        if (shape_of[m] < 0) {
            shape_of[m] = add_shape(scene, meshes[m], 1);
            scene.shapes.back().mass_kind = MassKind::surface_density; // whether a mesh is closed does not matter
            scene.shapes.back().mass_value = kDensity;
        }
        const Vec3 place{kSpacing * (k % kColumns - 1), kSpacing * (k / kColumns % kColumns - 1),
                         0.7 + kSpacing * (k / (kColumns * kColumns))};
        BodyDescription& body = add_body(scene, shape_of[m], BodyType::dynamic, place, kFriction, kRestitution);
        body.rotation = rotation_from_vector({uniform(-2, 2), uniform(-2, 2), uniform(-2, 2)});
        body.velocity = {uniform(-2, 2), uniform(-2, 2), uniform(-8, 0)};
        body.angular_velocity = {uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)};
    }
    return scene;
}

HeapOutcome run_heap(const SceneDescription& scene, int steps) {
    HeapOutcome out;
    scenario::AuditedRun run(scene);
    double last = 0;
    for (int n = 0; n < steps; ++n) {
        const StepReport r = run.step();
        const double energy = r.energy - r.lift;
        if (n == 0) out.first_energy = r.energy;
        if (n > 0) out.growth = std::max(out.growth, energy - last);
        last = energy;
        out.mean_ms += r.total_ms / steps;
        out.worst_ms = std::max(out.worst_ms, r.total_ms);
        out.most_held = std::max(out.most_held, r.held);
        out.kinetic_energy = r.kinetic_energy;
        const auto count = static_cast<std::int64_t>(scene.bodies.size());
        out.within_bounds = out.within_bounds && r.merges <= count - 1 && r.rung_changes <= 3 * count;
        out.finite = out.finite && finite(run.stepper().state());
    }
    out.totals = run.totals;
    out.findings = run.findings;
    for (const Sleep& s : run.stepper().state().sleep) out.asleep += s.island >= 0 ? 1 : 0;
    return out;
}

} // namespace flotilla::extremes
