// SPDX-License-Identifier: MIT
#include "mesh/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/assert.hpp"
#include "mesh/building.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

/// Cells of a grid of (nu + 1) x (nv + 1) vertices, u running fastest, that starts at `first`. Where `closed_u` or
/// `closed_v` is set there are only nu or nv vertices that way and the last cell comes back to the first.
void add_grid(TriangleMesh& mesh, std::int32_t first, int nu, int nv, bool closed_u, bool closed_v) {
    const int row = closed_u ? nu : nu + 1;
    const auto index = [&](int u, int v) { return first + (closed_v ? v % nv : v) * row + (closed_u ? u % nu : u); };
    for (int v = 0; v < nv; ++v)
        for (int u = 0; u < nu; ++u) add_quad(mesh, index(u, v), index(u + 1, v), index(u + 1, v + 1), index(u, v + 1));
}

/// A rectangle of n x m cells at `origin` spanned by u and v.
void add_rectangle(TriangleMesh& mesh, const Vec3& origin, const Vec3& u, const Vec3& v, int nu, int nv) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i <= nu; ++i)
            // Ends exactly on the far corner, so that neighbouring faces meet bit for bit.
            add_vertex(mesh, origin + (i == nu ? u : (1.0 * i / nu) * u) + (j == nv ? v : (1.0 * j / nv) * v));
    add_grid(mesh, first, nu, nv, false, false);
}

/// A fan around `hub` over the circle of vertices first .. first + segments - 1, facing +z or -z.
void add_fan(TriangleMesh& mesh, std::int32_t hub, std::int32_t first, int segments, bool up) {
    for (int i = 0; i < segments; ++i) {
        const std::int32_t a = first + i, b = first + (i + 1) % segments;
        mesh.triangles.push_back(up ? Triangle{hub, a, b} : Triangle{hub, b, a});
    }
}

TriangleMesh icosahedron() {
    const double g = (1 + std::sqrt(5.0)) / 2;
    return {{{-1, g, 0},
             {1, g, 0},
             {-1, -g, 0},
             {1, -g, 0},
             {0, -1, g},
             {0, 1, g},
             {0, -1, -g},
             {0, 1, -g},
             {g, 0, -1},
             {g, 0, 1},
             {-g, 0, -1},
             {-g, 0, 1}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
}

void put_on_sphere(std::vector<Vec3>& vertices, double radius) {
    for (Vec3& v : vertices) v = radius * normalized(v);
}

/// Divides every triangle in four at the middles of its edges.
TriangleMesh divided(const TriangleMesh& mesh) {
    const Topology topology = build_topology(mesh);
    TriangleMesh finer{mesh.vertices, {}};
    for (const Edge& e : topology.edges)
        add_vertex(finer, 0.5 * (mesh.vertices[static_cast<std::size_t>(e[0])] +
                                 mesh.vertices[static_cast<std::size_t>(e[1])]));
    const auto first_middle = static_cast<std::int32_t>(mesh.vertices.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = mesh.triangles[t];
        const std::int32_t ab = first_middle + topology.triangle_edges[t][0],
                           bc = first_middle + topology.triangle_edges[t][1],
                           ca = first_middle + topology.triangle_edges[t][2];
        finer.triangles.insert(finer.triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return finer;
}

} // namespace

TriangleMesh make_plate(double size_x, double size_y, int nx, int ny) {
    FLOTILLA_ASSERT(size_x > 0 && size_y > 0 && nx > 0 && ny > 0);
    TriangleMesh mesh;
    add_rectangle(mesh, {-size_x / 2, -size_y / 2, 0}, {size_x, 0, 0}, {0, size_y, 0}, nx, ny);
    return mesh;
}

TriangleMesh make_box(double size_x, double size_y, double size_z, int n) {
    FLOTILLA_ASSERT(size_x > 0 && size_y > 0 && size_z > 0 && n > 0);
    const Vec3 x{size_x, 0, 0}, y{0, size_y, 0}, z{0, 0, size_z}, low = -0.5 * (x + y + z);
    TriangleMesh mesh;
    add_rectangle(mesh, low, y, x, n, n);
    add_rectangle(mesh, low, z, y, n, n);
    add_rectangle(mesh, low, x, z, n, n);
    add_rectangle(mesh, low + z, x, y, n, n);
    add_rectangle(mesh, low + x, y, z, n, n);
    add_rectangle(mesh, low + y, z, x, n, n);
    return merge_equal_vertices(mesh);
}

TriangleMesh make_sphere(double radius, int subdivisions) {
    FLOTILLA_ASSERT(radius > 0 && subdivisions >= 0);
    TriangleMesh mesh = icosahedron();
    put_on_sphere(mesh.vertices, radius);
    for (int i = 0; i < subdivisions; ++i) {
        mesh = divided(mesh);
        put_on_sphere(mesh.vertices, radius);
    }
    return mesh;
}

TriangleMesh make_tube(double radius, double height, int segments, int rings) {
    FLOTILLA_ASSERT(radius > 0 && height > 0 && segments >= 3 && rings > 0);
    TriangleMesh mesh;
    for (int j = 0; j <= rings; ++j)
        for (int i = 0; i < segments; ++i) {
            const auto [s, c] = fraction_of_turn(i, segments);
            add_vertex(mesh, {radius * c, radius * s, height * (1.0 * j / rings - 0.5)});
        }
    add_grid(mesh, 0, segments, rings, true, false);
    return mesh;
}

TriangleMesh make_cylinder(double radius, double height, int segments, int rings) {
    TriangleMesh mesh = make_tube(radius, height, segments, rings);
    const std::int32_t bottom = add_vertex(mesh, {0, 0, -height / 2}), top = add_vertex(mesh, {0, 0, height / 2});
    add_fan(mesh, bottom, 0, segments, false);
    add_fan(mesh, top, rings * segments, segments, true);
    return mesh;
}

TriangleMesh make_disc(double radius, int segments) {
    FLOTILLA_ASSERT(radius > 0 && segments >= 3);
    TriangleMesh mesh;
    for (int i = 0; i < segments; ++i) {
        const auto [s, c] = fraction_of_turn(i, segments);
        add_vertex(mesh, {radius * c, radius * s, 0});
    }
    add_fan(mesh, add_vertex(mesh, {}), 0, segments, true);
    return mesh;
}

TriangleMesh make_ring(double ring_radius, double tube_radius, int segments, int tube_segments) {
    FLOTILLA_ASSERT(tube_radius > 0 && tube_radius < ring_radius && segments >= 3 && tube_segments >= 3);
    TriangleMesh mesh;
    for (int j = 0; j < tube_segments; ++j) {
        const auto [st, ct] = fraction_of_turn(j, tube_segments);
        for (int i = 0; i < segments; ++i) {
            const auto [s, c] = fraction_of_turn(i, segments);
            const double r = ring_radius + tube_radius * ct;
            add_vertex(mesh, {r * c, r * s, tube_radius * st});
        }
    }
    add_grid(mesh, 0, segments, tube_segments, true, true);
    return mesh;
}

} // namespace flotilla
