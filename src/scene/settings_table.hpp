// SPDX-License-Identifier: MIT
// One table of all settings. The scene reader, --set, the listing, the checks and the JSON Schema's test all read it,
// so a setting cannot be known to one of them and not to another.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <flotilla/settings.hpp>

#include "base/error_list.hpp"

namespace flotilla {

/// An enumeration's field as an index into the names of its values.
struct ChoiceField {
    std::size_t (*get)(const Settings&);
    void (*set)(Settings&, std::size_t);
    std::span<const std::string_view> names;
};

using SettingField =
    std::variant<double Settings::*, int Settings::*, std::uint64_t Settings::*, bool Settings::*, ChoiceField>;

struct SettingRow {
    std::string_view key;
    SettingField field;
    std::string_view unit;
    double low = 0; ///< least value accepted
    double high = std::numeric_limits<double>::infinity();
    /// Accepted besides [low, high] and standing for a derived value ("0: size/330"); empty where there is none.
    std::optional<double> derived;
    std::string_view description;
    std::string_view effect;
};

[[nodiscard]] std::span<const SettingRow> settings_table();
[[nodiscard]] const SettingRow* find_setting(std::string_view key);
[[nodiscard]] std::vector<std::string_view> setting_keys();

/// A value as a file or an option gives it. Integers are kept apart from numbers because seeds exceed 2^53.
using SettingValue = std::variant<bool, std::int64_t, std::uint64_t, double, std::string>;

/// Assigns `value` if its type and range fit. Returns the reason where they do not; `settings` is then unchanged.
[[nodiscard]] std::optional<std::string> assign_setting(Settings& settings, const SettingRow& row,
                                                        const SettingValue& value);

/// Ranges and relations between settings, each problem at "<where>/<key>".
void check_settings(const Settings& settings, const std::string& where, ErrorList& errors);

} // namespace flotilla
