// SPDX-License-Identifier: MIT
// Ids of bodies, features and the like are signed 32-bit numbers; containers count with std::size_t.
#pragma once

#include <cstddef>
#include <cstdint>

namespace flotilla {

/// An id, not negative, as an index.
constexpr std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

} // namespace flotilla
