// SPDX-License-Identifier: MIT
// Whether two values are the same to the bit: 0 and -0 are not, and a NaN is itself.
#pragma once

#include <cstring>
#include <type_traits>

namespace flotilla {

/// Of a type without padding.
template <class T>
[[nodiscard]] bool same_bits(const T& a, const T& b) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

} // namespace flotilla
