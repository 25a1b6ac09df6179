// SPDX-License-Identifier: MIT
#include "mesh/mass_properties.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <flotilla/error.hpp>

#include "base/rotation.hpp"
#include "mesh/dd_vec.hpp"
#include "mesh/topology.hpp"

namespace flotilla {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
    throw InputError("shape '" + name + "': " + reason);
}

void require_positive(double value, const char* quantity, const std::string& name) {
    if (!(value > 0) || !std::isfinite(value)) refuse(name, std::string(quantity) + " must be positive and finite");
}

/// Integrals of 1, x and x x^T over the surface or the volume, x taken from `reference`.
struct Moments {
    Vec3 reference;
    DoubleDouble zeroth;
    DdVec3 first{};
    DdMat3 second{};
};

/// Adds weight (a a^T + b b^T + c c^T + s s^T).
void add_corner_products(DdMat3& second, const DoubleDouble& weight, const DdVec3& a, const DdVec3& b, const DdVec3& c,
                         const DdVec3& s) {
    add_outer(second, weight, a);
    add_outer(second, weight, b);
    add_outer(second, weight, c);
    add_outer(second, weight, s);
}

/// Sums what `add` contributes for each triangle with area, then divides by the constants of the closed forms: once at
/// the end, so that the sums of simple shapes stay free of rounding.
template <class Add>
Moments integrate(const TriangleMesh& mesh, const std::array<double, 3>& divisors, Add&& add) {
    Moments m;
    m.reference = center(bounding_box(mesh));
    for (const Triangle& t : mesh.triangles) add(m, t);
    m.zeroth = m.zeroth / DoubleDouble(divisors[0]);
    for (DoubleDouble& x : m.first) x = x / DoubleDouble(divisors[1]);
    for (DdVec3& row : m.second)
        for (DoubleDouble& x : row) x = x / DoubleDouble(divisors[2]);
    return m;
}

const Vec3& vertex(const TriangleMesh& mesh, std::int32_t i) { return mesh.vertices[static_cast<std::size_t>(i)]; }

template <class Add>
Moments integrate_triangles(const TriangleMesh& mesh, const std::array<double, 3>& divisors, Add&& add) {
    return integrate(mesh, divisors, [&](Moments& m, const Triangle& t) {
        const Vec3 &a = vertex(mesh, t[0]), &b = vertex(mesh, t[1]), &c = vertex(mesh, t[2]);
        if (!is_zero_area(a, b, c)) add(m, a, b, c);
    });
}

/// Weighted by twice the area.
Moments surface_moments(const TriangleMesh& mesh) {
    return integrate_triangles(mesh, {2, 6, 24}, [](Moments& m, const Vec3& va, const Vec3& vb, const Vec3& vc) {
        const DdVec3 n = doubled_area_vector(va, vb, vc);
        const DoubleDouble weight = sqrt(dot(n, n));
        const DdVec3 a = exact_difference(va, m.reference), b = exact_difference(vb, m.reference),
                     c = exact_difference(vc, m.reference), s = a + b + c;
        m.zeroth += weight;
        m.first += weight * s;
        add_corner_products(m.second, weight, a, b, c, s);
    });
}

/// Weighted by the length.
Moments segment_moments(const TriangleMesh& mesh) {
    return integrate(mesh, {1, 2, 6}, [&](Moments& m, const Triangle& t) {
        if (element_of(t) != ElementKind::segment) return;
        const auto [i, k] = segment_ends(t);
        const DdVec3 d = exact_difference(vertex(mesh, k), vertex(mesh, i));
        const DoubleDouble weight = sqrt(dot(d, d));
        const DdVec3 a = exact_difference(vertex(mesh, i), m.reference),
                     b = exact_difference(vertex(mesh, k), m.reference), s = a + b;
        m.zeroth += weight;
        m.first += weight * s;
        for (const DdVec3& x : {a, b, s}) add_outer(m.second, weight, x);
    });
}

/// Each weighs the same.
Moments point_moments(const TriangleMesh& mesh) {
    return integrate(mesh, {1, 1, 1}, [&](Moments& m, const Triangle& t) {
        if (element_of(t) != ElementKind::point) return;
        const DdVec3 a = exact_difference(vertex(mesh, t[0]), m.reference);
        m.zeroth += DoubleDouble(1);
        m.first += a;
        add_outer(m.second, 1, a);
    });
}

/// Weighted by the determinant, six times the volume.
Moments volume_moments(const TriangleMesh& mesh) {
    return integrate_triangles(mesh, {6, 24, 120}, [](Moments& m, const Vec3& va, const Vec3& vb, const Vec3& vc) {
        const DdVec3 a = exact_difference(va, m.reference), b = exact_difference(vb, m.reference),
                     c = exact_difference(vc, m.reference), s = a + b + c;
        const DoubleDouble weight = dot(a, cross(b, c));
        m.zeroth += weight;
        m.first += weight * s;
        add_corner_products(m.second, weight, a, b, c, s);
    });
}

DdMat3 to_dd(const Mat3& a) {
    DdMat3 d;
    for (std::size_t i = 0; i < 9; ++i) d[i / 3][i % 3] = a.m[i];
    return d;
}

/// One Jacobi rotation: makes a[p][q] zero and applies the rotation to the columns of v. Entries below the accuracy of
/// the matrix are left: theta would overflow, and they move no eigenvalue's leading double.
void rotate_away(DdMat3& a, DdMat3& v, std::size_t p, std::size_t q) {
    if (std::abs(a[p][q].hi) <= 0x1p-106 * (std::abs(a[p][p].hi) + std::abs(a[q][q].hi))) return;
    const DoubleDouble theta = (a[q][q] - a[p][p]) / (DoubleDouble(2) * a[p][q]);
    const DoubleDouble root = sqrt(theta * theta + DoubleDouble(1));
    const DoubleDouble t = DoubleDouble(theta.hi < 0 ? -1 : 1) / (abs(theta) + root);
    const DoubleDouble c = DoubleDouble(1) / sqrt(t * t + DoubleDouble(1)), s = t * c;
    const DoubleDouble apq = a[p][q];
    a[p][p] -= t * apq;
    a[q][q] += t * apq;
    a[p][q] = a[q][p] = 0;
    const std::size_t r = 3 - p - q;
    const DoubleDouble arp = a[r][p], arq = a[r][q];
    a[r][p] = a[p][r] = c * arp - s * arq;
    a[r][q] = a[q][r] = s * arp + c * arq;
    for (DdVec3& row : v) {
        const DoubleDouble vp = row[p], vq = row[q];
        row[p] = c * vp - s * vq;
        row[q] = s * vp + c * vq;
    }
}

struct PrincipalInertia {
    std::array<DoubleDouble, 3> values; ///< ascending
    DdMat3 vectors;                     ///< columns, right-handed
};

/// Cyclic Jacobi in a fixed order. In double-double, so that small values are right relative to themselves after
/// rounding, which Eigen's solver for double would not give, and of our own, so that the axes have the same bits with
/// every compiler. Convergence is quadratic: below ten sweeps; the bound is for input with NaN.
PrincipalInertia principal_inertia(DdMat3 a) {
    constexpr int kMaxSweeps = 40;
    DdMat3 v{};
    for (std::size_t i = 0; i < 3; ++i) v[i][i] = 1;
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        const double off = std::abs(a[0][1].hi) + std::abs(a[0][2].hi) + std::abs(a[1][2].hi);
        const double trace = std::abs(a[0][0].hi) + std::abs(a[1][1].hi) + std::abs(a[2][2].hi);
        if (off <= 0x1p-104 * trace) break;
        rotate_away(a, v, 0, 1);
        rotate_away(a, v, 0, 2);
        rotate_away(a, v, 1, 2);
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a[i][i] < a[j][j]; });
    PrincipalInertia e;
    for (std::size_t k = 0; k < 3; ++k) {
        e.values[k] = a[order[k]][order[k]];
        for (std::size_t i = 0; i < 3; ++i) e.vectors[i][k] = v[i][order[k]];
    }
    // A permutation or Jacobi's rotations may leave a left-handed frame: then the last axis turns round.
    const DdVec3 x{e.vectors[0][0], e.vectors[1][0], e.vectors[2][0]},
        y{e.vectors[0][1], e.vectors[1][1], e.vectors[2][1]}, z{e.vectors[0][2], e.vectors[1][2], e.vectors[2][2]};
    if (dot(cross(x, y), z).hi < 0)
        for (DdVec3& row : e.vectors) row[2] = -row[2];
    return e;
}

Mat3 rounded(const DdMat3& a) {
    Mat3 r;
    for (std::size_t i = 0; i < 9; ++i) r.m[i] = to_double(a[i / 3][i % 3]);
    return r;
}

/// Rounds to double, finds the principal axes and checks that the result is one a body can have.
MassProperties finish(const DoubleDouble& mass, const DdVec3& com, const DdMat3& inertia, const std::string& name,
                      bool of_elements = false) {
    MassProperties p;
    p.mass = to_double(mass);
    p.center_of_mass = to_double(com);
    p.inertia = rounded(inertia);
    const PrincipalInertia e = principal_inertia(inertia);
    p.principal_inertia = to_double(DdVec3(e.values));
    p.principal_axes = normalized(quaternion(rounded(e.vectors)));
    const bool finite = std::isfinite(p.mass) && is_finite(p.center_of_mass) && is_finite(p.principal_inertia) &&
                        std::all_of(p.inertia.m.begin(), p.inertia.m.end(), [](double x) { return std::isfinite(x); });
    if (!finite) refuse(name, "mass properties are out of the range of numbers: its size or density is too large");
    if (of_elements && p.mass > 0 && p.principal_inertia.z == 0)
        refuse(name, "all its points lie at one place: it has no size");
    if (!(p.mass > 0) || !(p.principal_inertia.z > 0))
        refuse(name, "mass properties are out of the range of numbers: its size or density is too small");
    if (p.principal_inertia.x > kMinInertiaRatio * p.principal_inertia.z) return p;
    if (p.principal_inertia.x < -kMinInertiaRatio * p.principal_inertia.z)
        refuse(name, "a part of its surface is inside out: what it encloses counts as less than nothing (turn its "
                     "triangles round, so that they face outwards)");
    if (!of_elements)
        refuse(name, "all its triangles lie on one line: it has no inertia about that line (give \"inertia\" and "
                     "\"center_of_mass\", or make it wider)");
    p.line = rotate(p.principal_axes, {1, 0, 0});
    p.principal_inertia.x = 0;
    return p;
}

/// Makes off-diagonal entries zero that are below what the sums can know, so that a symmetric shape has the axes one
/// expects and not those of its rounding.
void drop_noise(DdMat3& inertia) {
    const double trace = inertia[0][0].hi + inertia[1][1].hi + inertia[2][2].hi;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (i != j && std::abs(inertia[i][j].hi) < 0x1p-96 * trace) inertia[i][j] = 0;
}

/// Inertia from integrals: density times (trace(C) 1 - C) with C the second moments about the centre of mass. The
/// diagonal is a sum of two non-negative second moments, so no cancellation makes it negative.
MassProperties from_moments(const Moments& m, const DoubleDouble& density, const std::string& name,
                            bool of_elements = false) {
    const DdVec3 shift = (DoubleDouble(1) / m.zeroth) * m.first;
    DdMat3 c = m.second;
    add_outer(c, -m.zeroth, shift);
    DdMat3 inertia{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            inertia[i][j] = density * (i == j ? c[(i + 1) % 3][(i + 1) % 3] + c[(i + 2) % 3][(i + 2) % 3] : -c[i][j]);
    drop_noise(inertia);
    const DdVec3 com = shift + DdVec3{m.reference.x, m.reference.y, m.reference.z};
    return finish(density * m.zeroth, com, inertia, name, of_elements);
}

/// Of segments or points, which may lie on a line.
MassProperties of_elements(const Moments& m, double mass, const std::string& name) {
    MassProperties p = from_moments(m, DoubleDouble(mass) / m.zeroth, name, true);
    p.mass = mass;
    return p;
}

Moments checked_surface_moments(const TriangleMesh& mesh, const std::string& name) {
    Moments m = surface_moments(mesh);
    if (!std::isfinite(m.zeroth.hi)) refuse(name, "its surface area is out of the range of numbers");
    if (!(m.zeroth.hi > 0)) refuse(name, "its surface area is zero: all its triangles are degenerate");
    return m;
}

/// The largest deviation from symmetry that is taken for rounding, relative to the largest entry: values typed with ten
/// digits pass, a transposition error does not.
constexpr double kSymmetryTolerance = 1e-9;
/// Allowed excess of the largest principal inertia over the sum of the others, relative: values typed with seven digits
/// for a flat body (where the two are equal) pass.
constexpr double kTriangleInequalityTolerance = 1e-6;

void require_symmetric(const Mat3& a, const std::string& name) {
    double largest = 0;
    for (double x : a.m) {
        if (!std::isfinite(x)) refuse(name, "inertia must be finite");
        largest = std::max(largest, std::abs(x));
    }
    const auto asymmetry = std::max({std::abs(a.m[1] - a.m[3]), std::abs(a.m[2] - a.m[6]), std::abs(a.m[5] - a.m[7])});
    if (asymmetry > kSymmetryTolerance * largest) refuse(name, "inertia must be symmetric");
}

} // namespace

MassProperties shell_mass_properties(const TriangleMesh& mesh, double surface_density, const std::string& name) {
    require_positive(surface_density, "surface_density", name);
    return from_moments(checked_surface_moments(mesh, name), surface_density, name);
}

MassProperties line_mass_properties(const TriangleMesh& mesh, double line_density, const std::string& name) {
    require_positive(line_density, "line_density", name);
    if (highest_element(mesh.triangles) == ElementKind::triangle)
        refuse(name,
               "line_density needs a shape of segments alone, this one has triangles (use surface_density or mass)");
    const Moments m = segment_moments(mesh);
    if (!(m.zeroth.hi > 0)) refuse(name, "its segments have no length");
    return from_moments(m, line_density, name, true);
}

MassProperties spread_mass_properties(const TriangleMesh& mesh, double mass, const std::string& name) {
    require_positive(mass, "mass", name);
    if (highest_element(mesh.triangles) != ElementKind::triangle) {
        if (const Moments m = segment_moments(mesh); m.zeroth.hi > 0) return of_elements(m, mass, name);
        if (const Moments m = point_moments(mesh); m.zeroth.hi > 0) return of_elements(m, mass, name);
    }
    const Moments m = checked_surface_moments(mesh, name);
    MassProperties p = from_moments(m, DoubleDouble(mass) / m.zeroth, name);
    p.mass = mass;
    return p;
}

MassProperties solid_mass_properties(const TriangleMesh& mesh, double density, const std::string& name) {
    require_positive(density, "density", name);
    const Closedness c = closedness(mesh);
    if (!c.closed)
        refuse(name, "a density needs a closed mesh, this one has a boundary, edges of an odd number of triangles (use "
                     "surface_density or mass)");
    if (!c.oriented)
        refuse(name, "a density needs a consistently oriented mesh, this one has neighbouring triangles that "
                     "face opposite sides");
    const Moments m = volume_moments(mesh);
    // A volume this far below that of the bounding box is what remains of exact cancellation, as in a plate folded onto
    // itself.
    const Vec3 e = extent(bounding_box(mesh));
    if (!(std::abs(m.zeroth.hi) > 1e-24 * ((e.x * e.y) * e.z))) refuse(name, "its volume is zero");
    return from_moments(m, m.zeroth.hi < 0 ? DoubleDouble(-density) : DoubleDouble(density), name);
}

MassProperties given_mass_properties(double mass, const Vec3& center_of_mass, const Mat3& inertia,
                                     const std::string& name) {
    require_positive(mass, "mass", name);
    if (!is_finite(center_of_mass)) refuse(name, "center_of_mass must be finite");
    require_symmetric(inertia, name);
    const Mat3 symmetric = 0.5 * (inertia + transpose(inertia));
    const DdVec3 values = principal_inertia(to_dd(symmetric)).values;
    if (!(values[0].hi > kMinInertiaRatio * values[2].hi)) refuse(name, "inertia must be positive definite");
    if (values[2].hi > (1 + kTriangleInequalityTolerance) * (values[0].hi + values[1].hi))
        refuse(name, "inertia is impossible: the largest principal value exceeds the sum of the other two");
    return finish(mass, {center_of_mass.x, center_of_mass.y, center_of_mass.z}, to_dd(symmetric), name);
}

MassProperties with_overrides(const MassProperties& base, const std::optional<Mat3>& inertia,
                              const std::optional<Vec3>& center_of_mass, const std::string& name) {
    const Vec3 com = center_of_mass.value_or(base.center_of_mass);
    if (inertia) return given_mass_properties(base.mass, com, *inertia, name);
    if (!center_of_mass) return base;
    const Vec3 d = com - base.center_of_mass;
    const Mat3 steiner{{d.y * d.y + d.z * d.z, -d.x * d.y, -d.x * d.z, //
                        -d.x * d.y, d.x * d.x + d.z * d.z, -d.y * d.z, //
                        -d.x * d.z, -d.y * d.z, d.x * d.x + d.y * d.y}};
    return given_mass_properties(base.mass, com, base.inertia + base.mass * steiner, name);
}

} // namespace flotilla
