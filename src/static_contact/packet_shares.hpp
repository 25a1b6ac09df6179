// SPDX-License-Identifier: MIT
// How the packets of a group are shared out to the threads that sweep them together.
#pragma once

#include <algorithm>
#include <span>

#include "parallel/sweep_width.hpp"
#include "static_contact/contact_packets.hpp"

namespace flotilla {

/// The packets of a group, cut into shares of about equally many rows, one per thread.
[[nodiscard]] inline std::span<const ContactPacket> share_of(std::span<const ContactPacket> packets, int thread,
                                                             int threads) {
    if (threads == 1 || packets.empty()) return packets;
    const std::int32_t first = packets.front().first, rows = packets.back().end - first;
    const auto cut = [&](int t) {
        const auto row = first + static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * t / threads);
        return std::partition_point(packets.begin(), packets.end(),
                                    [&](const ContactPacket& p) { return p.first < row; });
    };
    const auto begin = cut(thread), end = thread + 1 == threads ? packets.end() : cut(thread + 1);
    return {begin, end};
}

/// A group as the packets from its first one to the next group's, or to `end`.
struct GroupPackets {
    std::span<const ContactPacket> packets;
    std::int32_t swept = 0;
    bool alone = false;

    [[nodiscard]] std::span<const ContactPacket> share(int thread, int threads) const {
        if (alone) return thread == 0 ? packets : std::span<const ContactPacket>{};
        return share_of(packets, thread, threads);
    }
    /// How many tasks could be done side by side.
    [[nodiscard]] std::int32_t num_tasks() const { return alone ? 1 : swept; }
};
[[nodiscard]] inline GroupPackets packets_of(std::span<const PacketGroup> groups, std::size_t group, std::int32_t end,
                                             std::span<const ContactPacket> packets) {
    const auto first = static_cast<std::size_t>(groups[group].first);
    const auto last = static_cast<std::size_t>(group + 1 < groups.size() ? groups[group + 1].first : end);
    return {packets.subspan(first, last - first), groups[group].swept, groups[group].alone};
}

/// How many threads, at most `most`, sweeps of the groups are worth: a group for one thread counts as one task.
[[nodiscard]] inline int sweep_width_of(std::span<const PacketGroup> groups, std::int32_t end,
                                        std::span<const ContactPacket> packets, int most) {
    std::size_t tasks = 0;
    for (std::size_t g = 0; g < groups.size(); ++g)
        tasks += static_cast<std::size_t>(packets_of(groups, g, end, packets).num_tasks());
    return sweep_width(tasks, groups.size(), most);
}

} // namespace flotilla
