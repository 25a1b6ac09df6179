// SPDX-License-Identifier: MIT
// Who rests on whom: Guendelman, Bridson, Fedkiw 2003, section 6.1.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace flotilla::baseline {

/// (upper, lower): the upper body hit the lower one when it alone was moved. Bodies that rest on each other in a circle
/// form one level together. Returns a level for each of `count` bodies: 0 for those on nothing, otherwise one above the
/// highest below.
[[nodiscard]] std::vector<int> contact_levels(std::size_t count,
                                              const std::vector<std::pair<std::size_t, std::size_t>>& rests_on);

} // namespace flotilla::baseline
