// SPDX-License-Identifier: MIT
// What the mesh readers share: a text walked line by line or word by word, numbers independent of the locale, errors
// that say where.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <flotilla/error.hpp>

#include "mesh/triangle_mesh.hpp"

namespace flotilla {

/// Parts of a mesh that a reader collects; one function per format. `data` is the whole file.
[[nodiscard]] TriangleMesh read_obj(const std::filesystem::path& path, const std::string& data);
/// The same of a file that may have vertices alone.
[[nodiscard]] TriangleMesh read_obj_cloud(const std::filesystem::path& path, const std::string& data);
/// The elements of one object or group.
[[nodiscard]] TriangleMesh read_obj_part(const std::filesystem::path& path, const std::string& data,
                                         std::string_view part);
[[nodiscard]] TriangleMesh read_stl(const std::filesystem::path& path, const std::string& data);
[[nodiscard]] TriangleMesh read_ply(const std::filesystem::path& path, const std::string& data);

constexpr bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// Takes the next word off the front of `rest`; empty at its end.
inline std::string_view take_word(std::string_view& rest) {
    std::size_t i = 0;
    while (i < rest.size() && is_blank(rest[i])) ++i;
    std::size_t j = i;
    while (j < rest.size() && !is_blank(rest[j])) ++j;
    const std::string_view word = rest.substr(i, j - i);
    rest.remove_prefix(j);
    return word;
}

/// A number that fills the whole word. A leading '+' is allowed; values too small for a double become zero or
/// subnormal.
inline std::optional<double> parse_double(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || word.empty()) return std::nullopt;
    if (error == std::errc()) return value;
    // Out of range: too large, unless the exponent is negative.
    if (error == std::errc::result_out_of_range && word.find_first_of("eE") != std::string_view::npos &&
        word[word.find_first_of("eE") + 1] == '-')
        return word[0] == '-' ? -0.0 : 0.0;
    return std::nullopt;
}

inline std::optional<std::int64_t> parse_integer(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

/// Walks a text and knows the line it is on.
class TextInput {
  public:
    TextInput(const std::filesystem::path& path, std::string_view text) : path_(path), text_(text) {}

    [[nodiscard]] bool at_end() const { return position_ >= text_.size(); }
    [[nodiscard]] std::size_t position() const { return position_; }
    [[nodiscard]] std::size_t line() const { return line_; }

    /// The next line without its end; fail() then speaks of this line.
    std::optional<std::string_view> next_line() {
        if (at_end()) return std::nullopt;
        const std::size_t end = std::min(text_.find('\n', position_), text_.size());
        std::string_view line = text_.substr(position_, end - position_);
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
        position_ = std::min(end + 1, text_.size());
        ++line_;
        return line;
    }

    [[noreturn]] void fail_at(std::size_t line, const std::string& reason) const {
        throw InputError(path_.string() + ":" + std::to_string(line) + ": " + reason);
    }
    [[noreturn]] void fail(const std::string& reason) const { fail_at(line_ == 0 ? 1 : line_, reason); }

    double number(std::string_view word) const {
        if (word.empty()) fail("a number is missing");
        const auto value = parse_double(word);
        if (!value) fail("malformed number '" + std::string(word) + "'");
        return *value;
    }
    /// A coordinate: a finite number.
    double coordinate(std::string_view word) const {
        const double value = number(word);
        if (!std::isfinite(value)) fail("coordinate '" + std::string(word) + "' is not finite");
        return value;
    }
    std::int64_t integer(std::string_view word) const {
        if (word.empty()) fail("an integer is missing");
        const auto value = parse_integer(word);
        if (!value) fail("malformed integer '" + std::string(word) + "'");
        return *value;
    }

  private:
    const std::filesystem::path& path_;
    std::string_view text_;
    std::size_t position_ = 0;
    std::size_t line_ = 0;
};

/// "index 9 is out of range, there are 8 vertices".
inline std::string out_of_range_text(std::int64_t index, std::size_t vertices) {
    return "index " + std::to_string(index) + " is out of range, there are " + std::to_string(vertices) + " vertices";
}

} // namespace flotilla
