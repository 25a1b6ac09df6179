// SPDX-License-Identifier: MIT
// An option whose value is one of a few words. CLI11's own CheckedTransformer prints the values beside the words, and
// those of an 8-bit enum as raw bytes.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <utility>
#include <vector>

namespace flotilla::cli {

/// `value` is the default and lives as long as `command` parses; `words` names it and every other value.
template <class Enum>
CLI::Option* add_enum_option(CLI::App& command, const std::string& name, Enum& value,
                             const std::vector<std::pair<std::string, Enum>>& words, const std::string& text) {
    std::vector<std::string> known;
    std::string initial;
    for (const auto& [word, meaning] : words) {
        known.push_back(word);
        if (meaning == value) initial = word;
    }
    const auto assign = [&value, words](const std::string& given) {
        for (const auto& [word, meaning] : words)
            if (word == given) value = meaning;
    };
    return command.add_option_function<std::string>(name, assign, text)
        ->check(CLI::IsMember(known))
        ->default_str(initial);
}

} // namespace flotilla::cli
