// SPDX-License-Identifier: MIT
#include "static_contact/sweep_shares.hpp"

#include <atomic>

#include "base/index.hpp"
#include "parallel/sweep_width.hpp"

namespace flotilla {
namespace {

/// Packets that one thread takes about as long for as a few threads wait for one another. Small groups in a row count
/// as one task up to so many.
constexpr std::int32_t kMostAlone = 8;

/// Two shares are taken for neighbours without a look: they nearly always are.
constexpr std::uint64_t kBoth = 3;

} // namespace

int sweep_width_of(std::span<const PacketGroup> groups, std::int32_t end, int most) {
    std::size_t tasks = 0, counted = 0;
    for (std::size_t g = 0, next = 0; g < groups.size(); g = next, ++counted) {
        const auto end_of = [&](std::size_t i) { return i + 1 < groups.size() ? groups[i + 1].first : end; };
        while (next < groups.size() && (next == g || end_of(next) - groups[g].first <= kMostAlone)) ++next;
        tasks += next - g > 1 ? 1 : at(groups[g].swept);
    }
    return sweep_width(tasks, counted, most);
}

SweepShares::SweepShares(int shares, std::span<const PacketGroup> groups, std::int32_t end,
                         std::span<const ContactPacket> packets, std::span<const std::uint8_t> movable,
                         ShareMemory& memory)
    : shares_(shares), groups_(groups), end_(end), packets_(packets), movable_(movable), memory_(memory) {}

void SweepShares::reserve() {
    const std::size_t words = PhaseChain::words(shares_);
    memory_.cut.resize(groups_.size() * (at(shares_) + 1));
    memory_.users.resize(shares_ == 2 ? 0 : movable_.size() * words);
    memory_.near.resize(at(shares_) * words);
    memory_.next.resize(at(shares_) * groups_.size());
}

void SweepShares::prepare(std::size_t phase, int share) {
    if (phase == 0) return cut(share);
    if (phase == 1) return note_users(share);
    find_neighbours(share);
}

/// Where the share begins in every group; also empties its stretch of the users.
void SweepShares::cut(int share) {
    const std::size_t n = at(shares_) + 1;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const auto all = packets(g), own = share_of(all, share, shares_);
        memory_.cut[g * n + at(share)] = static_cast<std::int32_t>(own.data() - all.data());
        if (share + 1 == shares_) memory_.cut[g * n + at(shares_)] = static_cast<std::int32_t>(all.size());
    }
    const auto part = [&](int k) {
        return memory_.users.begin() + static_cast<std::ptrdiff_t>(memory_.users.size() * at(k) / at(shares_));
    };
    std::fill(part(share), part(share + 1), 0);
}

/// Calls work(its users) for every movable body that the share meets, once or more often.
template <class Work>
void SweepShares::for_bodies(int share, Work&& work) const {
    const std::size_t words = PhaseChain::words(shares_);
    for (std::size_t g = 0; g < groups_.size(); ++g)
        for (const ContactPacket& packet : packets(g, share))
            for (std::size_t lane = 0; lane < at(packet.num_pairs); ++lane)
                for (const std::int32_t body : {packet.a[lane], packet.b[lane]})
                    if (movable_[at(body)] != 0) work(std::span(memory_.users).subspan(at(body) * words, words));
}

void SweepShares::note_users(int share) {
    if (shares_ == 2) return;
    const std::uint64_t bit = std::uint64_t{1} << share % 64;
    for_bodies(share, [&](std::span<std::uint64_t> users) {
        const std::atomic_ref<std::uint64_t> word(users[at(share / 64)]);
        if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
    });
}

void SweepShares::find_neighbours(int share) {
    const std::size_t words = PhaseChain::words(shares_);
    const auto near = std::span(memory_.near).subspan(at(share) * words, words);
    std::ranges::fill(near, shares_ == 2 ? kBoth : 0);
    if (shares_ > 2)
        for_bodies(share, [&](std::span<const std::uint64_t> users) {
            for (std::size_t w = 0; w < words; ++w) near[w] |= users[w];
        });
    near[at(share / 64)] &= ~(std::uint64_t{1} << share % 64);
    const auto next = std::span(memory_.next).subspan(at(share) * groups_.size(), groups_.size());
    auto to = static_cast<std::int32_t>(groups_.size());
    for (std::size_t g = groups_.size(); g-- > 0;) {
        next[g] = to;
        if (!packets(g, share).empty()) to = static_cast<std::int32_t>(g);
    }
}

} // namespace flotilla
