// SPDX-License-Identifier: MIT
// Axes of the world along which a body does not move and about which it does not turn.
//
// What is locked has no inverse mass: an impulse along a locked axis moves nothing and a torque about one turns
// nothing, because the world carries both. So the components of velocities along locked axes are zero to the bit.
//
// Rotation: the angular velocity w lies in the span of the free axes. Of the angular momentum I w only the part there
// is kept, L; the rest is what the world's torques make of it. With I_ff, the block of the inertia on the free axes, L
// = I_ff w and w = I_ff^-1 L there, zero elsewhere. In free flight L does not change, for the world's torques have no
// part about the free axes; the energy is w . L / 2.
#pragma once

#include <cstdint>

#include "base/vec3.hpp"

namespace flotilla {

/// Of three axes: 1, 2 and 4 for x, y and z.
using AxisMask = std::uint8_t;
inline constexpr AxisMask kAllAxes = 7;

struct AxisLocks {
    AxisMask translation = 0, rotation = 0;

    [[nodiscard]] constexpr bool any() const { return (translation | rotation) != 0; }
    friend constexpr bool operator==(const AxisLocks&, const AxisLocks&) = default;
};

/// The share of a body's inverse mass that an impulse along a contact's normal must find free at least to act on it:
/// below, normals are rounding apart from locked axes (a millionth of a radian), and a push of a millimetre would take
/// the body along by a kilometre.
inline constexpr double kLeastMobility = 0x1p-40;

constexpr bool is_locked(AxisMask locked, int axis) { return (locked >> axis & 1) != 0; }
constexpr int num_free(AxisMask locked) { return 3 - ((locked & 1) + (locked >> 1 & 1) + (locked >> 2 & 1)); }

/// v without its components along locked axes.
constexpr Vec3 free_part(AxisMask locked, const Vec3& v) {
    if (locked == 0) return v;
    return {is_locked(locked, 0) ? 0.0 : v.x, is_locked(locked, 1) ? 0.0 : v.y, is_locked(locked, 2) ? 0.0 : v.z};
}

/// The rows and columns of free axes; zero elsewhere.
constexpr Mat3 free_block(AxisMask locked, Mat3 a) {
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (is_locked(locked, i) || is_locked(locked, j)) a.m[static_cast<std::size_t>(3 * i + j)] = 0;
    return a;
}

/// The inverse of a symmetric positive definite matrix's block on the free axes, of which there are two at most; zero
/// elsewhere.
constexpr Mat3 free_inverse(AxisMask locked, const Mat3& a) {
    Mat3 out;
    int free[3] = {}, n = 0;
    for (int i = 0; i < 3; ++i)
        if (!is_locked(locked, i)) free[n++] = i;
    const auto at = [](int i, int j) { return static_cast<std::size_t>(3 * i + j); };
    if (n == 1) out.m[at(free[0], free[0])] = 1 / a.m[at(free[0], free[0])];
    if (n == 2) {
        const int i = free[0], j = free[1];
        const double ii = a.m[at(i, i)], jj = a.m[at(j, j)], ij = 0.5 * (a.m[at(i, j)] + a.m[at(j, i)]);
        const double det = ii * jj - ij * ij;
        out.m[at(i, i)] = jj / det;
        out.m[at(j, j)] = ii / det;
        out.m[at(i, j)] = out.m[at(j, i)] = -ij / det;
    }
    return out;
}

} // namespace flotilla
