// SPDX-License-Identifier: MIT
// How the packets of every colour are shared out to the threads that sweep them together, and which of these shares
// meet the same bodies.
//
// Packets of a colour are in the order of regions (assemble.cpp), and every colour is cut into shares of about equally
// many rows: so a share has about the same region in all colours, and meets the bodies of a few others. It waits for
// those alone before it begins a colour (PhaseChain): what others do changes none of its bodies.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "parallel/crew.hpp"
#include "static_contact/contact_packets.hpp"

namespace flotilla {

/// Packets cut into shares of about equally many rows; the given one.
[[nodiscard]] inline std::span<const ContactPacket> share_of(std::span<const ContactPacket> packets, int share,
                                                             int shares) {
    if (shares == 1 || packets.empty()) return packets;
    const std::int32_t first = packets.front().first, rows = packets.back().end - first;
    const auto cut = [&](int t) {
        const auto row = first + static_cast<std::int32_t>(static_cast<std::int64_t>(rows) * t / shares);
        return std::partition_point(packets.begin(), packets.end(),
                                    [&](const ContactPacket& p) { return p.first < row; });
    };
    const auto begin = cut(share), end = share + 1 == shares ? packets.end() : cut(share + 1);
    return {begin, end};
}

/// The packets of a group: from its first one to the next group's, or to `end`.
[[nodiscard]] inline std::span<const ContactPacket> packets_of(std::span<const PacketGroup> groups, std::size_t group,
                                                               std::int32_t end,
                                                               std::span<const ContactPacket> packets) {
    const auto first = static_cast<std::size_t>(groups[group].first);
    const auto last = static_cast<std::size_t>(group + 1 < groups.size() ? groups[group + 1].first : end);
    return packets.subspan(first, last - first);
}

/// How many threads, at most `most`, sweeps of the groups are worth.
[[nodiscard]] int sweep_width_of(std::span<const PacketGroup> groups, std::int32_t end, int most);

/// Memory of shares, kept between solves.
struct ShareMemory {
    std::vector<std::int32_t> cut;    ///< by group, one more than shares: where they begin, as packets of the group
    std::vector<std::uint64_t> users; ///< by body in contact, the set of shares that meet it
    std::vector<std::uint64_t> near;  ///< PhaseChain::near
    std::vector<std::int32_t> next;   ///< PhaseChain::next
};

/// The shares of one engine. Several have to be prepared: reserve(), then every share in each of kPreparations phases.
/// One share touches no memory: islands are swept side by side.
class SweepShares {
  public:
    SweepShares(int shares, std::span<const PacketGroup> groups, std::int32_t end,
                std::span<const ContactPacket> packets, std::span<const std::uint8_t> movable, ShareMemory& memory);

    static constexpr int kPreparations = 3;
    void reserve();
    void prepare(std::size_t phase, int share);

    [[nodiscard]] int size() const { return shares_; }
    [[nodiscard]] std::span<const ContactPacket> packets(std::size_t group) const {
        return packets_of(groups_, group, end_, packets_);
    }
    [[nodiscard]] std::span<const ContactPacket> packets(std::size_t group, int share) const {
        if (shares_ == 1) return packets(group);
        const auto cut =
            memory_.cut.begin() + static_cast<std::ptrdiff_t>(group * (static_cast<std::size_t>(shares_) + 1) +
                                                              static_cast<std::size_t>(share));
        return packets(group).subspan(static_cast<std::size_t>(cut[0]), static_cast<std::size_t>(cut[1] - cut[0]));
    }
    /// The groups as phases from `begin` on.
    [[nodiscard]] PhaseChain chain(std::size_t begin) const {
        return {begin, begin + groups_.size(), memory_.near, memory_.next};
    }

  private:
    void cut(int share);
    void note_users(int share);
    void find_neighbours(int share);
    template <class Work>
    void for_bodies(int share, Work&& work) const;

    int shares_;
    std::span<const PacketGroup> groups_;
    std::int32_t end_;
    std::span<const ContactPacket> packets_;
    std::span<const std::uint8_t> movable_;
    ShareMemory& memory_;
};

} // namespace flotilla
