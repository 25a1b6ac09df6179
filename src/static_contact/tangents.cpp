// SPDX-License-Identifier: MIT
#include "static_contact/tangents.hpp"

#include <cmath>
#include <numbers>

#include "base/random.hpp"
#include "base/rotation.hpp"

namespace flotilla {
namespace {

// Any unit vector orthogonal to n, without a branch that loses accuracy (Duff et al. 2017, JCGT 6(1)).
Vec3 any_tangent(const Vec3& n) {
    const double sign = std::copysign(1.0, n.z);
    const double a = -1.0 / (sign + n.z);
    return {1.0 + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x};
}

} // namespace

TangentPair any_tangents(const Vec3& normal) {
    const Vec3 t1 = any_tangent(normal);
    return {t1, cross(normal, t1)};
}

TangentPair keyed_tangents(const Contact& contact, std::uint64_t seed, std::uint64_t step) {
    const std::uint64_t bits = random_bits(seed, step, contact.a, contact.b, contact.feature_key);
    const auto [s, c] = sin_cos(std::numbers::pi / 2 * unit_interval(bits));
    const Vec3 t = any_tangent(contact.normal);
    const Vec3 t1 = c * t + s * cross(contact.normal, t);
    return {t1, cross(contact.normal, t1)};
}

} // namespace flotilla
