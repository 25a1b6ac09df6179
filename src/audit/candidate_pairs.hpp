// SPDX-License-Identifier: MIT
// The audit's broad phase: sort and sweep along x.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "audit/audit.hpp"

namespace flotilla::audit {

struct BodyPair {
    std::int32_t a = 0, b = 0; ///< a < b
    friend auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// All pairs of bodies whose boxes overlap, at least one of finite mass, sorted. A body without a box is in no pair.
[[nodiscard]] std::vector<BodyPair> candidate_pairs(const Scene& scene, std::span<const std::optional<Bounds>> boxes);

} // namespace flotilla::audit
