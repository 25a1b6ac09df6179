// SPDX-License-Identifier: MIT
#include "static_contact/sweep_shares.hpp"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <set>
#include <vector>

#include <gtest/gtest.h>

namespace flotilla {
namespace {

std::vector<ContactBlock> blocks_of_colors(std::initializer_list<int> pairs_of_color) {
    std::vector<ContactBlock> blocks;
    std::int32_t color = 0;
    for (const int pairs : pairs_of_color) {
        for (int k = 0; k < pairs; ++k) {
            ContactBlock& block = blocks.emplace_back();
            block.color = color;
            block.first = static_cast<std::int32_t>(blocks.size()) - 1;
            block.parked = block.end = block.first + 1;
        }
        ++color;
    }
    return blocks;
}

TEST(SweepShares, SmallColorsInARowCountAsOneTask) {
    const std::vector<ContactBlock> blocks = blocks_of_colors({40, 8, 20, 4, 40, 1});
    PackedContacts packed;
    std::vector<PacketGroup> groups{{-1, 0}}; // an earlier island's
    lay_out_packets(blocks, 0, static_cast<std::int32_t>(blocks.size()), packed, groups);
    ASSERT_EQ(packed.packets.size(), 10u + 2 + 5 + 1 + 10 + 1);
    std::vector<std::int32_t> first;
    for (const PacketGroup& group : groups) first.push_back(group.first);
    EXPECT_EQ(first, (std::vector<std::int32_t>{-1, 0, 10, 12, 17, 18, 28}));
    const std::span<const PacketGroup> island = std::span(groups).subspan(1);
    EXPECT_EQ(packets_of(island, 2, 29, packed.packets).size(), 5u);
    EXPECT_EQ(sweep_width_of(island.first(1), 10, 16), 10);
    EXPECT_EQ(sweep_width_of(island.subspan(1, 3), 18, 16), 1) << "eight packets of three colours: one task";
    EXPECT_EQ(sweep_width_of(island.first(2), 12, 16), 1) << "ten and two, six on average";
}

// Every packet has one share in each colour, shares are about equal, and two that meet a body are neighbours.
TEST(SweepShares, SharesThatMeetABodyAreNeighbours) {
    std::vector<ContactBlock> blocks = blocks_of_colors({160, 80, 3});
    const std::vector<std::uint8_t> movable = [] {
        std::vector<std::uint8_t> all(322, 1);
        all[0] = 0;
        return all;
    }();
    for (std::size_t k = 0; k < blocks.size(); ++k) { // bodies in a row, the first one against some of all
        blocks[k].a = static_cast<std::int32_t>(k < 160 ? 1 + 2 * k : k < 240 ? 2 + 4 * (k - 160) : 0);
        blocks[k].b = static_cast<std::int32_t>(k < 160   ? 2 + 2 * k
                                                : k < 240 ? 3 + 4 * (k - 160)
                                                          : 1 + 150 * (k - 240));
    }
    PackedContacts packed;
    std::vector<PacketGroup> groups;
    lay_out_packets(blocks, 0, static_cast<std::int32_t>(blocks.size()), packed, groups);
    resize_rows(packed);
    for (std::size_t p = 0; p < packed.packets.size(); ++p) {
        ContactPacket& packet = packed.packets[p];
        for (std::size_t lane = 0; lane < static_cast<std::size_t>(packet.num_pairs); ++lane) {
            const ContactBlock& block = blocks[static_cast<std::size_t>(packed.first_block[p]) + lane];
            packet.a[lane] = block.a;
            packet.b[lane] = block.b;
        }
    }
    for (const int n : {2, 5, 8, 70}) {
        ShareMemory memory;
        SweepShares shares(n, groups, static_cast<std::int32_t>(packed.packets.size()), packed.packets, movable,
                           memory);
        shares.reserve();
        for (std::size_t phase = 0; phase < static_cast<std::size_t>(SweepShares::kPreparations); ++phase)
            for (int share = 0; share < n; ++share) shares.prepare(phase, share);
        const PhaseChain chain = shares.chain(1);
        EXPECT_EQ(chain.size(), 3u);
        std::vector<std::set<std::int32_t>> met(static_cast<std::size_t>(n));
        for (std::size_t g = 0; g < groups.size(); ++g) {
            std::size_t packets = 0;
            for (int share = 0; share < n; ++share) {
                const auto own = shares.packets(g, share);
                packets += own.size();
                EXPECT_LE(own.size(), 1 + shares.packets(g).size() / static_cast<std::size_t>(n));
                EXPECT_EQ(chain.works(1 + g, share), g == 0 || !own.empty());
                for (const ContactPacket& packet : own)
                    for (std::size_t lane = 0; lane < static_cast<std::size_t>(packet.num_pairs); ++lane)
                        for (const std::int32_t body : {packet.a[lane], packet.b[lane]})
                            if (body != 0) met[static_cast<std::size_t>(share)].insert(body);
            }
            EXPECT_EQ(packets, shares.packets(g).size());
        }
        std::size_t neighbours = 0;
        const std::size_t words = PhaseChain::words(n);
        for (std::size_t i = 0; i < met.size(); ++i)
            for (std::size_t j = 0; j < met.size(); ++j) {
                std::vector<std::int32_t> common;
                std::ranges::set_intersection(met[i], met[j], std::back_inserter(common));
                const bool near = (chain.near[i * words + j / 64] >> j % 64 & 1) != 0;
                EXPECT_EQ(near, i != j && !common.empty()) << i << ' ' << j << " of " << n;
                neighbours += near ? 1 : 0;
            }
        EXPECT_GT(neighbours, 0u);
        EXPECT_LT(neighbours, met.size() * 6) << "few of all";
    }
}

} // namespace
} // namespace flotilla
