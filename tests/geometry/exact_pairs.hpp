// SPDX-License-Identifier: MIT
// Random pairs of triangles, class by class: each class aims at one way in which an intersection test goes wrong.
// The generators use raw bits of mt19937_64 only, and never draw twice in one unsequenced expression, so that every
// machine and compiler tests the same pairs. Draws on both sides of an assignment are avoided too: C++17 orders them,
// but g++ 12 evaluates them the other way round under -fsanitize=undefined.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

#include "base/vec3.hpp"

namespace flotilla::test {

using Corners = std::array<Vec3, 3>;

struct TrianglePair {
    Corners a, b;
};

class Random {
  public:
    explicit Random(std::uint64_t seed) : bits_(seed) {}
    /// 0 .. n-1
    int below(int n) { return static_cast<int>(bits_() % static_cast<std::uint64_t>(n)); }
    /// The index of a corner.
    std::size_t corner() { return static_cast<std::size_t>(below(3)); }
    /// [-1, 1)
    double real() { return static_cast<double>(static_cast<std::int64_t>(bits_()) >> 11) * 0x1p-52; }
    Vec3 point() {
        const double x = real(), y = real();
        return {x, y, real()};
    }
    /// Integer coordinates -n .. n.
    Vec3 lattice(int n) {
        const int x = below(2 * n + 1) - n, y = below(2 * n + 1) - n;
        return {double(x), double(y), double(below(2 * n + 1) - n)};
    }

  private:
    std::mt19937_64 bits_;
};

template <class Point>
Corners corners(Point&& point) {
    const Vec3 p = point(), q = point();
    return {p, q, point()};
}

template <class Function>
TrianglePair map_corners(TrianglePair t, Function&& f) {
    for (Vec3& p : t.a) p = f(p);
    for (Vec3& p : t.b) p = f(p);
    return t;
}

inline TrianglePair random_pair(Random& r) {
    const auto point = [&] { return r.point(); };
    const Corners a = corners(point);
    return {a, corners(point)};
}

/// Coordinates in a small integer grid hit every coincidence: coplanar, collinear, shared corners, equal triangles,
/// points.
template <int n>
TrianglePair lattice_pair(Random& r) {
    const auto point = [&] { return r.lattice(n); };
    const Corners a = corners(point);
    return {a, corners(point)};
}

/// Both triangles in one lattice plane in general direction; integer combinations are exact in doubles.
inline TrianglePair coplanar_pair(Random& r) {
    const Vec3 o = r.lattice(50), u = r.lattice(20), v = r.lattice(20);
    const auto point = [&] {
        const int i = r.below(13) - 6, j = r.below(13) - 6;
        return o + double(i) * u + double(j) * v;
    };
    const Corners a = corners(point);
    return {a, corners(point)};
}

/// A needle along pq, a millionth to a trillionth as wide as long.
inline Corners sliver(Random& r, const Vec3& p, const Vec3& q) {
    const double width = std::ldexp(1.0, -20 - r.below(20));
    const double share = 0.5 * (r.real() + 1);
    return {p, q, p + share * (q - p) + width * r.point()};
}

/// Two needles, half of them laid across each other to within rounding, or a needle and a triangle.
inline TrianglePair sliver_pair(Random& r) {
    const Vec3 p = r.point(), q = r.point(), s = r.point();
    const Corners a = sliver(r, p, q);
    const int kind = r.below(4);
    if (kind == 0) return {a, sliver(r, s, r.point())};
    if (kind == 1) return {a, corners([&] { return r.point(); })};
    return {a, sliver(r, s, p + (q - p) * 0.5 + ((p - s) + (q - s)) * 0.5)};
}

/// A segment or a point given as a triangle, all on a lattice line.
inline Corners degenerate_corners(Random& r) {
    const Vec3 o = r.lattice(2), u = r.lattice(1);
    return corners([&] { return o + double(r.below(5) - 2) * u; });
}
inline TrianglePair degenerate_pair(Random& r) {
    const Corners a = degenerate_corners(r);
    const Corners b = r.below(2) == 0 ? degenerate_corners(r) : corners([&] { return r.lattice(2); });
    return r.below(2) == 0 ? TrianglePair{a, b} : TrianglePair{b, a};
}

/// One corner or one edge in common by position; half of them with that corner moved off along a lattice direction.
inline TrianglePair shared_pair(Random& r) {
    TrianglePair t{corners([&] { return r.point(); }), corners([&] { return r.point(); })};
    const Vec3 shared = t.a[r.corner()];
    t.b[r.corner()] = shared;
    if (r.below(2) == 0) t.b[0] = t.a[r.corner()];
    if (r.below(2) == 0) {
        for (Vec3& p : t.b) {
            const double step = std::ldexp(1.0, -10 - r.below(40));
            p = p + step * r.lattice(1);
        }
    }
    return t;
}

/// A corner of b lies exactly in the plane, on an edge or on a corner of a, or, half the time, one lattice step beside
/// that place.
inline TrianglePair touching_pair(Random& r) {
    const Corners a = corners([&] { return 8.0 * r.lattice(6); });
    const int i = r.below(9), j = r.below(9 - i);
    Vec3 p = 0.125 * (double(i) * a[0] + double(j) * a[1] + double(8 - i - j) * a[2]);
    if (r.below(2) == 0) p = p + r.lattice(1);
    Corners b = corners([&] { return 8.0 * r.lattice(6); });
    b[r.corner()] = p;
    return {a, b};
}

inline double next_to(double x, Random& r) {
    const double infinity = std::numeric_limits<double>::infinity();
    const int way = r.below(5);
    return way == 0 ? std::nextafter(x, infinity) : way == 1 ? std::nextafter(x, -infinity) : x;
}

/// A touching, coplanar or lattice pair scaled and moved so that its coordinates fill the mantissa, then moved by
/// neighbouring doubles.
inline TrianglePair ulp_pair(Random& r) {
    const int kind = r.below(3);
    const TrianglePair t = kind == 0 ? touching_pair(r) : kind == 1 ? coplanar_pair(r) : lattice_pair<2>(r);
    const double scale = 1.0 + 0.25 * r.below(3);
    return map_corners(t, [&](const Vec3& p) {
        const double x = next_to(scale * p.x + 300, r), y = next_to(scale * p.y, r);
        return Vec3{x, y, next_to(scale * p.z - 1, r)};
    });
}

/// A metre-sized pair a thousand kilometres from the origin, where the coordinates are 1e-10 m apart.
inline TrianglePair far_pair(Random& r) {
    const Vec3 o = 1e6 * r.point();
    const int kind = r.below(3);
    const TrianglePair t = kind == 0 ? random_pair(r) : kind == 1 ? touching_pair(r) : lattice_pair<1>(r);
    const double scale = kind == 1 ? 0x1p-6 : 1;
    return map_corners(t, [&](const Vec3& p) { return o + scale * p; });
}

/// Any of the above near the ends of the double range, or a mixture of exponents within one pair.
inline TrianglePair extreme_pair(Random& r) {
    const int kind = r.below(3);
    const TrianglePair t = kind == 0 ? touching_pair(r) : kind == 1 ? lattice_pair<1>(r) : random_pair(r);
    const std::array<int, 6> exponents{1000, 345, -297, -352, -600, -1050};
    const int e = exponents[static_cast<std::size_t>(r.below(6))];
    const bool mixed = r.below(4) == 0;
    return map_corners(t, [&](const Vec3& p) {
        const int shift = mixed ? r.below(200) : 0;
        return Vec3{std::ldexp(p.x, e), std::ldexp(p.y, e - shift), std::ldexp(p.z, e)};
    });
}

struct PairClass {
    const char* name;
    TrianglePair (*make)(Random&);
    double rarer_answer; ///< at least this fraction of the pairs gives each answer
};

inline constexpr std::array kPairClasses{
    PairClass{"random", random_pair, 0.1},
    PairClass{"lattice_1", lattice_pair<1>, 0.1},
    PairClass{"lattice_2", lattice_pair<2>, 0.1},
    PairClass{"lattice_5", lattice_pair<5>, 0.1},
    PairClass{"coplanar", coplanar_pair, 0.1},
    PairClass{"sliver", sliver_pair, 0.1},
    PairClass{"degenerate", degenerate_pair, 0.01},
    PairClass{"shared", shared_pair, 0.1},
    PairClass{"touching", touching_pair, 0.1},
    PairClass{"ulp", ulp_pair, 0.1},
    PairClass{"far", far_pair, 0.1},
    PairClass{"extreme", extreme_pair, 0.1},
};

} // namespace flotilla::test
