// SPDX-License-Identifier: MIT
// Values of settings as the library reads them, from Python's.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "python/casters.hpp"

namespace flotilla::python {

using Overrides = std::vector<std::pair<std::string, std::string>>;

/// The text of a value that set_setting reads; a float keeps its bits.
[[nodiscard]] std::string setting_text(const py::handle& value);
/// A dict of settings, or None.
[[nodiscard]] Overrides overrides_of(const py::object& settings);

} // namespace flotilla::python
