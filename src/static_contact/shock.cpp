// SPDX-License-Identifier: MIT
#include "static_contact/shock.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/index.hpp"
#include "static_contact/assemble.hpp"
#include "static_contact/island_energy.hpp"
#include "static_contact/sweep_engine.hpp"
#include "static_contact/sweep_island.hpp"

namespace flotilla {
namespace {

Cone cone_of(const ContactScratch& s) { return s.packed.frictionless ? Cone::none : Cone::frozen; }

// The tangential bounds of PGS become constants; W is that of the masses the level sees.
ContactRow shock_row(Cone cone, Cone of_island, const ContactBlock& block, const ContactRow& row) {
    ContactRow r = row;
    const bool locked = (block.locked_a | block.locked_b) != 0;
    if (cone == Cone::none) {
        locked ? set_locked_mass(cone, block, r) : set_normal_mass(block, r);
        return r;
    }
    r.local.friction = std::max(friction_bound(of_island, row.local.friction, row.local.impulse.x),
                                std::max(std::abs(row.local.impulse.y), std::abs(row.local.impulse.z)));
    locked ? set_locked_mass(cone, block, r) : set_effective_mass(block, r);
    r.local.impulse = row.local.impulse;
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

constexpr std::size_t kBlockGrain = 32; // body pairs of a task

void restore(const ContactScratch::Island& island, ContactScratch& s) {
    for (std::int32_t k = island.first; k < island.end; ++k)
        for (const std::int32_t body : {s.blocks[at(k)].a, s.blocks[at(k)].b})
            s.velocity[at(body)] = s.before_shock[at(body)];
}

std::int32_t block_level(const ContactBlock& block, const ContactScratch& s) {
    return std::max(s.level[at(block.a)], s.level[at(block.b)]);
}

// Fills level_order with the island's blocks by level, in a level by colour, and those with equally many contacts
// together (see order_pairs in assemble.cpp). Returns the number of levels.
std::int32_t order_by_level(const ContactScratch::Island& island, ContactScratch& s) {
    s.level_order.resize(at(island.end - island.first));
    std::iota(s.level_order.begin(), s.level_order.end(), island.first);
    s.level_of_block.resize(s.blocks.size());
    const auto order_by = [&](auto&& key) {
        std::int32_t top = 0;
        for (const std::int32_t k : s.level_order) top = std::max(top, s.level_of_block[at(k)] = key(s.blocks[at(k)]));
        stable_sort_by_key(s.level_of_block, top + 1, s.level_order, s.counts, s.sorted);
        return top + 1;
    };
    order_by([](const ContactBlock& block) { return block.end - block.first; });
    order_by([](const ContactBlock& block) { return block.color; });
    return order_by([&](const ContactBlock& block) { return block_level(block, s); });
}

// Copies the blocks [first, end) of level_order, one level, with the bodies below frozen. A block with a body of
// infinite mass is its own copy.
void copy_level(std::int32_t first, std::int32_t end, const ContactSolveOptions& options, ContactScratch& s) {
    const std::size_t n = at(end - first);
    s.shock_blocks.resize(n);
    std::int32_t rows = 0;
    for (std::size_t i = 0; i < n; ++i) {
        const ContactBlock& old = s.blocks[at(s.level_order[at(first) + i])];
        const std::int32_t level_a = s.level[at(old.a)], level_b = s.level[at(old.b)];
        ContactBlock& block = s.shock_blocks[i] = freeze(old, level_a < level_b, level_b < level_a);
        block.first = rows;
        block.parked = block.end = rows += old.end - old.first; // frozen levels move the others as they like
    }
    s.shock_rows.resize(at(rows));
    for_each(options.team, "shock rows", n, kBlockGrain, [&](std::size_t i) {
        const ContactBlock& block = s.shock_blocks[i];
        const std::int32_t old = s.blocks[at(s.level_order[at(first) + i])].first;
        for (std::int32_t k = 0; k < block.end - block.first; ++k)
            s.shock_rows[at(block.first + k)] = shock_row(cone_of(s), cone_of(options, s), block, s.rows[at(old + k)]);
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
    resize_extras(s.packed.any_extras, s.shock_packed);
    for_each(options.team, "pack shock", s.shock_packed.packets.size(), kBlockGrain,
             [&](std::size_t p) { fill_packet(s.shock_blocks, s.shock_rows, p, s.shock_packed); });
}

/// Violations of a level's contacts, m/s.
struct LevelLeft {
    double last_sweep = 0; ///< each row's at its turn
    double residual = 0;   ///< that the sweeps left
};

// Sweeps the level that was packed. `together`: on the whole team.
LevelLeft sweep_level(ContactScratch::Island& island, const ContactSolveOptions& options, bool together,
                      ContactScratch& s) {
    const std::span<const ContactPacket> packets = s.shock_packed.packets;
    const auto end = static_cast<std::int32_t>(packets.size());
    const auto width = [&](int most) { return sweep_width_of(s.shock_groups, end, most); };
    Sharing sharing(together ? options.team : nullptr, "shock sweeps", width, s.shock_groups.size() + 2, s);
    SweepEngine engine({.view = {.rows = s.shock_packed.rows.data(),
                                 .normal_rows = s.shock_packed.normal_rows.data(),
                                 .extras = s.shock_packed.extras_if_any(),
                                 .bodies = s.velocity.data()},
                        .packets = packets,
                        .end = end,
                        .groups = s.shock_groups},
                       sharing.crew(), cone_of(s), options, s);
    LevelLeft left;
    double before = std::numeric_limits<double>::infinity();
    const int sweeps = engine.run(options.shock_iterations, [&](int done, double worst) {
        left.last_sweep = worst;
        if (worst <= options.tolerance) return AfterSweep::done;
        if (done % options.tuning.level_patience != 0) return AfterSweep::go_on;
        if (worst > options.tuning.least_fall * before) return AfterSweep::done;
        before = worst;
        return AfterSweep::go_on;
    });
    island.visits += sweeps * static_cast<std::int64_t>(s.shock_rows.size());
    if (DividedSweeps* divided = engine.divided()) {
        for (const auto& own : divided->own())
            left.residual = std::max(left.residual, largest_violation(engine.cone(), engine.view(own), options.isa));
        left.residual = divided->share_velocities(left.residual);
        return left;
    }
    const std::size_t look = engine.evaluation_group();
    left.residual = engine.largest(1, [&](std::size_t, int share) {
        double worst = 0;
        engine.timed(share, look, [&] {
            worst = largest_violation(engine.cone(), engine.view(share_of(packets, share, engine.crew().shares)),
                                      options.isa);
        });
        return worst;
    });
    sharing.record().end([&](std::size_t g) {
        if (g < engine.num_groups()) return engine.span_of(g, sweeps);
        const std::int64_t looks = g == look ? 1 + SweepShares::kPreparations : 0;
        return GroupSpan{.tasks = end, .visits = looks, .barriers = looks};
    });
    return left;
}

// Solves level by level; false, and no further, where a level of a resting island ends above the tolerance. What one
// level leaves stays: those above do not move its bodies.
bool solve_levels(ContactScratch::Island& island, const ContactSolveOptions& options, double& residual,
                  ContactScratch& s) {
    // Bodies move with what is left in the levels below them: the sum may reach the tolerance, not each term.
    ContactSolveOptions of_level = options;
    of_level.tolerance /= order_by_level(island, s);
    const bool together = options.team != nullptr && is_large(island, s);
    const auto n = static_cast<std::int32_t>(s.level_order.size());
    const auto level_of = [&](std::int32_t i) { return s.level_of_block[at(s.level_order[at(i)])]; };
    for (std::int32_t first = 0, end = 0; first < n; first = end) {
        while (end < n && level_of(end) == level_of(first)) ++end;
        copy_level(first, end, options, s);
        pack_level(options, s);
        const LevelLeft left = sweep_level(island, of_level, together, s);
        if (island.rests && left.last_sweep > options.tolerance) return false;
        residual = std::max(residual, left.residual);
    }
    return true;
}

/// What of the impulse a contact with normal `n`, towards what it pushes, can give. `friction`: as LocalContact has it.
Vec3 nearest_in_cone(const Vec3& n, double friction, const Vec3& impulse) {
    const double normal = dot(n, impulse);
    const Vec3 along = impulse - normal * n;
    const double size = length(along);
    if (friction < 0) return std::max(0.0, normal) * n + (size > -friction ? -friction / size : 1.0) * along;
    if (size <= friction * normal) return impulse;
    if (friction * size <= -normal) return {};
    const double pressure = (normal + friction * size) / (1 + friction * friction);
    return pressure * n + (size > 0 ? friction * pressure / size : 0.0) * along;
}

/// Whether contacts with bodies of infinite mass can have given the island the momentum by which the pass changed it.
/// A frozen body takes any from what slides on it, and hands none on: a stack that slides would stand still.
/// The impulses nearest to that momentum are found contact after contact.
bool ground_gives(const ContactScratch::Island& island, Tangents tangents, ContactScratch& s) {
    constexpr double kLeft = 0x1p-8, kLeastFall = 0.99; // of the momentum; of what is left, by a round
    constexpr int kRounds = 100;
    const double of_pyramid = tangents == Tangents::random ? std::numbers::sqrt2 : 1; // in its corners
    Vec3 momentum;
    for (std::int32_t k = island.first_body; k < island.end_body; ++k) {
        const std::size_t body = at(s.island_bodies[at(k)]);
        momentum += s.weight[body].linear * (s.velocity[body].linear - s.start_velocity[body].linear);
    }
    const std::span<const ContactBlock> blocks =
        std::span(s.blocks).subspan(at(island.first), at(island.end - island.first));
    const auto locks = [](const ContactBlock& block) { return (block.locked_a | block.locked_b) != 0; };
    if (std::any_of(blocks.begin(), blocks.end(), locks)) return true; // what locks give is not known
    s.ground_impulses.resize(s.rows.size());
    std::fill(s.ground_impulses.begin() + blocks.front().first, s.ground_impulses.begin() + blocks.back().end, Vec3{});
    Vec3 left = momentum;
    for (int round = 0; round < kRounds; ++round) {
        const double before = length(left);
        for (const ContactBlock& block : blocks) {
            if (s.movable[at(block.a)] == s.movable[at(block.b)]) continue;
            for (std::int32_t r = block.first; r < block.end; ++r) {
                const ContactRow& row = s.rows[at(r)];
                const Vec3 n = s.movable[at(block.b)] != 0 ? row.normal : -row.normal;
                const Vec3 wanted = s.ground_impulses[at(r)] + left;
                s.ground_impulses[at(r)] = nearest_in_cone(n, of_pyramid * row.local.friction, wanted);
                left = wanted - s.ground_impulses[at(r)];
            }
        }
        if (length(left) <= kLeft * length(momentum)) return true;
        if (length(left) > kLeastFall * before) return false;
    }
    return false;
}

} // namespace

bool propagate_shock(ContactScratch::Island& island, const ContactBodies& bodies, const ContactSolveOptions& options,
                     ContactScratch& scratch) {
    // Every body of an island has a path to infinite mass or none has.
    if (scratch.level[at(scratch.blocks[at(island.first)].a)] < 0) return false;
    double residual = 0;
    const bool solved = solve_levels(island, options, residual, scratch);
    const auto adds_energy = [&] {
        return prescribed_at_rest(island, scratch) && kinetic_energy(island, bodies, options.team, scratch) >
                                                          std::max(island.energy_before, island.energy_pgs);
    };
    if (solved && !adds_energy() && ground_gives(island, options.tangents, scratch)) {
        island.residual = residual;
        return true;
    }
    restore(island, scratch);
    return false;
}

} // namespace flotilla
