// SPDX-License-Identifier: MIT
// Is a scene ready to run?
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <flotilla/scene.hpp>

namespace flotilla {

/// Two bodies that intersect where they start. Touching counts, and so does a gap too small for double precision.
struct InitialIntersection {
    std::string body_a, body_b;
    std::int64_t triangle_pairs = 0;                           ///< that intersect
    Vec3 place;                                                ///< m, in the middle of one of them
    std::vector<std::array<Vec3, 3>> triangles_a, triangles_b; ///< those that take part, each once, world coordinates
};

/// A body that `initial_overlap: separate` will move.
struct InitialRepair {
    std::string body;
    Vec3 by; ///< m
};

struct SceneCheck {
    std::int64_t dynamic_bodies = 0, static_bodies = 0, kinematic_bodies = 0;
    std::int64_t locked_bodies = 0,
                 driven_bodies = 0; ///< of the dynamic ones: with locked axes; with a force or a torque
    std::int64_t shapes = 0;        ///< identical ones counted once
    std::int64_t triangles = 0;     ///< of all bodies
    double mass = 0;                ///< kg, of the dynamic bodies
    std::vector<std::string> warnings;
    /// The scene cannot start with these. With `initial_overlap: separate` they are listed only where no moves free all
    /// bodies.
    std::vector<InitialIntersection> intersections;
    std::vector<InitialRepair> repairs; ///< with `initial_overlap: separate`: the moves that free all bodies
    /// Between bodies of infinite mass (static, kinematic): allowed, nothing keeps them apart.
    std::vector<InitialIntersection> ignored_intersections;
};

/// Validates a scene and looks for bodies that intersect at t = 0, exactly. Throws InputError with every problem of an
/// invalid scene; `source` starts each line.
[[nodiscard]] SceneCheck check_scene(const SceneDescription& scene, const std::string& source = "scene");

/// Writes the triangles of `intersections` as an OBJ file, one group per pair and body. Throws IoError.
void write_intersections(const std::filesystem::path& file, std::span<const InitialIntersection> intersections);

} // namespace flotilla
