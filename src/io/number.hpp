// SPDX-License-Identifier: MIT
// Numbers as text, without locales.
#pragma once

#include <charconv>
#include <concepts>
#include <string>
#include <string_view>

namespace flotilla::io {

/// The shortest text that reads back as the same double.
inline void append_number(std::string& text, double value) {
    char buffer[32];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}
/// 17 significant digits.
inline void append_number_17(std::string& text, double value) {
    char buffer[40];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, 17).ptr);
}
void append_number(std::string& text, std::integral auto value) {
    char buffer[24];
    text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

/// True where all of `text` is a number of this type; "nan" and "inf" are numbers.
template <typename T>
[[nodiscard]] bool parse_number(std::string_view text, T& value) {
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return result.ec == std::errc{} && result.ptr == text.data() + text.size();
}

} // namespace flotilla::io
