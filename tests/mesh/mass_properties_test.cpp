// SPDX-License-Identifier: MIT
#include "mesh/mass_properties.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include <flotilla/error.hpp>
#include <gmpxx.h>
#include <gtest/gtest.h>

#include "base/rotation.hpp"
#include "mesh/mesh_file.hpp"
#include "mesh/primitives.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

/// Bits of the multiple-precision oracle: 120 decimal digits for the square roots that areas need; all else is
/// rational.
constexpr unsigned kOracleBits = 400;

using Rational3 = std::array<mpq_class, 3>;

Rational3 exact(const Vec3& v) { return {mpq_class(v.x), mpq_class(v.y), mpq_class(v.z)}; }
Rational3 operator-(const Rational3& a, const Rational3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Rational3 cross(const Rational3& a, const Rational3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
mpq_class dot(const Rational3& a, const Rational3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
mpf_class real(const mpq_class& q) { return mpf_class(q, kOracleBits); }

/// Mass properties of the polyhedron by point rules that are exact for quadratics, about the origin: edge midpoints of
/// each triangle (surfaces), corners and centroid of each tetrahedron (volumes).
struct Oracle {
    mpf_class mass{0, kOracleBits};
    std::array<mpf_class, 3> first{mpf_class(0, kOracleBits), mpf_class(0, kOracleBits), mpf_class(0, kOracleBits)};
    std::array<std::array<mpf_class, 3>, 3> second{first, first, first};

    void add(const mpf_class& weight, const Rational3& p) {
        mass += weight;
        for (std::size_t i = 0; i < 3; ++i) {
            first[i] += weight * real(p[i]);
            for (std::size_t j = 0; j < 3; ++j) second[i][j] += weight * real(p[i] * p[j]);
        }
    }

    void add_triangle(const Rational3& a, const Rational3& b, const Rational3& c) {
        const Rational3 n = cross(b - a, c - a);
        const mpf_class third = sqrt(real(dot(n, n))) / 6;
        const auto middle = [](const Rational3& p, const Rational3& q) -> Rational3 {
            return {(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2};
        };
        add(third, middle(a, b));
        add(third, middle(b, c));
        add(third, middle(c, a));
    }

    /// With the origin as fourth corner: weights 1/20 at the corners and 16/20 at the centroid are exact to degree 2.
    void add_tetrahedron(const Rational3& a, const Rational3& b, const Rational3& c) {
        const mpf_class v = real(dot(a, cross(b, c)) / 6);
        const Rational3 zero{}, centroid{(a[0] + b[0] + c[0]) / 4, (a[1] + b[1] + c[1]) / 4, (a[2] + b[2] + c[2]) / 4};
        for (const Rational3& p : {zero, a, b, c}) add(v / 20, p);
        add(v * 4 / 5, centroid);
    }

    [[nodiscard]] double center(std::size_t i) const { return mpf_class(first[i] / mass).get_d(); }
    [[nodiscard]] double inertia(std::size_t i, std::size_t j) const {
        const auto central = [&](std::size_t k, std::size_t l) -> mpf_class {
            return second[k][l] - first[k] * first[l] / mass;
        };
        if (i != j) return -central(i, j).get_d();
        return mpf_class(central((i + 1) % 3, (i + 1) % 3) + central((i + 2) % 3, (i + 2) % 3)).get_d();
    }
};

Oracle oracle(const TriangleMesh& mesh, bool solid) {
    Oracle o;
    for (const Triangle& t : mesh.triangles) {
        const auto corner = [&](std::size_t k) { return exact(mesh.vertices[static_cast<std::size_t>(t[k])]); };
        if (solid)
            o.add_tetrahedron(corner(0), corner(1), corner(2));
        else
            o.add_triangle(corner(0), corner(1), corner(2));
    }
    return o;
}

double largest(const Mat3& a) {
    double m = 0;
    for (double x : a.m) m = std::max(m, std::abs(x));
    return m;
}

/// The largest relative error against the oracle (density 1); of the centre relative to the size of the shape or its
/// distance from the origin, whichever is larger.
double relative_error(const TriangleMesh& mesh, bool solid) {
    const MassProperties p = solid ? solid_mass_properties(mesh, 1, "shape") : shell_mass_properties(mesh, 1, "shape");
    const Oracle o = oracle(mesh, solid);
    const double scale = largest(p.inertia);
    const double length_scale =
        std::max(max_component(extent(bounding_box(mesh))), max_abs_coordinate(bounding_box(mesh)));
    double error = std::abs(p.mass / o.mass.get_d() - 1);
    for (std::size_t i = 0; i < 3; ++i) {
        error =
            std::max(error, std::abs(component(p.center_of_mass, static_cast<int>(i)) - o.center(i)) / length_scale);
        for (std::size_t j = 0; j < 3; ++j)
            error = std::max(error, std::abs(p.inertia.m[3 * i + j] - o.inertia(i, j)) / scale);
    }
    return error;
}

TriangleMesh moved(TriangleMesh mesh, const Vec3& rotation, const Vec3& offset, double scale = 1) {
    const Mat3 r = matrix(rotation_from_vector(rotation));
    for (Vec3& v : mesh.vertices) v = scale * (r * v) + offset;
    return mesh;
}

/// What any body's mass properties obey.
void expect_physical(const MassProperties& p) {
    EXPECT_GT(p.mass, 0);
    const Vec3& d = p.principal_inertia;
    EXPECT_GT(d.x, 0);
    EXPECT_LE(d.x, d.y);
    EXPECT_LE(d.y, d.z);
    EXPECT_LE(d.z, (d.x + d.y) * (1 + 1e-14));
    EXPECT_NEAR(norm(p.principal_axes), 1, 1e-15);
    const Mat3 r = matrix(p.principal_axes), rebuilt = r * (diagonal(d) * transpose(r));
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(rebuilt.m[k], p.inertia.m[k], 1e-14 * d.z);
    EXPECT_EQ(p.inertia, transpose(p.inertia));
}

TriangleMesh boat() { return read_mesh(FLOTILLA_SOURCE_DIR "/bench/meshes/boat.obj"); }

struct NamedMesh {
    const char* name;
    TriangleMesh mesh;
    bool closed;
};

std::vector<NamedMesh> test_shapes() {
    return {{"plate", make_plate(1.2, 0.7), false},    {"box", make_box(0.3, 2, 1.1), true},
            {"sphere", make_sphere(0.8, 3), true},     {"cylinder", make_cylinder(0.4, 2.5, 40, 3), true},
            {"ring", make_ring(1, 0.2, 32, 12), true}, {"boat", boat(), false}};
}

TEST(MassProperties, AgreeWithTheExactIntegralOfThePolyhedron) {
    for (const NamedMesh& s : test_shapes())
        for (const bool solid : {false, true}) {
            if (solid && !s.closed) continue;
            const double at_origin = relative_error(s.mesh, solid);
            const double turned = relative_error(moved(s.mesh, {0.3, -1.1, 0.7}, {0.1, 0.2, 0.3}), solid);
            const double far = relative_error(moved(s.mesh, {0.3, -1.1, 0.7}, {1e6, -3e5, 2e6}), solid);
            const double small = relative_error(moved(s.mesh, {0.1, 0.1, 0.1}, {}, 1e-6), solid);
            std::printf("%-8s %s: error %.1e, turned %.1e, 2000 km away %.1e, scaled by 1e-6 %.1e\n", s.name,
                        solid ? "solid" : "shell", at_origin, turned, far, small);
            EXPECT_LE(at_origin, 1e-14);
            EXPECT_LE(turned, 1e-14);
            EXPECT_LE(far, 1e-14);
            EXPECT_LE(small, 1e-14);
        }
}

TEST(MassProperties, HoldForNeedlesAndNearlyCancellingVolumes) {
    // A million times longer than wide; a shell of a closed plate a micrometre thick; a soup of random needles.
    EXPECT_LE(relative_error(moved(make_plate(1, 1e-6), {1, 2, 3}, {5, 5, 5}), false), 1e-14);
    EXPECT_LE(relative_error(moved(make_box(1, 1, 1e-6), {1, 2, 3}, {100, 5, 5}), true), 1e-14);
    std::mt19937_64 rng(1);
    std::normal_distribution<double> n;
    TriangleMesh needles;
    for (std::int32_t t = 0; t < 50; ++t) {
        const Vec3 a{n(rng), n(rng), n(rng)}, e{n(rng), n(rng), n(rng)};
        for (const Vec3& v : {a, a + e, a + 0.4 * e + 1e-9 * Vec3{n(rng), n(rng), n(rng)}})
            needles.vertices.push_back(v);
        needles.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    EXPECT_LE(relative_error(needles, false), 1e-14);
}

TEST(MassProperties, ArePhysicalForEveryShape) {
    for (const NamedMesh& s : test_shapes()) {
        const TriangleMesh m = moved(s.mesh, {0.3, -1.1, 0.7}, {3, 2, 1});
        expect_physical(shell_mass_properties(m, 7, s.name));
        if (s.closed) expect_physical(solid_mass_properties(m, 500, s.name));
        const MassProperties total = spread_mass_properties(m, 12.5, s.name);
        expect_physical(total);
        EXPECT_EQ(total.mass, 12.5);
    }
}

TEST(MassProperties, OfSegmentsAndPointsAreTheirSums) {
    // A bent wire: two arms of 3 and 4 at a right angle, and a triangle without area that weighs nothing.
    const TriangleMesh bent =
        moved({{{3, 0, 0}, {0, 0, 0}, {0, 4, 0}}, {segment_element(0, 1), {1, 2, 2}}}, {0.4, 0.1, -0.7}, {5, 6, 7});
    const MassProperties p = line_mass_properties(bent, 2, "bent");
    EXPECT_NEAR(p.mass, 14, 1e-14);
    expect_physical(p);
    const double x = 1.5 * 3 / 7, y = 2.0 * 4 / 7; // of the centre
    const double about_z = 6 * (9.0 / 12 + (1.5 - x) * (1.5 - x) + y * y) + 8 * (16.0 / 12 + x * x + (2 - y) * (2 - y));
    EXPECT_NEAR(p.principal_inertia.z, about_z, 1e-13 * about_z);
    EXPECT_NEAR(p.principal_inertia.x + p.principal_inertia.y, about_z, 1e-13 * about_z) << "flat";
    EXPECT_EQ(p.line, Vec3{});
    EXPECT_NEAR(spread_mass_properties(bent, 14, "bent").principal_inertia.z, about_z, 1e-13 * about_z);

    const TriangleMesh cloud =
        moved({{{1, 0, 0}, {-1, 0, 0}, {0, 2, 0}, {0, -2, 0}}, {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}},
              {0.4, 0.1, -0.7}, {5, 6, 7});
    const MassProperties q = spread_mass_properties(cloud, 8, "cloud");
    expect_physical(q);
    EXPECT_EQ(q.mass, 8);
    EXPECT_NEAR(length(q.principal_inertia - Vec3{4, 16, 20}), 0, 1e-13);

    const TriangleMesh rod =
        moved({{{0, 0, 0}, {3, 0, 0}, {1, 0, 0}}, {segment_element(0, 2), segment_element(2, 1)}}, {0, 0, 0.5}, {});
    const MassProperties r = line_mass_properties(rod, 2, "rod");
    EXPECT_LT(length(r.principal_inertia - Vec3{0, 4.5, 4.5}), 1e-14);
    EXPECT_NEAR(std::abs(dot(r.line, Vec3{std::cos(0.5), std::sin(0.5), 0})), 1, 1e-15);
}

TEST(MassProperties, DoNotDependOnTheOrderOfTriangles) {
    TriangleMesh m = boat();
    const MassProperties before = shell_mass_properties(m, 10, "boat");
    std::mt19937_64 rng(2);
    std::shuffle(m.triangles.begin(), m.triangles.end(), rng);
    const MassProperties after = shell_mass_properties(m, 10, "boat");
    EXPECT_EQ(before.mass, after.mass);
    EXPECT_EQ(before.center_of_mass, after.center_of_mass);
    EXPECT_NEAR(length(before.principal_inertia - after.principal_inertia), 0, 1e-15 * before.principal_inertia.z);
}

/// One refinement series: mesh(k) with edges halving in k, and the smooth value of one property.
struct Series {
    const char* name;
    std::function<TriangleMesh(int)> mesh;
    bool solid;
    std::function<double(const MassProperties&)> property;
    double smooth;
};

double izz(const MassProperties& p) { return p.inertia.m[8]; }
double ixx(const MassProperties& p) { return p.inertia.m[0]; }
double mass_of(const MassProperties& p) { return p.mass; }

TEST(MassProperties, ConvergeWithOrderTwoToTheSmoothShapes) {
    constexpr double pi = std::numbers::pi, r = 0.7, h = 1.9, big = 1.1, tube = 0.3;
    const auto sphere = [](int k) { return make_sphere(r, k + 1); };
    const auto cylinder = [](int k) { return make_cylinder(r, h, 12 << k); };
    const auto ring = [](int k) { return make_ring(big, tube, 16 << k, 8 << k); };
    const auto disc = [](int k) { return make_disc(r, 12 << k); };
    const double sphere_shell = 4 * pi * r * r, sphere_solid = sphere_shell * r / 3;
    const double side = 2 * pi * r * h, cap = pi * r * r, cylinder_solid = cap * h;
    const double torus_shell = 4 * pi * pi * big * tube, torus_solid = torus_shell * tube / 2;
    const std::array<Series, 13> all{{
        {"sphere shell mass", sphere, false, mass_of, sphere_shell},
        {"sphere shell Izz", sphere, false, izz, sphere_shell * r * r * 2 / 3},
        {"sphere solid mass", sphere, true, mass_of, sphere_solid},
        {"sphere solid Ixx", sphere, true, ixx, sphere_solid * r * r * 2 / 5},
        {"cylinder shell mass", cylinder, false, mass_of, side + 2 * cap},
        {"cylinder shell Izz", cylinder, false, izz, side * r * r + cap * r * r},
        {"cylinder shell Ixx", cylinder, false, ixx, side * (r * r / 2 + h * h / 12) + cap * (r * r + h * h) / 2},
        {"cylinder solid Izz", cylinder, true, izz, cylinder_solid * r * r / 2},
        {"cylinder solid Ixx", cylinder, true, ixx, cylinder_solid * (3 * r * r + h * h) / 12},
        {"ring shell Izz", ring, false, izz, torus_shell * (big * big + 1.5 * tube * tube)},
        {"ring solid mass", ring, true, mass_of, torus_solid},
        {"ring solid Izz", ring, true, izz, torus_solid * (big * big + 0.75 * tube * tube)},
        {"disc Izz", disc, false, izz, cap * r * r / 2},
    }};
    for (const Series& s : all) {
        std::array<double, 4> error;
        for (int k = 0; k < 4; ++k) {
            const TriangleMesh m = s.mesh(k);
            const auto p = s.solid ? solid_mass_properties(m, 1, s.name) : shell_mass_properties(m, 1, s.name);
            error[static_cast<std::size_t>(k)] = std::abs(s.property(p) / s.smooth - 1);
        }
        const double order = std::log2(error[2] / error[3]);
        std::printf("%-20s errors %.2e %.2e %.2e %.2e, order %.3f\n", s.name, error[0], error[1], error[2], error[3],
                    order);
        EXPECT_GE(order, 1.9) << s.name;
        EXPECT_LE(order, 2.1) << s.name;
    }
}

TEST(MassProperties, OfABoxAreTheTextbookOnes) {
    const MassProperties p = solid_mass_properties(make_box(3, 2, 1), 2, "box");
    EXPECT_EQ(p.mass, 12);
    EXPECT_EQ(p.center_of_mass, (Vec3{}));
    EXPECT_NEAR(length(p.principal_inertia - Vec3{5, 10, 13}), 0, 1e-14);
    EXPECT_EQ(p.inertia, (diagonal({5, 10, 13})));
    EXPECT_EQ(p.principal_axes, (Quat{}));
}

TEST(MassProperties, IgnoreZeroAreaTrianglesAndMergeEqualVertices) {
    TriangleMesh soup; // a box whose triangles share no vertex, and a needle without area
    const TriangleMesh box = make_box(1, 2, 3);
    for (const Triangle& t : box.triangles) {
        const auto first = static_cast<std::int32_t>(soup.vertices.size());
        for (std::int32_t v : t) soup.vertices.push_back(box.vertices[static_cast<std::size_t>(v)]);
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    soup.triangles.push_back({0, 1, 1});
    soup.vertices.insert(soup.vertices.end(), {{7, 7, 7}, {8, 8, 8}, {9, 9, 9}});
    soup.triangles.push_back({36, 37, 38});
    const MassProperties p = solid_mass_properties(soup, 1, "soup"), q = solid_mass_properties(box, 1, "box");
    EXPECT_EQ(p.mass, q.mass);
    EXPECT_NEAR(length(p.principal_inertia - q.principal_inertia), 0, 1e-15);
    EXPECT_EQ(shell_mass_properties(soup, 1, "soup").mass, shell_mass_properties(box, 1, "box").mass);
}

TEST(MassProperties, OfASolidDoNotDependOnWhichSideFacesOut) {
    TriangleMesh m = make_cylinder(1, 2, 20);
    const MassProperties outward = solid_mass_properties(m, 3, "cylinder");
    for (Triangle& t : m.triangles) std::swap(t[0], t[1]);
    const MassProperties inward = solid_mass_properties(m, 3, "cylinder");
    EXPECT_EQ(outward.mass, inward.mass);
    EXPECT_EQ(outward.principal_inertia, inward.principal_inertia);
}

TEST(MassProperties, OfAHollowSolidLeaveOutTheCavity) {
    TriangleMesh m = make_box(2, 2, 2);
    const TriangleMesh cavity = make_box(1, 1, 1);
    const auto first = static_cast<std::int32_t>(m.vertices.size());
    m.vertices.insert(m.vertices.end(), cavity.vertices.begin(), cavity.vertices.end());
    for (const Triangle& t : cavity.triangles) m.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    const MassProperties p = solid_mass_properties(m, 1, "hollow");
    EXPECT_EQ(p.mass, 7);
    EXPECT_NEAR(p.inertia.m[0], 8.0 * 8 / 12 - 1.0 * 2 / 12, 1e-14);
}

std::string message_of(const std::function<void()>& f) {
    try {
        f();
    } catch (const InputError& e) {
        return e.what();
    }
    return "(no error)";
}

TEST(MassProperties, RefuseWhatHasNone) {
    const TriangleMesh plate = make_plate(1, 1), box = make_box(1, 1, 1);
    TriangleMesh flipped = box;
    std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
    TriangleMesh line{{{0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {7 * 0.1, 7 * 0.2, 7 * 0.3}},
                      {{0, 1, 2}, {0, 1, 3}}};
    const TriangleMesh point{{{1, 2, 3}}, {{0, 0, 0}}};
    EXPECT_EQ(message_of([&] { (void)spread_mass_properties(point, 1, "s"); }),
              "shape 's': all its points lie at one place: it has no size");
    EXPECT_EQ(message_of([&] { (void)line_mass_properties(plate, 1, "s"); }),
              "shape 's': line_density needs a shape of segments alone, this one has triangles (use surface_density or "
              "mass)");
    EXPECT_EQ(message_of([&] { (void)line_mass_properties(point, 1, "s"); }), "shape 's': its segments have no length");
    TriangleMesh folded = plate;
    for (const Triangle& t : plate.triangles) folded.triangles.push_back({t[0], t[2], t[1]});
    const TriangleMesh hair = make_plate(1, 1e-8);
    TriangleMesh with_hollow_beside = box;
    for (const Vec3& v : box.vertices) with_hollow_beside.vertices.push_back(0.9 * v + Vec3{2, 0, 0});
    for (const Triangle& t : box.triangles) with_hollow_beside.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
    EXPECT_EQ(message_of([&] { (void)solid_mass_properties(with_hollow_beside, 1, "s"); }),
              "shape 's': a part of its surface is inside out: what it encloses counts as less than nothing (turn its "
              "triangles round, so that they face outwards)");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::string one_line =
        "shape 's': all its triangles lie on one line: it has no inertia about that line (give "
        "\"inertia\" and \"center_of_mass\", or make it wider)";
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(point, 1, "s"); }),
              "shape 's': its surface area is zero: all its triangles are degenerate");
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(line, 1, "s"); }), one_line);
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(hair, 1, "s"); }), one_line);
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(plate, 0, "s"); }),
              "shape 's': surface_density must be positive and finite");
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(plate, nan, "s"); }),
              "shape 's': surface_density must be positive and finite");
    EXPECT_EQ(message_of([&] { (void)spread_mass_properties(plate, -1, "s"); }),
              "shape 's': mass must be positive and finite");
    EXPECT_EQ(message_of([&] { (void)solid_mass_properties(box, std::numeric_limits<double>::infinity(), "s"); }),
              "shape 's': density must be positive and finite");
    EXPECT_EQ(message_of([&] { (void)solid_mass_properties(plate, 1, "s"); }),
              "shape 's': a density needs a closed mesh, this one has a boundary, edges of an odd number of triangles "
              "(use surface_density or mass)");
    EXPECT_EQ(message_of([&] { (void)solid_mass_properties(flipped, 1, "s"); }),
              "shape 's': a density needs a consistently oriented mesh, this one has neighbouring triangles that face "
              "opposite sides");
    EXPECT_EQ(message_of([&] { (void)solid_mass_properties(folded, 1, "s"); }), "shape 's': its volume is zero");
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(make_box(1e200, 1, 1), 1, "s"); }),
              "shape 's': mass properties are out of the range of numbers: its size or density is too large");
    EXPECT_EQ(message_of([&] { (void)shell_mass_properties(plate, 5e-324, "s"); }),
              "shape 's': mass properties are out of the range of numbers: its size or density is too small");
}

TEST(MassProperties, ASoupOfExactlyCollinearTrianglesIsRefusedWhateverItsDirection) {
    std::mt19937_64 rng(3);
    std::uniform_real_distribution<double> x(-1, 1);
    for (int i = 0; i < 200; ++i) {
        const Vec3 d{x(rng), x(rng), x(rng)}, o{x(rng), x(rng), x(rng)};
        TriangleMesh m;
        for (int k = 0; k < 12; ++k) m.vertices.push_back(o + x(rng) * d);
        for (std::int32_t t = 0; t < 4; ++t) m.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        EXPECT_THROW((void)shell_mass_properties(m, 1, "line"), InputError);
    }
}

TEST(MassProperties, OverridesReplaceAndAreChecked) {
    const MassProperties base = solid_mass_properties(make_box(1, 1, 1), 6, "box");
    const MassProperties same = with_overrides(base, std::nullopt, std::nullopt, "box");
    EXPECT_EQ(same.inertia, base.inertia);
    const MassProperties given = with_overrides(base, diagonal({3, 1, 2.5}), Vec3{1, 2, 3}, "box");
    EXPECT_EQ(given.mass, 6);
    EXPECT_EQ(given.center_of_mass, (Vec3{1, 2, 3}));
    EXPECT_EQ(given.principal_inertia, (Vec3{1, 2.5, 3}));
    expect_physical(given);
    const MassProperties shifted = with_overrides(base, std::nullopt, Vec3{0, 0, 0.5}, "box");
    EXPECT_NEAR(shifted.inertia.m[0], 1 + 6 * 0.25, 1e-14);
    EXPECT_NEAR(shifted.inertia.m[8], 1, 1e-14);
    const auto error = [&](const Mat3& m) {
        return message_of([&] { (void)with_overrides(base, m, std::nullopt, "s"); });
    };
    EXPECT_EQ(error({{1, 0.1, 0, 0.2, 1, 0, 0, 0, 1}}), "shape 's': inertia must be symmetric");
    EXPECT_EQ(error(diagonal({1, 1, 0})), "shape 's': inertia must be positive definite");
    EXPECT_EQ(error(diagonal({1, 1, -1})), "shape 's': inertia must be positive definite");
    EXPECT_EQ(error({}), "shape 's': inertia must be positive definite");
    EXPECT_EQ(error(diagonal({1, 1, 2.1})),
              "shape 's': inertia is impossible: the largest principal value exceeds the sum of the other two");
    EXPECT_EQ(error(diagonal({1, 1, std::numeric_limits<double>::quiet_NaN()})), "shape 's': inertia must be finite");
    EXPECT_EQ(message_of([&] {
                  (void)with_overrides(base, std::nullopt, Vec3{0, std::numeric_limits<double>::infinity(), 0}, "s");
              }),
              "shape 's': center_of_mass must be finite");
}

TEST(MassProperties, PrincipalAxesOfRandomInertiasAreRight) {
    std::mt19937_64 rng(4);
    std::normal_distribution<double> n;
    std::uniform_real_distribution<double> u(0, 1);
    for (int i = 0; i < 2000; ++i) {
        const double a = std::exp(10 * u(rng)), b = a * (1 + u(rng)),
                     c = i % 5 == 0 ? b : b + (i % 3 == 0 ? 1e-9 : 1) * u(rng) * a;
        const Mat3 r = matrix(normalized(Quat{n(rng), n(rng), n(rng), n(rng)}));
        Mat3 m = r * (diagonal({c, a, b}) * transpose(r));
        m = 0.5 * (m + transpose(m));
        const MassProperties p = given_mass_properties(1, {}, m, "random");
        expect_physical(p);
        EXPECT_NEAR(p.principal_inertia.x, a, 1e-14 * c);
        EXPECT_NEAR(p.principal_inertia.y, b, 1e-14 * c);
        EXPECT_NEAR(p.principal_inertia.z, c, 1e-14 * c);
    }
}

} // namespace
} // namespace flotilla
