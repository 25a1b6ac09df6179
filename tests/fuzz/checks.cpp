// SPDX-License-Identifier: MIT
#include "fuzz/checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include <flotilla/scene_check.hpp>
#include <flotilla/scene_file.hpp>

#include "base/vec3.hpp"
#include "extremes/check.hpp"
#include "fuzz/small_scene.hpp"
#include "step/scene_parts.hpp"
#include "support/temporary_folder.hpp"

namespace flotilla::fuzz {
namespace {

// A step of a small scene takes milliseconds, even with sanitizers.
constexpr std::size_t kMostBodies = 8, kMostTriangles = 200;

bool is_small(const SceneDescription& scene) {
    std::size_t triangles = 0;
    for (const BodyDescription& b : scene.bodies)
        triangles += scene.shapes[static_cast<std::size_t>(b.shape)].triangles.size();
    return scene.bodies.size() <= kMostBodies && triangles <= kMostTriangles;
}

double extent(const TriangleMesh& mesh) {
    Vec3 low = mesh.vertices.front(), high = low;
    for (const Vec3& v : mesh.vertices) low = min(low, v), high = max(high, v);
    return max_component(high - low);
}

/// One body that stands, and one that flies at it.
SceneDescription two_of(const TriangleMesh& mesh) {
    SceneDescription scene;
    const std::int32_t shape = scenario::add_shape(scene, mesh, 1);
    const double size = extent(mesh);
    scenario::add_body(scene, shape, BodyType::fixed, {});
    BodyDescription& flying = scenario::add_body(scene, shape, BodyType::dynamic, {1.1 * size, 0, 0});
    flying.velocity = {-size / scene.settings.time_step, 0, 0};
    flying.angular_velocity = {1, 2, 3};
    return scene;
}

} // namespace

void require(bool ok, const std::string& what) {
    if (ok) return;
    std::fprintf(stderr, "does not hold: %s\n", what.c_str());
    std::abort();
}

const std::filesystem::path& scratch() {
    static const test::TemporaryFolder folder;
    return folder.path();
}

std::filesystem::path write_scratch(const std::string& name, std::string_view content) {
    const std::filesystem::path path = scratch() / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
}

bool same_meshes(const TriangleMesh& a, const TriangleMesh& b) {
    return a.triangles == b.triangles && a.vertices.size() == b.vertices.size() &&
           std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

std::string written(const SceneDescription& scene) {
    std::ostringstream out;
    write_scene(out, scene);
    return out.str();
}

void check_steps(SceneDescription scene, int steps) {
    if (!is_small(scene)) return;
    cut_limits(scene.settings);
    const extremes::Outcome outcome = extremes::run_scene(scene, {.steps = steps, .repeated = false});
    require(outcome.verdict != extremes::Verdict::broken, outcome.message);
}

void check_mesh(const TriangleMesh& mesh) {
    require(!mesh.triangles.empty(), "a mesh has a triangle");
    for (const Triangle& t : mesh.triangles)
        for (const std::int32_t v : t)
            require(v >= 0 && static_cast<std::size_t>(v) < mesh.vertices.size(), "corners are vertices");
    for (const Vec3& v : mesh.vertices) require(is_finite(v), "coordinates are finite");
    const SceneDescription scene = two_of(mesh);
    const bool sound = accepted("mesh", [&] { (void)check_scene(scene, "mesh"); });
    if (!sound) return;
    const SceneDescription again = parse_scene(written(scene), "mesh", {});
    require(same_meshes(mesh, {again.shapes[0].vertices, again.shapes[0].triangles}), "a scene file keeps a mesh");
    check_steps(scene, 1);
}

} // namespace flotilla::fuzz
