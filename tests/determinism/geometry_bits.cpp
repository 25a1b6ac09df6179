// SPDX-License-Identifier: MIT
// Prints a hash of the result bits of every group of geometry functions over the same inputs: random and degenerate,
// small and far from the origin. Builds by different compilers and at different optimisation levels must print the same
// text.
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "base/rotation.hpp"
#include "geometry/ccd.hpp"
#include "geometry/closest.hpp"
#include "geometry/exact/triangle_triangle.hpp"
#include "geometry/ray.hpp"
#include "mesh/mass_properties.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

/// splitmix64: integers only, so that the inputs are the same everywhere.
class Generator {
  public:
    explicit Generator(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        state_ += 0x9e3779b97f4a7c15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint64_t below(std::uint64_t n) { return bits() % n; }
    /// A multiple of 2^-52 in [-1, 1).
    double uniform() { return static_cast<double>(static_cast<std::int64_t>(bits()) >> 11) * 0x1p-52; }
    /// One of -1, -1/2, 0, 1/2, 1: many coincidences.
    double lattice() { return 0.5 * static_cast<double>(below(5)) - 1.0; }

  private:
    std::uint64_t state_;
};

/// 64 bits of everything added so far (FNV-1a over whole words). All NaNs count as one: which operand's payload
/// survives an operation is the compiler's choice.
class BitHash {
  public:
    void add(std::uint64_t word) { hash_ = std::rotl((hash_ ^ word) * 0x100000001b3u, 29); }
    void add(double x) { add(x == x ? std::bit_cast<std::uint64_t>(x) : 0x7ff8000000000000u); }
    void add(const Vec3& v) {
        for (double x : {v.x, v.y, v.z}) add(x);
    }
    void add(const Quat& q) {
        for (double x : {q.w, q.x, q.y, q.z}) add(x);
    }
    void add(const Mat3& m) {
        for (double x : m.m) add(x);
    }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

  private:
    std::uint64_t hash_ = 0xcbf29ce484222325u;
};

/// A cloud of points to make features from: its kind decides what coincides, what is flat and how far away it is.
class PointSource {
  public:
    explicit PointSource(Generator& generator) : generator_(generator), kind_(generator.below(6)) {
        const double far = kind_ == 3 ? 1e6 : 0.0;
        offset_ = {far * generator_.uniform(), far * generator_.uniform(), far * generator_.uniform()};
        scale_ = kind_ == 4 ? 0x1p-20 : 1.0;
    }
    Vec3 point() {
        if (kind_ == 1) return {generator_.lattice(), generator_.lattice(), generator_.lattice()};
        if (kind_ == 2) return {generator_.uniform(), generator_.uniform(), 0.0}; // coplanar
        if (kind_ == 5)
            return {generator_.uniform(), 1e-9 * generator_.uniform(), 1e-12 * generator_.uniform()}; // needles
        return offset_ + scale_ * Vec3{generator_.uniform(), generator_.uniform(), generator_.uniform()};
    }

  private:
    Generator& generator_;
    std::uint64_t kind_;
    Vec3 offset_;
    double scale_ = 1;
};

void hash_sin_cos(Generator& g, BitHash& hash) {
    const double scales[] = {1e-8, 1.0, 10.0, 1e3, 1e6, 1e9};
    const auto [s, c] = sin_cos(scales[g.below(6)] * g.uniform());
    hash.add(s);
    hash.add(c);
}

void hash_rotations(Generator& g, BitHash& hash) {
    const double scales[] = {1e-12, 1e-3, 1.0, 10.0};
    const double scale = scales[g.below(4)];
    const Vec3 w = scale * Vec3{g.uniform(), g.uniform(), g.uniform()};
    const Quat q = rotation_from_vector(w);
    const Quat r = normalized(Quat{g.uniform(), g.uniform(), g.uniform(), g.uniform()});
    hash.add(q);
    hash.add(q * r);
    hash.add(rotation_vector(r));
    hash.add(matrix(r));
    hash.add(quaternion(matrix(r)));
    hash.add(rotate(r, w));
}

void hash_closest(Generator& g, BitHash& hash) {
    PointSource source(g);
    std::array<Vec3, 6> p;
    for (Vec3& x : p) x = source.point();
    const auto vt = closest_vertex_triangle(p[0], p[1], p[2], p[3]);
    for (double b : vt.barycentric) hash.add(b);
    hash.add(vt.point);
    hash.add(vt.distance_sq);
    const auto ee = closest_edge_edge(p[0], p[1], p[2], p[3]);
    for (double x : {ee.s, ee.t, ee.distance_sq}) hash.add(x);
    hash.add(ee.p);
    hash.add(ee.q);
    const auto tt = closest_triangle_triangle({p[0], p[1], p[2]}, {p[3], p[4], p[5]});
    hash.add(tt.p);
    hash.add(tt.q);
    hash.add(tt.distance_sq);
}

void hash_exact(Generator& g, BitHash& hash) {
    PointSource source(g);
    std::array<Vec3, 6> p;
    for (Vec3& x : p) x = source.point();
    const bool meet = exact::triangles_intersect({p[0], p[1], p[2]}, {p[3], p[4], p[5]});
    const bool cut = exact::segment_intersects_triangle(p[0], p[1], {p[3], p[4], p[5]});
    hash.add(std::uint64_t{meet} << 1 | std::uint64_t{cut});
}

void hash_segment_triangle(Generator& g, BitHash& hash) {
    PointSource source(g);
    std::array<Vec3, 5> p;
    for (Vec3& x : p) x = source.point();
    hash.add(segment_triangle(p[0], p[1], p[2], p[3], p[4]).value_or(-1.0));
}

CcdQuery random_query(Generator& g) {
    PointSource source(g);
    const double speed = g.below(2) == 0 ? 1.0 : 1e-3;
    CcdQuery query;
    for (std::size_t i = 0; i < 4; ++i) {
        query.x0[i] = source.point();
        query.x1[i] = query.x0[i] + speed * Vec3{g.uniform(), g.uniform(), g.uniform()};
    }
    return query;
}

void add(BitHash& hash, const CcdResult& result) {
    hash.add(result.direction);
    hash.add(result.toi);
    hash.add(std::uint64_t{result.hit} << 32 | std::uint64_t{result.iterations});
}

/// One feature pair by the scalar code, and the direction it found as a witness.
void hash_ccd(CcdKind kind, Generator& g, BitHash& hash) {
    const CcdQuery query = random_query(g);
    const double separation = g.below(2) == 0 ? 0.0 : 1e-4;
    const CcdStart start = g.below(2) == 0 ? CcdStart::strict : CcdStart::relaxed;
    const CcdResult result = ccd(kind, query, {separation, start});
    add(hash, result);
    hash.add(std::uint64_t{certified_along(kind, query, result.direction, separation)});
}

/// The same by the widest kernel that this machine has.
void hash_ccd_wide(CcdKind kind, Generator& g, BitHash& hash) {
    std::vector<CcdQuery> queries(19);
    for (CcdQuery& query : queries) query = random_query(g);
    std::vector<CcdResult> results(queries.size());
    ccd_batch(kind, queries, {1e-4, CcdStart::relaxed}, results, best_isa());
    for (const CcdResult& result : results) add(hash, result);
}

/// A triangle soup, and the tetrahedra of its triangles with one corner as a closed mesh.
void hash_mass_properties(Generator& g, BitHash& hash) {
    const Vec3 offset = g.below(2) == 0 ? Vec3{} : Vec3{1e3, -1e3, 1e2};
    TriangleMesh soup, closed;
    for (int i = 0; i < 8; ++i) {
        const auto first = static_cast<std::int32_t>(closed.vertices.size());
        for (int k = 0; k < 4; ++k) closed.vertices.push_back(offset + Vec3{g.uniform(), g.uniform(), g.uniform()});
        soup.triangles.push_back({first, first + 1, first + 2});
        for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{1, 3, 2}, Triangle{2, 3, 0}})
            closed.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    soup.vertices = closed.vertices;
    for (const MassProperties& m :
         {shell_mass_properties(soup, 10.0, "soup"), spread_mass_properties(closed, 3.0, "closed")}) {
        hash.add(m.mass);
        hash.add(m.center_of_mass);
        hash.add(m.inertia);
        hash.add(m.principal_inertia);
        hash.add(m.principal_axes);
    }
    const BoundingSphere sphere = bounding_sphere(soup);
    hash.add(sphere.center);
    hash.add(sphere.radius);
}

void print(const std::string& group, int count, const std::function<void(Generator&, BitHash&)>& body) {
    Generator generator(42);
    BitHash hash;
    for (int i = 0; i < count; ++i) body(generator, hash);
    std::printf("%-24s %8d %016llx\n", group.c_str(), count, static_cast<unsigned long long>(hash.value()));
}

void print_all() {
    const auto of_kind = [](auto body, CcdKind kind) {
        return [=](Generator& g, BitHash& hash) { body(kind, g, hash); };
    };
    print("sin_cos", 200000, hash_sin_cos);
    print("rotations", 100000, hash_rotations);
    print("closest", 100000, hash_closest);
    print("segment_triangle", 100000, hash_segment_triangle);
    print("exact", 100000, hash_exact);
    print("ccd vertex_face", 100000, of_kind(hash_ccd, CcdKind::vertex_face));
    print("ccd edge_edge", 100000, of_kind(hash_ccd, CcdKind::edge_edge));
    print("ccd vertex_face wide", 5000, of_kind(hash_ccd_wide, CcdKind::vertex_face));
    print("ccd edge_edge wide", 5000, of_kind(hash_ccd_wide, CcdKind::edge_edge));
    print("mass_properties", 2000, hash_mass_properties);
}

} // namespace
} // namespace flotilla

int main() {
    flotilla::print_all();
    return 0;
}
