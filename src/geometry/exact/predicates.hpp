// SPDX-License-Identifier: MIT
// Exact signs of the two determinants that everything in geometry/exact is decided by.
//
// Guarantee: for ALL finite doubles, subnormal and huge ones included, the returned sign is the sign of the determinant
// of the given coordinates in real arithmetic. There is no tolerance and no excluded range. Preconditions: finite
// coordinates, rounding to nearest (the default of every thread).
//
// Method: the determinant in plain doubles with a bound on its rounding error (filter); where the bound cannot tell the
// sign, the determinant as an exact sum of doubles (predicates.cpp); for coordinates so large or small that a partial
// product could overflow or underflow, integers of up to 6400 bits (wide_integer.hpp).
// Reference: Shewchuk, Adaptive precision floating-point arithmetic and fast robust geometric predicates, 1997.
#pragma once

#include <cmath>

#include "base/vec3.hpp"

namespace flotilla::exact {

struct Point2 {
    double x = 0, y = 0;
};

/// Sign (-1, 0, +1) of (b - a) x (c - a): +1 where a, b, c turn counter-clockwise, 0 where they are collinear.
[[nodiscard]] int orient2d(const Point2& a, const Point2& b, const Point2& c);

/// Sign (-1, 0, +1) of ((b - a) x (c - a)) . (d - a): +1 where d lies on the side that the counter-clockwise normal of
/// (a, b, c) points to, 0 where the four points are coplanar.
[[nodiscard]] int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// orient2d and orient3d without their filters: the exact stage alone (used where a filter gave up, and by tests).
[[nodiscard]] int orient2d_exact(const Point2& a, const Point2& b, const Point2& c);
[[nodiscard]] int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// orient3d for several points against one plane: side(d) = orient3d(a, b, c, d), the part of the filter that depends
/// on a, b, c computed once. The three points may be collinear; then side() is 0 everywhere.
///
/// Error bound of the filter, u = 2^-53. Write P for the sum of the absolute values of the six products of exact
/// differences. Each product meets at most 8 roundings (three differences, product, minor, product with w, two sums),
/// so |det - exact| <= ((1 + u)^8 - 1) P; the computed permanent is a sum of the same products without cancellation, so
/// P <= permanent / (1 - u)^8. Together less than 8u (1 + 20u) permanent, and 9u leaves room for the two roundings of
/// the bound itself. (Shewchuk's finer count gives 7u + 56u^2; the difference is not measurable here.)
/// Underflow: a product of two differences may be wrong by a further 2^-1075, twice per component of w and multiplied
/// with it, and the three last products by 2^-1075 each: less than 2^-1072 (|w|_1 + 1), far below the second term.
/// Overflow: det is built from the same rounded products as the permanent, rounding is monotone, hence
/// |det| <= permanent; if either is infinite so is the bound, and comparisons with infinity or NaN are false: exact
/// stage.
class OrientedPlane {
  public:
    OrientedPlane(const Vec3& a, const Vec3& b, const Vec3& c) : a_(a), b_(b), c_(c) {
        const Vec3 u = b - a, v = c - a;
        const Vec3 plus{u.y * v.z, u.z * v.x, u.x * v.y};
        const Vec3 minus{u.z * v.y, u.x * v.z, u.y * v.x};
        normal_ = plus - minus;
        magnitude_ = abs(plus) + abs(minus);
    }

    [[nodiscard]] int side(const Vec3& d) const {
        const Vec3 w = d - a_, size = abs(w);
        const double determinant = dot(normal_, w);
        const double permanent = dot(magnitude_, size);
        const double bound = kRounding * permanent + kUnderflow * (((size.x + size.y) + size.z) + 1);
        if (determinant > bound) return 1;
        if (determinant < -bound) return -1;
        return orient3d_exact(a_, b_, c_, d);
    }

  private:
    static constexpr double kRounding = 9 * 0x1p-53;
    static constexpr double kUnderflow = 0x1p-1060;

    Vec3 a_, b_, c_;
    Vec3 normal_, magnitude_; ///< minors of the first two rows, and the sums of the magnitudes of their two products
};

} // namespace flotilla::exact
