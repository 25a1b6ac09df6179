// SPDX-License-Identifier: MIT
#include <flotilla/scene_check.hpp>

#include <algorithm>
#include <sstream>

#include "base/floating_point.hpp"
#include "base/text.hpp"
#include "io/file.hpp"
#include "scene/initial_overlap.hpp"
#include "scene/separate_overlaps.hpp"

namespace flotilla {

namespace {

std::vector<std::array<Vec3, 3>> triangles_of(const Scene& scene, const BodyOverlap& overlap, std::size_t side) {
    std::vector<std::int32_t> used;
    for (const auto& pair : overlap.triangles) used.push_back(pair[side]);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());

    const auto body = static_cast<std::size_t>(side == 0 ? overlap.a : overlap.b);
    const TriangleMesh& mesh = scene.shapes[static_cast<std::size_t>(scene.bodies[body].shape)].mesh;
    const std::vector<Vec3> world = initial_vertices(scene, body);
    std::vector<std::array<Vec3, 3>> triangles;
    triangles.reserve(used.size());
    for (const std::int32_t t : used) {
        const Triangle& corners = mesh.triangles[static_cast<std::size_t>(t)];
        const auto at = [&](std::size_t k) { return world[static_cast<std::size_t>(corners[k])]; };
        triangles.push_back({at(0), at(1), at(2)});
    }
    return triangles;
}

std::vector<InitialIntersection> describe(const Scene& scene, const std::vector<BodyOverlap>& overlaps) {
    std::vector<InitialIntersection> out;
    for (const BodyOverlap& o : overlaps)
        out.push_back({scene.bodies[static_cast<std::size_t>(o.a)].name,
                       scene.bodies[static_cast<std::size_t>(o.b)].name, static_cast<std::int64_t>(o.triangles.size()),
                       o.place, triangles_of(scene, o, 0), triangles_of(scene, o, 1)});
    return out;
}

void count_bodies(const Scene& scene, SceneCheck& check) {
    constexpr std::array<bool, 3> kNone{};
    check.shapes = static_cast<std::int64_t>(scene.shapes.size());
    for (const BodyDescription& body : scene.bodies) {
        const Shape& shape = scene.shapes[static_cast<std::size_t>(body.shape)];
        check.triangles += static_cast<std::int64_t>(shape.mesh.triangles.size());
        switch (body.type) {
        case BodyType::dynamic:
            ++check.dynamic_bodies;
            check.mass += shape.mass->mass;
            if (body.locked_translation != kNone || body.locked_rotation != kNone) ++check.locked_bodies;
            if (body.force != Vec3{} || body.torque != Vec3{}) ++check.driven_bodies;
            break;
        case BodyType::fixed: ++check.static_bodies; break;
        case BodyType::kinematic: ++check.kinematic_bodies; break;
        }
    }
}

// OBJ group names end at white space.
std::string group_name(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == '\t'; }, '_');
    return name;
}

void write_group(std::ostream& out, const std::string& name, const std::vector<std::array<Vec3, 3>>& triangles,
                 std::size_t& vertices) {
    out << "g " << name << '\n';
    for (const auto& t : triangles)
        for (const Vec3& v : t) out << "v " << to_text(v.x) << ' ' << to_text(v.y) << ' ' << to_text(v.z) << '\n';
    for (std::size_t i = 0; i < triangles.size(); ++i, vertices += 3)
        out << "f " << vertices + 1 << ' ' << vertices + 2 << ' ' << vertices + 3 << '\n';
}

bool repaired(Scene scene, std::vector<InitialRepair>& repairs) {
    const SeparatedStart start = separate_overlaps(scene);
    if (!start.not_freed.empty()) return false;
    for (const InitialMove& m : start.moves)
        repairs.push_back({scene.bodies[static_cast<std::size_t>(m.body)].name, m.by});
    return true;
}

} // namespace

SceneCheck check_scene(const SceneDescription& scene, const std::string& source) {
    const DefaultFloatingPoint environment;
    const Scene built = build_scene(scene, source);
    const InitialOverlaps overlaps = find_initial_overlaps(built);
    SceneCheck check;
    count_bodies(built, check);
    check.warnings = built.warnings;
    if (built.settings.initial_overlap != InitialOverlap::separate || !repaired(built, check.repairs))
        check.intersections = describe(built, overlaps.movable);
    check.ignored_intersections = describe(built, overlaps.fixed);
    return check;
}

void write_intersections(const std::filesystem::path& file, std::span<const InitialIntersection> intersections) {
    std::ostringstream out;
    out << "# triangles that intersect at t = 0\n";
    std::size_t vertices = 0;
    for (std::size_t i = 0; i < intersections.size(); ++i) {
        const InitialIntersection& pair = intersections[i];
        const std::string prefix = "pair" + std::to_string(i) + "_";
        write_group(out, prefix + group_name(pair.body_a), pair.triangles_a, vertices);
        write_group(out, prefix + group_name(pair.body_b), pair.triangles_b, vertices);
    }
    io::write_file(file, std::string_view(out.view()));
}

} // namespace flotilla
