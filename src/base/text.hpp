// SPDX-License-Identifier: MIT
// Small text helpers for messages and files.
#pragma once

#include <string>
#include <string_view>

#include <flotilla/names.hpp>

namespace flotilla {

/// The shortest decimal that reads back as the same double ("0.1", "1e-06"); "nan", "inf" and "-inf" for the rest.
[[nodiscard]] std::string to_text(double value);

/// `"name"`, with control characters and quotes made visible.
[[nodiscard]] std::string in_quotes(std::string_view name);

} // namespace flotilla
