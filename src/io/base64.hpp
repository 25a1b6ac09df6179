// SPDX-License-Identifier: MIT
// Bytes as text (RFC 4648, with padding), for text formats that hold arrays.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace flotilla::io {

[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

} // namespace flotilla::io
