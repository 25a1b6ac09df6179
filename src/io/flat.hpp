// SPDX-License-Identifier: MIT
// Vectors, quaternions and triangles are arrays of their components: the rows of numbers that files hold.
#pragma once

#include <cstdint>
#include <span>

#include <flotilla/types.hpp>

namespace flotilla::io {

inline std::span<const double> flat(std::span<const Vec3> values) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    return {reinterpret_cast<const double*>(values.data()), 3 * values.size()};
}
inline std::span<const double> flat(std::span<const Quat> values) {
    static_assert(sizeof(Quat) == 4 * sizeof(double));
    return {reinterpret_cast<const double*>(values.data()), 4 * values.size()};
}
inline std::span<const std::int32_t> flat(std::span<const Triangle> values) {
    static_assert(sizeof(Triangle) == 3 * sizeof(std::int32_t));
    return {reinterpret_cast<const std::int32_t*>(values.data()), 3 * values.size()};
}

} // namespace flotilla::io
