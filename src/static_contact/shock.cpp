// SPDX-License-Identifier: MIT
#include "static_contact/shock.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "static_contact/assemble.hpp"
#include "static_contact/island_energy.hpp"

namespace flotilla {
namespace {

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

// The tangential bounds of PGS become constants; W is that of the masses the level sees.
ContactRow shock_row(const ContactBlock& block, const ContactRow& row) {
    ContactRow r = row;
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

// Copies the blocks of one level, with the bodies below it frozen. A block with a body of infinite mass is its own copy.
void copy_level(std::span<const std::int32_t> level_blocks, ContactScratch& s) {
    s.shock_blocks.clear();
    s.shock_rows.clear();
    for (const std::int32_t k : level_blocks) {
        const ContactBlock& old = s.blocks[index(k)];
        const std::int32_t level_a = s.level[index(old.a)], level_b = s.level[index(old.b)];
        ContactBlock block = freeze(old, level_a < level_b, level_b < level_a);
        block.first = static_cast<std::int32_t>(s.shock_rows.size());
        for (std::int32_t i = old.first; i < old.end; ++i) s.shock_rows.push_back(shock_row(block, s.rows[index(i)]));
        block.end = static_cast<std::int32_t>(s.shock_rows.size());
        s.shock_blocks.push_back(block);
    }
}

// A level of bodies that touch at many points may have no solution with what lies below it frozen; its sweeps end where the
// violation they meet fell by less than a fifth in twenty of them.
constexpr int kPatience = 20;
constexpr double kLeastFall = 0.8;

// Returns the number of visits.
std::int64_t solve_level(const ContactSolveOptions& options, double tolerance, ContactScratch& s) {
    s.shock_packed.clear();
    pack(s.shock_blocks, s.shock_rows, s.shock_packed);
    const SweepView view{.packets = s.shock_packed.packets.data(),
                         .num_packets = static_cast<std::int64_t>(s.shock_packed.packets.size()),
                         .rows = s.shock_packed.rows.data(),
                         .bodies = s.velocity.data()};
    int sweeps = 0;
    double before = std::numeric_limits<double>::infinity();
    while (sweeps < options.shock_iterations) {
        const double violation = sweep(Cone::frozen, view, options.isa);
        ++sweeps;
        if (violation <= tolerance) break;
        if (sweeps % kPatience != 0) continue;
        if (violation > kLeastFall * before) break;
        before = violation;
    }
    return static_cast<std::int64_t>(sweeps) * static_cast<std::int64_t>(s.shock_rows.size());
}

void restore(const ContactScratch::Island& island, ContactScratch& s) {
    for (std::int32_t k = island.first; k < island.end; ++k)
        for (const std::int32_t body : {s.blocks[index(k)].a, s.blocks[index(k)].b})
            s.velocity[index(body)] = s.before_shock[index(body)];
}

std::int32_t block_level(const ContactBlock& block, const ContactScratch& s) {
    return std::max(s.level[index(block.a)], s.level[index(block.b)]);
}

// Fills level_order with the island's blocks by level; inside a level they stay in colour order. Returns the number of levels.
std::int32_t order_by_level(const ContactScratch::Island& island, ContactScratch& s) {
    s.level_order.resize(index(island.end - island.first));
    std::iota(s.level_order.begin(), s.level_order.end(), island.first);
    s.level_of_block.resize(s.blocks.size());
    std::int32_t top = 0;
    for (const std::int32_t k : s.level_order) {
        s.level_of_block[index(k)] = block_level(s.blocks[index(k)], s);
        top = std::max(top, s.level_of_block[index(k)]);
    }
    stable_sort_by_key(s.level_of_block, top + 1, s.level_order, s.counts, s.sorted);
    return top + 1;
}

void run_levels(ContactScratch::Island& island, const ContactSolveOptions& options, ContactScratch& s) {
    // Bodies move with what is left in the levels below them: the sum may reach the tolerance, not each term.
    const double tolerance = options.tolerance / order_by_level(island, s);
    for (std::size_t first = 0, end = 0; first < s.level_order.size(); first = end) {
        const std::int32_t level = s.level_of_block[index(s.level_order[first])];
        while (end < s.level_order.size() && s.level_of_block[index(s.level_order[end])] == level) ++end;
        copy_level(std::span(s.level_order).subspan(first, end - first), s);
        island.visits += solve_level(options, tolerance, s);
    }
}

} // namespace

bool propagate_shock(ContactScratch::Island& island, const ContactBodies& bodies, const ContactSolveOptions& options,
                     ContactScratch& scratch) {
    // Every body of an island has a path to infinite mass or none has.
    if (scratch.level[index(scratch.blocks[index(island.first)].a)] < 0) return false;
    run_levels(island, options, scratch);
    if (prescribed_at_rest(island, scratch) &&
        kinetic_energy(island, bodies, scratch) > std::max(island.energy_before, island.energy_pgs)) {
        restore(island, scratch);
        return false;
    }
    return true;
}

} // namespace flotilla
