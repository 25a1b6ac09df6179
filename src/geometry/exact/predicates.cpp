// SPDX-License-Identifier: MIT
// The exact stages of orient2d and orient3d.
//
// Range of the sums of doubles. Let every coordinate be 0 or of magnitude in [2^-300, 2^336] (5e-91 .. 1.4e101).
// Then every coordinate is a multiple of 2^-352, every partial product of a determinant a multiple of 2^-1056, above
// the least double 2^-1074: nothing underflows. Differences are at most 2^337, minors 2^675, terms of the determinant
// 2^1012, the sum of the magnitudes of all parts below 2^1016; Dekker's splitting multiplies a factor (at most 2^676)
// by 2^27: nothing overflows. Outside that range the integers take over.
#include "geometry/exact/predicates.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>

#include "base/assert.hpp"
#include "geometry/exact/wide_integer.hpp"

namespace flotilla::exact {
namespace {

constexpr double kSumsMin = 0x1p-300, kSumsMax = 0x1p336;

/// high = fl(exact value), high + low = exact value.
struct Pair {
    double high, low;
};

/// x + y exactly, barring overflow (Knuth 1969). Sums of doubles never underflow.
Pair two_sum(double x, double y) {
    const double s = x + y;
    const double y_part = s - x;
    const double x_part = s - y_part;
    return {s, (x - x_part) + (y - y_part)};
}

/// x as the sum of two numbers of at most 26 bits each, barring overflow (Veltkamp 1968, Dekker 1971).
Pair split(double x) {
    const double t = 0x1.0000002p27 * x; // 2^27 + 1
    const double high = t - (t - x);
    return {high, x - high};
}

/// x * y exactly, barring overflow and underflow (Dekker 1971). No fused multiply-add: the machine need not have one.
Pair two_product(double x, double y) {
    const double p = x * y;
    const Pair a = split(x), b = split(y);
    const double rest = ((p - a.high * b.high) - a.low * b.high) - a.high * b.low;
    return {p, a.low * b.low - rest};
}

/// A real number as the sum of at most N doubles.
///
/// Invariant: no component is zero, and for each component h there is a power of two 2^t > |h| of which all later
/// components are multiples. Hence (induction from the first) the components before h sum to less than |h| in
/// magnitude, and the sign of the number is the sign of the last component.
///
/// add() keeps it (Shewchuk's theorem 10; the argument here is our own). It replaces (q, e_i) by (q', h_i) with
/// q' + h_i = q + e_i, q' = fl(q + e_i). Since q is itself a double, rounding to nearest gives |h_i| <= |e_i|, which is
/// below a power of two dividing all later e; and |h_i| <= ulp(q')/2 with q' a multiple of ulp(q'). So |h_i| is below
/// the smaller of those two powers of two, which divides everything that later h and the last q are computed from, and
/// a sum of multiples of 2^t and its rounding error are again multiples of 2^t. Dropping zeros changes nothing.
template <std::size_t N>
class Expansion {
  public:
    void add(double x) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            const Pair s = two_sum(x, component_[i]);
            x = s.high;
            if (s.low != 0) component_[kept++] = s.low; // kept <= i: overwrites only what has been read
        }
        if (x != 0) {
            FLOTILLA_ASSERT(kept < N);
            component_[kept++] = x;
        }
        size_ = kept;
    }

    /// Adds sign * x * y. Grows by at most 2 * x.size() * y.size() components.
    template <std::size_t P, std::size_t Q>
    void add_product(double sign, const Expansion<P>& x, const Expansion<Q>& y) {
        for (const double a : x)
            for (const double b : y) {
                const Pair p = two_product(sign * a, b);
                add(p.low);
                add(p.high);
            }
    }

    [[nodiscard]] const double* begin() const { return component_.data(); }
    [[nodiscard]] const double* end() const { return component_.data() + size_; }
    [[nodiscard]] int sign() const {
        if (size_ == 0) return 0;
        return component_[size_ - 1] > 0 ? 1 : -1;
    }

  private:
    std::size_t size_ = 0;
    std::array<double, N> component_; // uninitialised beyond size_: clearing 192 doubles would cost more than the sums
};

Expansion<2> difference(double x, double y) {
    Expansion<2> e;
    e.add(x);
    e.add(-y);
    return e;
}

int orient2d_sums(const Point2& a, const Point2& b, const Point2& c) {
    Expansion<16> determinant; // 2 products of 2 x 2 components, 2 doubles each
    determinant.add_product(1, difference(b.x, a.x), difference(c.y, a.y));
    determinant.add_product(-1, difference(b.y, a.y), difference(c.x, a.x));
    return determinant.sign();
}

int orient3d_sums(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto from_a = [&a](const Vec3& p) {
        return std::array{difference(p.x, a.x), difference(p.y, a.y), difference(p.z, a.z)};
    };
    const auto u = from_a(b), v = from_a(c), w = from_a(d);
    Expansion<192> determinant; // 3 products of 16 x 2 components, 2 doubles each
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        Expansion<16> minor;
        minor.add_product(1, u[i], v[j]);
        minor.add_product(-1, u[j], v[i]);
        determinant.add_product(1, minor, w[k]);
    }
    return determinant.sign();
}

/// The common unit 2^exponent of some coordinates, and the width that holds any determinant of their differences:
/// coordinates below 2^span units give differences below 2^(span + 1), products of three below 2^(3 span + 3), six of
/// them below 2^(3 span + 6), and a sign bit.
class Scale {
  public:
    explicit Scale(std::initializer_list<double> coordinates) {
        int low = 1024, high = -1074;
        for (const double x : coordinates) {
            if (x == 0) continue;
            const int unit = WideInteger::unit_exponent(x);
            low = std::min(low, unit);
            high = std::max(high, unit + 53);
        }
        exponent_ = std::min(low, high);
        limbs_ = static_cast<std::size_t>(3 * (high - exponent_) + 8 + 31) / 32 + 2; // 2 limbs for WideInteger::place
    }

    [[nodiscard]] WideInteger difference(double x, double y) const {
        return WideInteger(x, exponent_, limbs_) - WideInteger(y, exponent_, limbs_);
    }

  private:
    int exponent_;
    std::size_t limbs_;
};

int orient2d_integers(const Point2& a, const Point2& b, const Point2& c) {
    const Scale s({a.x, a.y, b.x, b.y, c.x, c.y});
    return (s.difference(b.x, a.x) * s.difference(c.y, a.y) - s.difference(b.y, a.y) * s.difference(c.x, a.x)).sign();
}

int orient3d_integers(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Scale s({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z});
    const WideInteger ux = s.difference(b.x, a.x), uy = s.difference(b.y, a.y), uz = s.difference(b.z, a.z);
    const WideInteger vx = s.difference(c.x, a.x), vy = s.difference(c.y, a.y), vz = s.difference(c.z, a.z);
    const WideInteger nx = uy * vz - uz * vy, minus_ny = ux * vz - uz * vx, minus_nz = uy * vx - ux * vy;
    const WideInteger x_term = nx * s.difference(d.x, a.x);
    return (x_term - minus_ny * s.difference(d.y, a.y) - minus_nz * s.difference(d.z, a.z)).sign();
}

bool sums_are_exact(double x) {
    const double size = std::abs(x);
    return size == 0 || (size >= kSumsMin && size <= kSumsMax);
}
bool sums_are_exact(const Point2& p) { return sums_are_exact(p.x) && sums_are_exact(p.y); }
bool sums_are_exact(const Vec3& p) { return sums_are_exact(p.x) && sums_are_exact(p.y) && sums_are_exact(p.z); }

} // namespace

int orient2d_exact(const Point2& a, const Point2& b, const Point2& c) {
    const bool sums = sums_are_exact(a) && sums_are_exact(b) && sums_are_exact(c);
    return sums ? orient2d_sums(a, b, c) : orient2d_integers(a, b, c);
}

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    FLOTILLA_ASSERT(is_finite(a) && is_finite(b) && is_finite(c) && is_finite(d));
    const bool sums = sums_are_exact(a) && sums_are_exact(b) && sums_are_exact(c) && sums_are_exact(d);
    return sums ? orient3d_sums(a, b, c, d) : orient3d_integers(a, b, c, d);
}

/// Filter as in OrientedPlane: 4 roundings per product (two differences, product, sum), hence 5u; two products that may
/// underflow by 2^-1075 each, hence the second term.
int orient2d(const Point2& a, const Point2& b, const Point2& c) {
    const double left = (b.x - a.x) * (c.y - a.y);
    const double right = (b.y - a.y) * (c.x - a.x);
    const double determinant = left - right;
    const double bound = 5 * 0x1p-53 * (std::abs(left) + std::abs(right)) + 0x1p-1060;
    if (determinant > bound) return 1;
    if (determinant < -bound) return -1;
    return orient2d_exact(a, b, c);
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return OrientedPlane(a, b, c).side(d); }

} // namespace flotilla::exact
