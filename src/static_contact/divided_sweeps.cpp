// SPDX-License-Identifier: MIT
#include "static_contact/divided_sweeps.hpp"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <utility>

#include "base/index.hpp"

namespace flotilla {
namespace {

/// The body id, or -1 where it has infinite mass.
std::int32_t shared_id(const ContactScratch& s, std::int32_t body) {
    return s.movable[at(body)] != 0 ? s.bodies[at(body)] : -1;
}

/// Of a packet that is that of its first pair.
std::int32_t payer_of(const ContactPacket& packet, const ContactScratch& s) {
    return Division::payer(shared_id(s, packet.a[0]), shared_id(s, packet.b[0]));
}

template <class Work>
void for_movable(const ContactPacket& packet, const ContactScratch& s, Work&& work) {
    for (std::size_t lane = 0; lane < at(packet.num_pairs); ++lane)
        for (const std::int32_t body : {packet.a[lane], packet.b[lane]})
            if (s.movable[at(body)] != 0) work(body);
}

std::int64_t num_rows(const ContactPacket& packet) { return packet.end - packet.first; }

} // namespace

DividedSweeps::DividedSweeps(Division& division, std::span<const ContactPacket> packets, ContactScratch& scratch)
    : division_(division), s_(scratch), packets_(packets), last_(at(division.size())) {
    find_owners();
    find_transfers();
    size_buffers();
}

void DividedSweeps::log() const {
    const std::int64_t begin = thread_ns();
    LoggedContacts contacts{{}, sweeps_, ns_, evaluations_, evaluation_ns_, sizeof(SentVelocity), impulse_bytes_};
    for (std::size_t p = 0; p < packets_.size(); ++p) {
        LoggedContacts::Packet& packet = contacts.packets.emplace_back();
        packet.color = static_cast<std::int32_t>(color_of_[p]);
        packet.payer = payer_of(packets_[p], s_);
        packet.rows = num_rows(packets_[p]);
        for_movable(packets_[p], s_, [&](std::int32_t body) { packet.bodies.push_back(s_.bodies[at(body)]); });
    }
    division_.log()->sections.emplace_back(std::move(contacts));
    division_.log()->own_ns += thread_ns() - begin;
}

DividedSweeps::~DividedSweeps() {
    if (division_.log() != nullptr) log();
    std::int64_t rows = 0;
    for (const auto& run : runs_)
        for (const ContactPacket& packet : run) rows += num_rows(packet);
    if (rows == 0) return;
    for (const auto& run : runs_)
        for (const ContactPacket& packet : run) division_.add_cost(payer_of(packet, s_), ns_ * num_rows(packet) / rows);
}

void DividedSweeps::find_owners() {
    int before = -1;
    for (std::size_t p = 0; p < packets_.size(); ++p) {
        if (p == 0 || packets_[p].color != packets_[p - 1].color) {
            colors_.emplace_back().first_run = runs_.size();
            before = -1;
        }
        color_of_.push_back(colors_.size() - 1);
        const std::int32_t payer = payer_of(packets_[p], s_);
        const int owner = payer < 0 ? 0 : division_.owner(payer);
        owner_.push_back(owner);
        if (owner == division_.rank()) {
            if (before == owner)
                runs_.back() = {runs_.back().data(), runs_.back().size() + 1};
            else
                runs_.push_back(packets_.subspan(p, 1));
        }
        before = owner;
        colors_.back().end_run = runs_.size();
    }
}

/// Backwards through the packets, with the rank of the next one that each body is in.
void DividedSweeps::find_transfers() {
    const int rank = division_.rank();
    std::vector<std::int32_t> next(s_.bodies.size(), -1);
    std::vector<Transfer> out, in;
    for (std::size_t p = packets_.size(); p-- > 0;) {
        const int owner = owner_[p];
        for_movable(packets_[p], s_, [&](std::int32_t body) {
            const std::int32_t user = std::exchange(next[at(body)], owner);
            if (user < 0) last_[at(owner)].push_back(body);
            if (user < 0 || user == owner) return;
            if (owner == rank) out.push_back({color_of_[p], user, body});
            if (user == rank) in.push_back({color_of_[p], owner, body});
        });
    }
    const auto order = [](const Transfer& x, const Transfer& y) {
        return std::tie(x.color, x.partner, x.body) < std::tie(y.color, y.partner, y.body);
    };
    std::sort(out.begin(), out.end(), order);
    std::sort(in.begin(), in.end(), order);
    prepare(out, in);
}

void DividedSweeps::prepare(std::span<const Transfer> out, std::span<const Transfer> in) {
    const auto of = [](std::span<const Transfer> all, std::size_t color) {
        const auto first_from = [&](std::size_t c) {
            return std::partition_point(all.begin(), all.end(), [&](const Transfer& t) { return t.color < c; });
        };
        return std::span<const Transfer>(first_from(color), first_from(color + 1));
    };
    const auto fill = [](std::span<const Transfer> transfers, std::vector<std::int32_t>& bodies,
                         std::vector<SentVelocity>& buffer) {
        std::vector<RankMessage> messages;
        buffer.resize(transfers.size());
        std::size_t begin = 0;
        for (std::size_t k = 0; k < transfers.size(); ++k) {
            bodies.push_back(transfers[k].body);
            if (k + 1 < transfers.size() && transfers[k + 1].partner == transfers[k].partner) continue;
            messages.push_back(
                {transfers[k].partner, std::as_writable_bytes(std::span(buffer).subspan(begin, k + 1 - begin))});
            begin = k + 1;
        }
        return messages;
    };
    for (std::size_t c = 0; c < colors_.size(); ++c) {
        Color& color = colors_[c];
        const auto sends = fill(of(out, c), color.out, color.sent),
                   receives = fill(of(in, c), color.in, color.received);
        if (!sends.empty() || !receives.empty()) color.exchange = division_.ranks().prepare(sends, receives);
    }
}

std::span<const std::span<const ContactPacket>> DividedSweeps::own(std::size_t color) const {
    const Color& c = colors_[color];
    return std::span(runs_).subspan(c.first_run, c.end_run - c.first_run);
}

void DividedSweeps::hand_on(std::size_t color) {
    Color& c = colors_[color];
    if (c.exchange == nullptr) return;
    for (std::size_t k = 0; k < c.out.size(); ++k) c.sent[k] = sent(c.out[k]);
    c.exchange->run();
    for (std::size_t k = 0; k < c.in.size(); ++k) take(c.in[k], c.received[k]);
}

/// Room for what share_velocities() says: by rank its value, and linear and angular velocities of its last bodies.
void DividedSweeps::size_buffers() {
    std::size_t all = 0;
    for (const auto& bodies : last_) {
        sizes_.push_back(sizeof(double) + bodies.size() * sizeof(SentVelocity));
        all += sizes_.back();
    }
    own_.resize(sizes_[at(division_.rank())]);
    told_.resize(all);
}

DividedSweeps::SentVelocity DividedSweeps::sent(std::int32_t body) const {
    return {s_.velocity[at(body)].linear, s_.velocity[at(body)].angular};
}

void DividedSweeps::take(std::int32_t body, const SentVelocity& velocity) {
    s_.velocity[at(body)].linear = velocity.linear;
    s_.velocity[at(body)].angular = velocity.angular;
}

double DividedSweeps::share_velocities(double worst) {
    std::byte* to = own_.data();
    std::memcpy(to, &worst, sizeof worst);
    to += sizeof worst;
    for (const std::int32_t body : last_[at(division_.rank())]) {
        const SentVelocity velocity = sent(body);
        std::memcpy(to, &velocity, sizeof velocity);
        to += sizeof velocity;
    }
    division_.ranks().gather(own_, sizes_, told_);
    const std::byte* from = told_.data();
    for (std::size_t rank = 0; rank < last_.size(); from += sizes_[rank++]) {
        if (rank == at(division_.rank())) continue;
        double of_rank = 0;
        std::memcpy(&of_rank, from, sizeof of_rank);
        worst = std::max(worst, of_rank);
        const std::byte* next = from + sizeof of_rank;
        for (const std::int32_t body : last_[rank]) {
            SentVelocity velocity;
            std::memcpy(&velocity, next, sizeof velocity);
            take(body, velocity);
            next += sizeof velocity;
        }
    }
    return worst;
}

double DividedSweeps::share_found(double residual, std::span<ContactPacket> packets, std::span<std::uint8_t> violated) {
    ByteWriter own;
    own.add(residual);
    for (std::size_t p = 0; p < packets.size(); ++p) {
        if (owner_[p] != division_.rank()) continue;
        own.add(violated[p]);
        own.add(static_cast<std::uint8_t>(packets[p].woken != 0 ? 1 : 0));
    }
    const GatheredBytes told = gather_bytes(division_.ranks(), own.take());
    for (int rank = 0; rank < division_.size(); ++rank) {
        auto in = reader_of(told.of(rank));
        double of_rank = 0;
        in.read(of_rank);
        residual = std::max(residual, of_rank);
        for (std::size_t p = 0; p < packets.size(); ++p) {
            if (owner_[p] != rank) continue;
            std::uint8_t woken = 0;
            in.read(violated[p]);
            in.read(woken);
            packets[p].woken = woken;
        }
    }
    return residual;
}

void DividedSweeps::share_impulses(PackedContacts& packed) {
    ByteWriter own;
    for (const auto& run : runs_)
        for (const ContactPacket& packet : run)
            for_impulses(packet, packed, [&](const Lanes& impulse) { own.add_bytes(impulse, sizeof impulse); });
    const GatheredBytes told = gather_bytes(division_.ranks(), own.take());
    impulse_bytes_ = told.all.size();
    for (int rank = 0; rank < division_.size(); ++rank) {
        if (rank == division_.rank()) continue;
        auto in = reader_of(told.of(rank));
        for (std::size_t p = 0; p < packets_.size(); ++p)
            if (owner_[p] == rank)
                for_impulses(packets_[p], packed, [&](Lanes& impulse) {
                    for (double& lane : impulse) in.read(lane);
                });
    }
}

void write_solved(ByteWriter& out, const ContactScratch::Island& island, ContactScratch& s) {
    out.add(island);
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) out.add(s.velocity[at(s.island_bodies[at(k)])]);
    for (std::int32_t p = island.first_packet; p < island.end_packet; ++p) {
        const ContactPacket& packet = s.packed.packets[at(p)];
        out.add(packet.woken);
        for_impulses(packet, s.packed, [&](const Lanes& impulse) { out.add_bytes(impulse, sizeof impulse); });
    }
}

} // namespace flotilla
