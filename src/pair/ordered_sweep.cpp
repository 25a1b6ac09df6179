// SPDX-License-Identifier: MIT
#include "pair/ordered_sweep.hpp"

#include "base/index.hpp"

namespace flotilla {
namespace {

/// Colours the list greedily and returns where the places of each colour begin in its order.
std::array<std::int32_t, kColors + 1> color_greedily(std::size_t num_clusters, SweepBuffers& buffers) {
    const std::size_t size = buffers.things.size();
    buffers.used_colors.assign(num_clusters, 0);
    buffers.color.resize(size);
    std::array<std::int32_t, kColors + 1> begin{};
    for (std::size_t i = 0; i < size; ++i) {
        const auto [a, b] = buffers.things[i];
        std::uint64_t none = 0;
        std::uint64_t& used_a = a >= 0 ? buffers.used_colors[at(a)] : none;
        std::uint64_t& used_b = b >= 0 ? buffers.used_colors[at(b)] : none;
        const int color = std::min(std::countr_one(used_a | used_b), kColors - 1);
        used_a |= std::uint64_t{1} << color;
        used_b |= std::uint64_t{1} << color;
        buffers.color[i] = static_cast<std::uint8_t>(color);
        ++begin[at(color) + 1];
    }
    for (std::size_t c = 1; c < begin.size(); ++c) begin[c] += begin[c - 1];
    return begin;
}

} // namespace

std::span<const std::int32_t> order_by_color(std::size_t num_clusters, SweepBuffers& buffers) {
    auto next = color_greedily(num_clusters, buffers);
    buffers.places.resize(buffers.color.size());
    for (std::size_t i = 0; i < buffers.places.size(); ++i)
        buffers.places[at(next[buffers.color[i]]++)] = static_cast<std::int32_t>(i);
    return buffers.places;
}

void order_tasks(const SweepPlan& plan, SweepBuffers& buffers) {
    const std::size_t num_clusters = buffers.used_colors.size();
    buffers.touched.assign(num_clusters, 0);
    buffers.tasks.clear();
    buffers.order.start(num_clusters);
    const auto touched = [&](std::int32_t c) { return c >= 0 && buffers.touched[at(c)] != 0; };
    for (int round = 0; round < plan.rounds; ++round)
        for (std::size_t i = 0; i < plan.size(); ++i) {
            const std::size_t k = plan.place(round, i);
            const auto [a, b] = buffers.things[k];
            if (buffers.open[k] == 0 && !touched(a) && !touched(b)) continue;
            if (a >= 0) buffers.touched[at(a)] = 1;
            if (b >= 0) buffers.touched[at(b)] = 1;
            buffers.tasks.push_back({static_cast<std::int32_t>(k), round});
            buffers.order.add(a, b);
        }
}

} // namespace flotilla
