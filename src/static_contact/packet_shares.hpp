// SPDX-License-Identifier: MIT
// How the packets of one colour are shared out to the threads that sweep them together.
#pragma once

#include <algorithm>
#include <span>

#include "static_contact/contact_packets.hpp"

namespace flotilla {

/// The packets of one colour, cut into shares of about equally many rows, one per thread.
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

} // namespace flotilla
