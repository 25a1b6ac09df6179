// SPDX-License-Identifier: MIT
#include "static_contact/shock.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "static_contact/assemble.hpp"
#include "static_contact/island_energy.hpp"
#include "static_contact/packet_shares.hpp"
#include "static_contact/sweep_island.hpp"

namespace flotilla {
namespace {

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

Cone cone_of(const ContactScratch& s) { return s.packed.frictionless ? Cone::none : Cone::frozen; }

// The tangential bounds of PGS become constants; W is that of the masses the level sees.
ContactRow shock_row(Cone cone, const ContactBlock& block, const ContactRow& row) {
    ContactRow r = row;
    if (cone == Cone::none) {
        set_normal_mass(block, r);
        return r;
    }
    r.local.friction = std::max(row.local.friction * row.local.impulse.x,
                                std::max(std::abs(row.local.impulse.y), std::abs(row.local.impulse.z)));
    set_effective_mass(block, r);
    return r;
}

ContactBlock freeze(ContactBlock block, bool a, bool b) {
    if (a) {
        block.inv_mass_a = 0;
        block.inv_inertia_a = {};
    }
    if (b) {
        block.inv_mass_b = 0;
        block.inv_inertia_b = {};
    }
    return block;
}

// A level of bodies that touch at many points may have no solution with what lies below it frozen; its sweeps end where the
// violation they meet fell by less than a fifth in twenty of them.
constexpr int kPatience = 20;
constexpr double kLeastFall = 0.8;
constexpr std::size_t kBlockGrain = 32; // body pairs of a task

void restore(const ContactScratch::Island& island, ContactScratch& s) {
    for (std::int32_t k = island.first; k < island.end; ++k)
        for (const std::int32_t body : {s.blocks[index(k)].a, s.blocks[index(k)].b})
            s.velocity[index(body)] = s.before_shock[index(body)];
}

std::int32_t block_level(const ContactBlock& block, const ContactScratch& s) {
    return std::max(s.level[index(block.a)], s.level[index(block.b)]);
}

// Fills level_order with the island's blocks by level, in a level by colour, and those with equally many contacts together (see
// order_pairs in assemble.cpp). Returns the number of levels.
std::int32_t order_by_level(const ContactScratch::Island& island, ContactScratch& s) {
    s.level_order.resize(index(island.end - island.first));
    std::iota(s.level_order.begin(), s.level_order.end(), island.first);
    s.level_of_block.resize(s.blocks.size());
    const auto order_by = [&](auto&& key) {
        std::int32_t top = 0;
        for (const std::int32_t k : s.level_order)
            top = std::max(top, s.level_of_block[index(k)] = key(s.blocks[index(k)]));
        stable_sort_by_key(s.level_of_block, top + 1, s.level_order, s.counts, s.sorted);
        return top + 1;
    };
    order_by([](const ContactBlock& block) { return block.end - block.first; });
    order_by([](const ContactBlock& block) { return block.color; });
    return order_by([&](const ContactBlock& block) { return block_level(block, s); });
}

// Copies the blocks [first, end) of level_order, one level, with the bodies below frozen. A block with a body of infinite mass is its
// own copy.
void copy_level(std::int32_t first, std::int32_t end, const ContactSolveOptions& options, ContactScratch& s) {
    const std::size_t n = index(end - first);
    s.shock_blocks.resize(n);
    std::int32_t rows = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const ContactBlock& old = s.blocks[index(s.level_order[index(first) + i])];
        const std::int32_t level_a = s.level[index(old.a)], level_b = s.level[index(old.b)];
        ContactBlock& block = s.shock_blocks[i] = freeze(old, level_a < level_b, level_b < level_a);
        block.first = rows;
        block.parked = block.end = rows += old.end - old.first; // frozen levels move the others as they like
    }
    s.shock_rows.resize(index(rows));
    for_each(options.team, "shock rows", n, kBlockGrain, [&](std::size_t i) {
        const ContactBlock& block = s.shock_blocks[i];
        const std::int32_t old = s.blocks[index(s.level_order[index(first) + i])].first;
        for (std::int32_t k = 0; k < block.end - block.first; ++k)
            s.shock_rows[index(block.first + k)] = shock_row(cone_of(s), block, s.rows[index(old + k)]);
    });
}

// Lays the copies out as packets, by colour.
void pack_level(const ContactSolveOptions& options, ContactScratch& s) {
    s.shock_packed.clear();
    s.shock_packed.frictionless = s.packed.frictionless;
    s.shock_groups.clear();
    lay_out_packets(s.shock_blocks, 0, static_cast<std::int32_t>(s.shock_blocks.size()), s.shock_packed,
                    s.shock_groups);
    resize_rows(s.shock_packed);
    for_each(options.team, "pack shock", s.shock_packed.packets.size(), kBlockGrain,
             [&](std::size_t p) { fill_packet(s.shock_blocks, s.shock_rows, p, s.shock_packed); });
}

/// The sweeps of one level, in shares for several threads (see sweep_island.cpp).
class LevelSweeps {
  public:
    LevelSweeps(const ContactSolveOptions& options, double tolerance, int threads, ContactScratch& s)
        : options_(options),
          tolerance_(tolerance),
          threads_(threads),
          s_(s),
          seen_(threads > 1 ? std::span(s.seen) : std::span(&alone_, 1)),
          recorder_(options.team != nullptr ? options.team->recorder() : nullptr) {
        if (recorder_ != nullptr) busy_.assign(index(threads) * s.shock_groups.size(), 0);
    }

    void run() {
        double before = std::numeric_limits<double>::infinity();
        while (sweeps_ < options_.shock_iterations) {
            violation_ = sweep_groups();
            ++sweeps_;
            if (violation_ <= tolerance_) break;
            if (sweeps_ % kPatience != 0) continue;
            if (violation_ > kLeastFall * before) break;
            before = violation_;
        }
    }
    void record(std::int32_t region) const {
        for (std::size_t g = 0; g < s_.shock_groups.size(); ++g) {
            GroupSpan span{region, packets_of(g).num_tasks(), sweeps_, 0};
            for (std::size_t t = 0; t < index(threads_); ++t) span.busy += busy_[t * s_.shock_groups.size() + g];
            recorder_->add_group(span);
        }
    }
    [[nodiscard]] std::int64_t visits() const { return sweeps_ * static_cast<std::int64_t>(s_.shock_rows.size()); }
    [[nodiscard]] double violation() const {
        return violation_;
    } ///< m/s, largest of the last sweep, each row's at its turn
    /// m/s, largest that the sweeps left.
    [[nodiscard]] double residual() {
        return largest_of(1, [&](std::size_t, int thread) {
            const std::span<const ContactPacket> all = s_.shock_packed.packets;
            return largest_violation(cone_of(s_), view_of(share_of(all, thread, threads_)), options_.isa);
        });
    }

  private:
    double sweep_groups() {
        return largest_of(s_.shock_groups.size(), [&](std::size_t g, int thread) {
            const std::int64_t begin = recorder_ != nullptr ? recorder_->now() : 0;
            const double worst = sweep(cone_of(s_), view_of(packets_of(g).share(thread, threads_)), options_.isa);
            if (recorder_ != nullptr) busy_[index(thread) * s_.shock_groups.size() + g] += recorder_->now() - begin;
            return worst;
        });
    }
    /// Of what found(phase, share) returns.
    template <class Found>
    double largest_of(std::size_t phases, Found&& found) {
        for (auto& seen : seen_) seen.worst = 0;
        for_phases(options_.team, threads_, phases, [&](std::size_t phase, int thread) {
            double& worst = seen_[index(thread)].worst;
            worst = std::max(worst, found(phase, thread));
        });
        double out = 0;
        for (const auto& seen : seen_) out = std::max(out, seen.worst);
        return out;
    }
    [[nodiscard]] SweepView view_of(std::span<const ContactPacket> packets) const {
        return {.packets = packets.data(),
                .num_packets = static_cast<std::int64_t>(packets.size()),
                .rows = s_.shock_packed.rows.data(),
                .normal_rows = s_.shock_packed.normal_rows.data(),
                .bodies = s_.velocity.data()};
    }
    [[nodiscard]] GroupPackets packets_of(std::size_t group) const {
        const std::span<const ContactPacket> all = s_.shock_packed.packets;
        return flotilla::packets_of(s_.shock_groups, group, static_cast<std::int32_t>(all.size()), all);
    }

    const ContactSolveOptions& options_;
    double tolerance_;
    int threads_;
    ContactScratch& s_;
    ContactScratch::Seen alone_;
    std::span<ContactScratch::Seen> seen_; ///< by thread
    TaskRecorder* recorder_;
    int sweeps_ = 0;
    double violation_ = 0;
    std::vector<std::int64_t> busy_; ///< ns, by thread and group
};

/// Violations of a level's contacts, m/s.
struct LevelLeft {
    double last_sweep = 0, residual = 0;
};

// Sweeps the level that was packed. `together`: on the whole team.
LevelLeft sweep_level(ContactScratch::Island& island, const ContactSolveOptions& options, double tolerance,
                      bool together, ContactScratch& s) {
    const auto width = [&](int most) {
        const auto end = static_cast<std::int32_t>(s.shock_packed.packets.size());
        return sweep_width_of(s.shock_groups, end, s.shock_packed.packets, most);
    };
    const int threads = together ? width(options.team->present()) : 1;
    if (threads > 1) s.seen.assign(index(threads), {});
    LevelSweeps sweeps(options, tolerance, threads, s);
    TaskRecorder* recorder = together ? options.team->recorder() : nullptr;
    const std::int32_t region = recorder != nullptr
                                    ? recorder->begin_region("shock sweeps", RegionKind::sweeps,
                                                             width(std::numeric_limits<int>::max()), nullptr)
                                    : -1;
    sweeps.run();
    if (recorder != nullptr) {
        sweeps.record(region);
        recorder->end_region(region);
    }
    island.visits += sweeps.visits();
    return {sweeps.violation(), sweeps.residual()};
}

// Solves level by level; false, and no further, where a level of a resting island ends above the tolerance. What one level leaves stays:
// those above do not move its bodies.
bool solve_levels(ContactScratch::Island& island, const ContactSolveOptions& options, double& residual,
                  ContactScratch& s) {
    // Bodies move with what is left in the levels below them: the sum may reach the tolerance, not each term.
    const double tolerance = options.tolerance / order_by_level(island, s);
    const bool together = options.team != nullptr && is_large(island, s);
    const auto n = static_cast<std::int32_t>(s.level_order.size());
    const auto level_of = [&](std::int32_t i) { return s.level_of_block[index(s.level_order[index(i)])]; };
    for (std::int32_t first = 0, end = 0; first < n; first = end) {
        while (end < n && level_of(end) == level_of(first)) ++end;
        copy_level(first, end, options, s);
        pack_level(options, s);
        const LevelLeft left = sweep_level(island, options, tolerance, together, s);
        if (island.rests && left.last_sweep > options.tolerance) return false;
        residual = std::max(residual, left.residual);
    }
    return true;
}

} // namespace

bool propagate_shock(ContactScratch::Island& island, const ContactBodies& bodies, const ContactSolveOptions& options,
                     ContactScratch& scratch) {
    // Every body of an island has a path to infinite mass or none has.
    if (scratch.level[index(scratch.blocks[index(island.first)].a)] < 0) return false;
    double residual = 0;
    const bool solved = solve_levels(island, options, residual, scratch);
    const auto adds_energy = [&] {
        return prescribed_at_rest(island, scratch) &&
               kinetic_energy(island, bodies, scratch) > std::max(island.energy_before, island.energy_pgs);
    };
    if (solved && !adds_energy()) {
        island.residual = residual;
        return true;
    }
    restore(island, scratch);
    return false;
}

} // namespace flotilla
