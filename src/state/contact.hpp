// SPDX-License-Identifier: MIT
// Contact points between two bodies: what proximity detection hands to the contact solver (paper, section 4.3).
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <flotilla/types.hpp>

#include "base/vec3.hpp"

namespace flotilla {

/// One contact of bodies a < b.
struct Contact {
    std::int32_t a = 0, b = 0;     ///< body ids
    Vec3 point;                    ///< m, world, on a or on b
    Vec3 normal;                   ///< unit, from a to b
    double distance = 0;           ///< m, current gap d
    double target = 0;             ///< m/s, least (v_b - v_a).n wanted: (d_rest - d)/dt or its minimum with 0 (eq. 16)
    double friction = 0;           ///< coefficient of the pair, >= 0
    std::uint64_t feature_key = 0; ///< feature pair, unique within the body pair
    double tolerance = std::numeric_limits<double>::infinity(); ///< m/s, to which its island is to be solved at least
    bool sticks = false; ///< hardly slid in the last step: random tangents stay what they were
    Vec3 slip;           ///< m/s, tangential: (v_b - v_a) that friction leads to; world
    Vec3 across;         ///< m, of thin bodies: from `point`, which is on a then, to that on b
};

/// m, world: where the contact's impulse acts on one of its bodies.
[[nodiscard]] inline Vec3 point_on(const Contact& c, std::int32_t body) {
    return body == c.b ? c.point + c.across : c.point;
}

/// Whether contact i of a list, which comes pair by pair, is the first one of its pair.
[[nodiscard]] inline bool begins_pair(std::span<const Contact> contacts, std::size_t i) {
    return i == 0 || contacts[i - 1].a != contacts[i].a || contacts[i - 1].b != contacts[i].b;
}

/// Cosine of the angle beyond which contacts oppose each other. From 120 degrees on 29 rings of mail are merged 29
/// times in 15 steps and one is held, with this six times and none; from a right angle on twice, but one pile of ten of
/// 102 boats does not rest.
inline constexpr double kOpposed = -0.25;
/// Whether contacts of a pair oppose each other: the one body is between sides of the other, as a peg in its hole.
/// Their normals make clearly more than a right angle, that of a floor and a wall.
[[nodiscard]] inline bool oppose(const Contact& first, const Contact& second) {
    return dot(first.normal, second.normal) < kOpposed;
}
/// Whether any of those of a pair do.
[[nodiscard]] inline bool holds_between(std::span<const Contact> pair) {
    Vec3 sum;
    for (const Contact& c : pair) sum += c.normal;
    // All within half of that angle of one direction: none do.
    const double least = std::sqrt(0.5 * (1 + kOpposed)) * length(sum);
    bool spread = false;
    for (const Contact& c : pair) spread |= !(dot(c.normal, sum) > least);
    if (!spread) return false;
    for (std::size_t i = 1; i < pair.size(); ++i)
        for (std::size_t k = 0; k < i; ++k)
            if (oppose(pair[k], pair[i])) return true;
    return false;
}

} // namespace flotilla
