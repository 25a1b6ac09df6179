// SPDX-License-Identifier: MIT
// Bytes as text (RFC 4648, with padding), for text formats that hold arrays.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace flotilla::io {

[[nodiscard]] std::string base64(std::span<const std::byte> bytes);
/// The bytes; none where the text is no such text. Padding may be missing.
[[nodiscard]] std::optional<std::string> from_base64(std::string_view text);

} // namespace flotilla::io
