// SPDX-License-Identifier: MIT
#include "base/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

namespace flotilla {

std::string to_text(double value) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return {buffer.data(), end.ptr};
}

std::string in_quotes(std::string_view name) {
    static constexpr std::string_view kHex = "0123456789abcdef";
    std::string text = "\"";
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            (text += '\\') += c;
        else if (byte < 0x20 || byte == 0x7f)
            ((text += "\\x") += kHex[byte >> 4U]) += kHex[byte & 15U];
        else
            text += c;
    }
    return text += '"';
}

namespace {

// Edit distance with swaps of neighbours (optimal string alignment), over three rows of the table.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replace = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, replace});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before_last[j - 2] + 1);
        }
        std::swap(before_last, last);
        std::swap(last, row);
    }
    return last[b.size()];
}

// Whole words of a longer name are what people remember of it.
std::string_view shortest_containing(std::string_view part, std::span<const std::string_view> candidates) {
    std::string_view best;
    if (part.size() < 3) return best;
    for (const std::string_view candidate : candidates)
        if (candidate.find(part) != std::string_view::npos && (best.empty() || candidate.size() < best.size()))
            best = candidate;
    return best;
}

} // namespace

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> candidates) {
    std::string_view best;
    std::size_t best_distance = std::max<std::size_t>(2, name.size() / 3) + 1;
    for (const std::string_view candidate : candidates) {
        // A candidate no longer than the allowed distance would match anything.
        const std::size_t distance = edit_distance(name, candidate);
        if (distance < best_distance && distance < std::max(name.size(), candidate.size())) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best.empty() ? shortest_containing(name, candidates) : best;
}

std::string unknown_name(std::string_view kind, std::string_view name, std::span<const std::string_view> known) {
    std::string text = "unknown " + std::string(kind) + " " + in_quotes(name);
    const std::string_view nearest = nearest_name(name, known);
    if (!nearest.empty()) text += "; did you mean " + in_quotes(nearest) + "?";
    return text;
}

} // namespace flotilla
