// SPDX-License-Identifier: MIT
// What generators of meshes have in common.
#pragma once

#include <cstdint>
#include <numbers>

#include "base/rotation.hpp"
#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// Of the angle of i nths of a turn.
inline SinCos fraction_of_turn(double i, int n) { return sin_cos(2 * std::numbers::pi * i / n); }

/// Its index.
inline std::int32_t add_vertex(TriangleMesh& mesh, const Vec3& v) {
    mesh.vertices.push_back(v);
    return static_cast<std::int32_t>(mesh.vertices.size() - 1);
}

/// Two triangles of the quadrilateral a b c d.
inline void add_quad(TriangleMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
}

} // namespace flotilla
