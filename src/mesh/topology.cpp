// SPDX-License-Identifier: MIT
#include "mesh/topology.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/index.hpp"
#include "mesh/dd_vec.hpp"
#include "mesh/mesh_file.hpp"

namespace flotilla {
namespace {

/// One side of a triangle as a sortable record.
struct HalfEdge {
    std::int32_t low, high;
    std::int32_t triangle;
    std::int8_t corner;    ///< the side joins corner and corner + 1 mod 3
    std::int8_t direction; ///< +1 from low to high, -1 from high to low
};

bool same_edge(const HalfEdge& a, const HalfEdge& b) { return a.low == b.low && a.high == b.high; }

template <class Keep>
std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh, Keep&& keep) {
    std::vector<HalfEdge> h;
    h.reserve(3 * mesh.triangles.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& v = mesh.triangles[t];
        if (!keep(v)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t a = v[k], b = v[(k + 1) % 3];
            h.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), static_cast<std::int8_t>(k),
                         static_cast<std::int8_t>(a <= b ? 1 : -1)});
        }
    }
    std::sort(h.begin(), h.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::array{a.low, a.high, a.triangle, std::int32_t{a.corner}} <
               std::array{b.low, b.high, b.triangle, std::int32_t{b.corner}};
    });
    return h;
}

/// Calls visit(begin, end) for each run of equal edges.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& h, Visit&& visit) {
    for (auto first = h.begin(); first != h.end();) {
        const auto last = std::find_if(first, h.end(), [&](const HalfEdge& x) { return !same_edge(*first, x); });
        visit(first, last);
        first = last;
    }
}

bool distinct(const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; }

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
    return !is_zero_area(mesh.vertices[at(t[0])], mesh.vertices[at(t[1])], mesh.vertices[at(t[2])]);
}

Closedness closedness_of(const std::vector<HalfEdge>& half_edges) {
    Closedness c{!half_edges.empty(), !half_edges.empty()};
    for_each_edge(half_edges, [&](auto first, auto last) {
        int sum = 0;
        for (auto e = first; e != last; ++e) sum += e->direction;
        if ((last - first) % 2 != 0) c.closed = false;
        if (sum != 0) c.oriented = false;
    });
    return c;
}

template <class Visit>
void for_each_used_vertex(const TriangleMesh& mesh, Visit&& visit) {
    std::vector<bool> used(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
        for (std::int32_t v : t) used[at(v)] = true;
    for (std::size_t i = 0; i < used.size(); ++i)
        if (used[i]) visit(mesh.vertices[i]);
}

std::int64_t count_duplicates(const TriangleMesh& merged) {
    std::vector<Triangle> sorted = merged.triangles;
    for (Triangle& t : sorted) std::sort(t.begin(), t.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted.end() - std::unique(sorted.begin(), sorted.end());
}

void count_edges(const TriangleMesh& merged, MeshStatistics& s) {
    s.min_edge = std::numeric_limits<double>::infinity();
    for_each_edge(sorted_half_edges(merged, distinct), [&](auto first, auto last) {
        const auto n = last - first;
        s.boundary_edges += n == 1;
        s.non_manifold_edges += n > 2;
        s.misoriented_edges += n == 2 && first->direction == (first + 1)->direction;
        const double l = length(merged.vertices[at(first->high)] - merged.vertices[at(first->low)]);
        s.min_edge = std::min(s.min_edge, l);
        s.max_edge = std::max(s.max_edge, l);
    });
    if (s.max_edge == 0) s.min_edge = 0;
}

void list_around(const TriangleMesh& mesh, Topology& t) {
    t.place = number_positions(mesh.vertices);
    const std::int32_t places = t.place.empty() ? 0 : 1 + *std::max_element(t.place.begin(), t.place.end());
    // Calls visit(place, triangle) once for each place where a triangle has corners.
    const auto for_each_corner = [&](auto&& visit) {
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const Triangle& v = mesh.triangles[i];
            const std::int32_t p = t.place[at(v[0])], q = t.place[at(v[1])], r = t.place[at(v[2])];
            visit(p, static_cast<std::int32_t>(i));
            if (q != p) visit(q, static_cast<std::int32_t>(i));
            if (r != p && r != q) visit(r, static_cast<std::int32_t>(i));
        }
    };
    t.first_around.assign(at(places) + 1, 0);
    for_each_corner([&](std::int32_t p, std::int32_t) { ++t.first_around[at(p) + 1]; });
    std::partial_sum(t.first_around.begin(), t.first_around.end(), t.first_around.begin());
    t.around.resize(at(t.first_around.back()));
    std::vector<std::int32_t> next = t.first_around;
    for_each_corner([&](std::int32_t p, std::int32_t triangle) { t.around[at(next[at(p)]++)] = triangle; });
}

/// Of the size of a mesh, how far the vertices of a flat face may be from one plane: the rounding of coordinates in
/// single precision, and 1/500 of the default rest distance of a plate a thousand times as wide as thick.
constexpr double kFlat = 0x1p-24;

/// The triangles with a vertex for each position.
TriangleMesh by_place(const TriangleMesh& mesh, const Topology& t) {
    TriangleMesh out;
    out.triangles.reserve(mesh.triangles.size());
    for (const Triangle& v : mesh.triangles)
        out.triangles.push_back({t.place[at(v[0])], t.place[at(v[1])], t.place[at(v[2])]});
    return out;
}

/// Flat faces: each grows from its first triangle over edges to what is in the plane of that.
class FlatFaces {
  public:
    FlatFaces(const TriangleMesh& mesh, const std::vector<HalfEdge>& half_edges)
        : mesh_(mesh), beside_(mesh.triangles.size(), {-1, -1, -1}), face_(mesh.triangles.size(), -1) {
        const Box box = bounding_box(mesh);
        const double most = mesh.triangles.empty() ? 0 : kFlat * length(box.upper - box.lower); // m
        normal_.reserve(mesh.triangles.size());
        for (const Triangle& t : mesh.triangles) normal_.push_back(normal(t));
        for_each_edge(half_edges, [&](auto first, auto last) {
            if (last - first == 2 && unfolded(*first, *(first + 1))) join(*first, *(first + 1));
        });
        for (std::size_t seed = 0; seed < face_.size(); ++seed)
            if (face_[seed] < 0 && normal_[seed] != Vec3{}) grow(static_cast<std::int32_t>(seed), most);
    }

    /// Whether the side of a triangle lies within a face.
    [[nodiscard]] bool inside(const HalfEdge& h) const {
        const std::int32_t other = beside_[at(h.triangle)][at(h.corner)];
        return other >= 0 && face_[at(other)] == face_[at(h.triangle)];
    }

  private:
    /// Zero without area; of needles, too, in more than double precision.
    [[nodiscard]] Vec3 normal(const Triangle& t) const {
        const Vec3 &a = mesh_.vertices[at(t[0])], &b = mesh_.vertices[at(t[1])], &c = mesh_.vertices[at(t[2])];
        return has_area(mesh_, t) ? normalized(to_double(doubled_area_vector(a, b, c))) : Vec3{};
    }

    /// Whether two triangles, both with area, lie on either side of their edge.
    [[nodiscard]] bool unfolded(const HalfEdge& x, const HalfEdge& y) const {
        return -x.direction * y.direction * dot(normal_[at(x.triangle)], normal_[at(y.triangle)]) > 0;
    }

    void join(const HalfEdge& x, const HalfEdge& y) {
        beside_[at(x.triangle)][at(x.corner)] = y.triangle;
        beside_[at(y.triangle)][at(y.corner)] = x.triangle;
    }

    void grow(std::int32_t seed, double most) {
        const Vec3 &origin = mesh_.vertices[at(mesh_.triangles[at(seed)][0])], &normal = normal_[at(seed)];
        const auto in_plane = [&](std::int32_t v) {
            return std::abs(dot(normal, mesh_.vertices[at(v)] - origin)) <= most;
        };
        face_[at(seed)] = seed;
        open_.assign(1, seed);
        while (!open_.empty()) {
            const std::int32_t t = open_.back();
            open_.pop_back();
            for (const std::int32_t next : beside_[at(t)]) {
                if (next < 0 || face_[at(next)] >= 0) continue;
                if (!std::ranges::all_of(mesh_.triangles[at(next)], in_plane)) continue;
                face_[at(next)] = seed;
                open_.push_back(next);
            }
        }
    }

    const TriangleMesh& mesh_;
    std::vector<Vec3> normal_;                        // by triangle
    std::vector<std::array<std::int32_t, 3>> beside_; // by triangle and side: across an edge of two triangles
    std::vector<std::int32_t> face_, open_;           // by triangle, its first one; to grow from
};

/// Sets Topology::salient_vertex and salient_edge.
void mark_salient(const TriangleMesh& mesh, Topology& t) {
    const auto all = [](const Triangle&) { return true; };
    const std::vector<HalfEdge> half_edges = sorted_half_edges(by_place(mesh, t), all);
    const FlatFaces faces(mesh, half_edges);
    t.salient_edge.assign(t.edges.size(), 0);
    t.salient_vertex.assign(mesh.vertices.size(), 0);
    std::vector<std::uint8_t> inside(t.first_around.size(), 0), on_rim = inside; // by place
    for_each_edge(half_edges, [&](auto first, auto last) {
        if (first->low == first->high) return;
        const bool flat = faces.inside(*first);
        std::vector<std::uint8_t>& ends = flat ? inside : on_rim;
        ends[at(first->low)] = ends[at(first->high)] = 1;
        if (flat) return;
        const auto id = [&](const HalfEdge& h) { return t.triangle_edges[at(h.triangle)][at(h.corner)]; };
        std::int32_t lowest = id(*first); // of copies
        for (auto h = first; h != last; ++h) lowest = std::min(lowest, id(*h));
        t.salient_edge[at(lowest)] = 1;
    });
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        if (t.vertex_owner[v] < 0) continue;
        const std::size_t p = at(t.place[v]);
        t.salient_vertex[v] = on_rim[p] != 0 || inside[p] == 0 ? 1 : 0; // a point alone is one
        on_rim[p] = 0, inside[p] = 1;                                   // and those after it there are copies
    }
}

} // namespace

Topology build_topology(const TriangleMesh& mesh) {
    Topology t;
    t.triangle_edges.resize(mesh.triangles.size());
    t.owned.resize(mesh.triangles.size());
    t.vertex_owner.assign(mesh.vertices.size(), -1);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            std::int32_t& owner = t.vertex_owner[at(mesh.triangles[i][k])];
            if (owner >= 0) continue;
            owner = static_cast<std::int32_t>(i);
            t.owned[i] = static_cast<std::uint8_t>(t.owned[i] | (1u << k));
        }
    const auto all = [](const Triangle&) { return true; };
    for_each_edge(sorted_half_edges(mesh, all), [&](auto first, auto last) {
        const auto id = static_cast<std::int32_t>(t.edges.size());
        t.edges.push_back({first->low, first->high});
        t.edge_owner.push_back(first->triangle);
        t.owned[at(first->triangle)] = static_cast<std::uint8_t>(t.owned[at(first->triangle)] | (8u << first->corner));
        for (auto e = first; e != last; ++e) t.triangle_edges[at(e->triangle)][at(e->corner)] = id;
    });
    list_around(mesh, t);
    mark_salient(mesh, t);
    return t;
}

bool is_zero_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    const DdVec3 n = doubled_area_vector(a, b, c);
    const double bound = 0x1p-80 * (length(b - a) * length(c - a));
    return !(length(to_double(n)) > bound);
}

Closedness closedness(const TriangleMesh& mesh) {
    const TriangleMesh merged = merge_equal_vertices(mesh);
    const Closedness all = closedness_of(sorted_half_edges(merged, distinct));
    if (all.oriented) return all;
    const Closedness with_area =
        closedness_of(sorted_half_edges(merged, [&](const Triangle& t) { return distinct(t) && has_area(merged, t); }));
    return with_area.oriented || !all.closed ? with_area : all;
}

double bounding_radius(const TriangleMesh& mesh, const Vec3& center) {
    double r_sq = 0;
    for_each_used_vertex(mesh, [&](const Vec3& v) { r_sq = std::max(r_sq, length_sq(v - center)); });
    // Differences, squares, sums and the root round by less than 4 u relative to the result; differences of coordinates
    // are correctly rounded, so nothing cancels.
    return std::sqrt(r_sq) * (1 + 8 * std::numeric_limits<double>::epsilon());
}

BoundingSphere bounding_sphere(const TriangleMesh& mesh) {
    // Badoiu and Clarkson 2003: step k moves the centre 1/(k + 1) of the way to the farthest vertex; the radius
    // converges to the smallest like 1/k at worst.
    constexpr int kSteps = 128;
    std::vector<Vec3> vertices;
    for_each_used_vertex(mesh, [&](const Vec3& v) { vertices.push_back(v); });
    Vec3 c = center(bounding_box(mesh)), best = c;
    double best_sq = std::numeric_limits<double>::infinity();
    for (int k = 1; k <= kSteps && !vertices.empty(); ++k) {
        const auto farthest = std::max_element(vertices.begin(), vertices.end(), [&](const Vec3& a, const Vec3& b) {
            return length_sq(a - c) < length_sq(b - c);
        });
        if (length_sq(*farthest - c) < best_sq) {
            best_sq = length_sq(*farthest - c);
            best = c;
        }
        c += (1.0 / (k + 1)) * (*farthest - c);
    }
    return {best, bounding_radius(mesh, best)};
}

Box bounding_box(const TriangleMesh& mesh) {
    Box box;
    for_each_used_vertex(mesh, [&](const Vec3& v) { box = extended(box, v); });
    return box;
}

MeshStatistics mesh_statistics(const TriangleMesh& mesh) {
    const TriangleMesh merged = merge_equal_vertices(mesh);
    MeshStatistics s;
    s.vertices = static_cast<std::int64_t>(mesh.vertices.size());
    s.triangles = static_cast<std::int64_t>(mesh.triangles.size());
    const Topology topology = build_topology(mesh);
    s.edges = static_cast<std::int64_t>(topology.edges.size());
    s.unused_vertices = std::count(topology.vertex_owner.begin(), topology.vertex_owner.end(), -1);
    s.duplicate_triangles = count_duplicates(merged);
    count_edges(merged, s);
    DoubleDouble area;
    for (const Triangle& t : mesh.triangles) {
        const DdVec3 n = doubled_area_vector(mesh.vertices[at(t[0])], mesh.vertices[at(t[1])], mesh.vertices[at(t[2])]);
        if (has_area(mesh, t))
            area += DoubleDouble(0.5) * sqrt(dot(n, n));
        else
            ++s.zero_area_triangles;
    }
    s.area = to_double(area);
    s.box = bounding_box(mesh);
    s.closedness = closedness(mesh);
    return s;
}

} // namespace flotilla
