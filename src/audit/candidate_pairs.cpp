// SPDX-License-Identifier: MIT
#include "audit/candidate_pairs.hpp"

#include <algorithm>

namespace flotilla::audit {

std::vector<BodyPair> candidate_pairs(const Scene& scene, std::span<const std::optional<Bounds>> boxes) {
    std::vector<std::int32_t> order;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (boxes[i]) order.push_back(static_cast<std::int32_t>(i));
    const auto box = [&](std::int32_t i) -> const Bounds& { return *boxes[static_cast<std::size_t>(i)]; };
    const auto infinite = [&](std::int32_t i) { return scene.bodies[static_cast<std::size_t>(i)].infinite_mass; };
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return box(a).low[0] != box(b).low[0] ? box(a).low[0] < box(b).low[0] : a < b;
    });
    std::vector<BodyPair> pairs;
    for (std::size_t i = 0; i < order.size(); ++i) {
        for (std::size_t j = i + 1; j < order.size() && box(order[j]).low[0] <= box(order[i]).high[0]; ++j) {
            const auto [a, b] = std::minmax(order[i], order[j]);
            if (!(infinite(a) && infinite(b)) && overlap(box(a), box(b)) && !scene.ignores(a, b))
                pairs.push_back({a, b});
        }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

} // namespace flotilla::audit
