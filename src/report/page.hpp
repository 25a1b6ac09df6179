// SPDX-License-Identifier: MIT
// The files of src/report/page as text, put there at build time.
#pragma once

#include <string_view>

namespace flotilla::report {

/// The page; "{{style}}", "{{data}}", "{{poses}}" and "{{script}}" stand where their contents go, once each, in this
/// order.
[[nodiscard]] std::string_view page_html();
[[nodiscard]] std::string_view page_style();
/// All scripts, one after the other: one module.
[[nodiscard]] std::string_view page_script();

} // namespace flotilla::report
