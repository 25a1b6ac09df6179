// SPDX-License-Identifier: MIT
#include "geometry/ray.hpp"

namespace flotilla {

std::optional<double> segment_triangle(const Vec3& p, const Vec3& q, const Vec3& f0, const Vec3& f1, const Vec3& f2) {
    const Vec3 n = cross(f1 - f0, f2 - f0);
    const double hp = dot(n, p - f0), hq = dot(n, q - f0);
    if (hp == hq || (hp > 0 && hq > 0) || (hp < 0 && hq < 0)) return std::nullopt;
    // The line passes inside where the volumes spanned with the three edges have one sign.
    const Vec3 d = q - p;
    const double v0 = dot(d, cross(f1 - p, f2 - p)), v1 = dot(d, cross(f2 - p, f0 - p)),
                 v2 = dot(d, cross(f0 - p, f1 - p));
    const bool inside = (v0 >= 0 && v1 >= 0 && v2 >= 0) || (v0 <= 0 && v1 <= 0 && v2 <= 0);
    if (!inside) return std::nullopt;
    return hp / (hp - hq);
}

} // namespace flotilla
