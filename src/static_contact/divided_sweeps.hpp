// SPDX-License-Identifier: MIT
// Sweeps divided among ranks (parallel/division.hpp).
//
// Every rank has the rows of all packets, and changes the impulses of its own ones alone: a packet is its owner's in
// every set that it is swept in. Packets of one colour touch different movable bodies; so a rank sweeps its own packets
// of a colour, hands on the velocities of those of their bodies whose next packet in the sweep is another rank's, and
// takes in those that come to it. After the last colour all velocities are told to all, with the largest violation met:
// what happens between sweeps every rank does by itself.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "parallel/division.hpp"
#include "static_contact/solver_state.hpp"

namespace flotilla {

class DividedSweeps {
  public:
    /// Of packets in the order of sweeps; the bodies are those of the scratch.
    DividedSweeps(Division& division, std::span<const ContactPacket> packets, ContactScratch& scratch);
    /// Counts what its sweeps cost.
    ~DividedSweeps();
    DividedSweeps(const DividedSweeps&) = delete;
    DividedSweeps& operator=(const DividedSweeps&) = delete;

    [[nodiscard]] std::size_t num_colors() const { return colors_.size(); }
    /// This rank's packets, as stretches of the packets; of the k-th colour, and of all.
    [[nodiscard]] std::span<const std::span<const ContactPacket>> own(std::size_t color) const;
    [[nodiscard]] std::span<const std::span<const ContactPacket>> own() const { return runs_; }

    /// After this rank's packets of a colour.
    void hand_on(std::size_t color);
    /// After the last colour. Returns the largest of all ranks' values.
    double share_velocities(double worst);
    /// After an evaluation: what was found of the packets, which are those of the constructor, and which are woken.
    /// Returns the largest of all ranks' residuals.
    double share_found(double residual, std::span<ContactPacket> packets, std::span<std::uint8_t> violated);
    /// After the last sweep: the impulses that the rows hold.
    void share_impulses(PackedContacts& packed);

    [[nodiscard]] std::int64_t clock() const { return division_.clock(); }
    /// Of this rank's packets, in a sweep and in an evaluation.
    void add_sweep(std::int64_t ns) { ++sweeps_, ns_ += ns; }
    void add_evaluation(std::int64_t ns) { ++evaluations_, evaluation_ns_ += ns; }

  private:
    struct SentVelocity {
        Vec3 linear, angular;
    };
    struct Color {
        std::size_t first_run = 0, end_run = 0;
        std::vector<std::int32_t> out, in; ///< bodies, by partner
        std::vector<SentVelocity> sent, received;
        std::unique_ptr<RankExchange> exchange; ///< null: nothing is handed on
    };
    struct Transfer {
        std::size_t color;
        int partner;
        std::int32_t body;
    };

    void find_owners();
    void find_transfers();
    void size_buffers();
    [[nodiscard]] SentVelocity sent(std::int32_t body) const;
    void take(std::int32_t body, const SentVelocity& velocity);
    void log() const;
    void prepare(std::span<const Transfer> out, std::span<const Transfer> in);

    Division& division_;
    ContactScratch& s_;
    std::span<const ContactPacket> packets_;
    std::vector<std::int32_t> owner_; ///< by packet
    std::vector<std::span<const ContactPacket>> runs_;
    std::vector<Color> colors_;
    std::vector<std::size_t> color_of_;           ///< by packet, the place in colors_
    std::vector<std::vector<std::int32_t>> last_; ///< bodies whose last packet is a rank's, by rank
    std::vector<std::size_t> sizes_;              ///< by rank, of what it tells after a sweep
    std::vector<std::byte> own_, told_;

    std::int64_t sweeps_ = 0, ns_ = 0, evaluations_ = 0, evaluation_ns_ = 0;
    std::size_t impulse_bytes_ = 0;
};

/// Of an island that one rank has solved: what the others have to know.
void write_solved(ByteWriter& out, const ContactScratch::Island& island, ContactScratch& scratch);
template <class Reader>
void read_solved(Reader& in, ContactScratch::Island& island, ContactScratch& scratch);

/// Calls work(field) for every impulse that the rows of a packet hold, four of a row's lanes at a time.
template <class Work>
void for_impulses(const ContactPacket& packet, PackedContacts& packed, Work&& work) {
    const auto rows = [&](std::int32_t first, std::int32_t end) {
        for (auto r = static_cast<std::size_t>(first); r < static_cast<std::size_t>(end); ++r) {
            Lanes* field = packed.frictionless ? packed.normal_rows[r].field : packed.rows[r].field;
            work(field[PacketRow::kNormalImpulse]);
            if (packed.frictionless) continue;
            for (int c = 0; c < 2; ++c) work(field[PacketRow::kTangentImpulse + c]);
        }
    };
    rows(packet.first, packet.end);
    rows(packet.first_parked, packet.end_parked);
}

template <class Reader>
void read_solved(Reader& in, ContactScratch::Island& island, ContactScratch& s) {
    in.read(island);
    for (std::int32_t k = island.first_body; k < island.end_body; ++k)
        in.read(s.velocity[static_cast<std::size_t>(s.island_bodies[static_cast<std::size_t>(k)])]);
    for (std::int32_t p = island.first_packet; p < island.end_packet; ++p) {
        ContactPacket& packet = s.packed.packets[static_cast<std::size_t>(p)];
        in.read(packet.woken);
        for_impulses(packet, s.packed, [&](Lanes& impulse) {
            for (double& lane : impulse) in.read(lane);
        });
    }
}

} // namespace flotilla
