// SPDX-License-Identifier: MIT
#include "static_contact/assemble.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/assert.hpp"
#include "base/index.hpp"
#include "base/same_bits.hpp"
#include "parallel/compact.hpp"
#include "static_contact/tangents.hpp"

namespace flotilla {
namespace {

std::int32_t count_of(std::size_t n) { return static_cast<std::int32_t>(n); }

// Whether an impulse along the normal moves the body.
bool can_move(std::size_t id, const Contact& c, const ContactBodies& bodies) {
    if (!(bodies.inv_mass[id] > 0)) return false;
    if (bodies.locked_of(id) == 0) return true;
    const Vec3 turn = cross(point_on(c, static_cast<std::int32_t>(id)) - bodies.position[id], c.normal);
    const double mobility = bodies.inv_mass[id] * length_sq(free_part(bodies.locked_of(id), c.normal)) +
                            dot(turn, bodies.inv_inertia[id] * turn);
    return mobility > kLeastMobility * bodies.inv_mass[id];
}

constexpr std::size_t kContactGrain = 512, kBodyGrain = 64; // of a task

// The total order in which contacts are taken; input in that order already is the common case and is not sorted again.
// Also whether any of them has friction.
void order_contacts(std::span<const Contact> contacts, const ContactBodies& bodies, const ContactSolveOptions& options,
                    ContactScratch& s) {
    Team* team = options.team;
    enum : std::uint8_t { kMoves = 1, kInOrder = 2, kRubs = 4, kSlips = 8, kThin = 16 };
    const auto less = [&](std::size_t i, std::size_t j) {
        const Contact &x = contacts[i], &y = contacts[j];
        return std::tie(x.a, x.b, x.feature_key, i) < std::tie(y.a, y.b, y.feature_key, j);
    };
    s.look.resize(contacts.size());
    for_each(team, "look at contacts", contacts.size(), kContactGrain, [&](std::size_t k) {
        const Contact& c = contacts[k];
        FLOTILLA_ASSERT(0 <= c.a && c.a < c.b && at(c.b) < bodies.velocity.size());
        const bool moves = can_move(at(c.a), c, bodies) || can_move(at(c.b), c, bodies);
        s.look[k] = static_cast<std::uint8_t>(
            (moves ? kMoves : 0) | (k == 0 || less(k - 1, k) ? kInOrder : 0) | (moves && c.friction != 0 ? kRubs : 0) |
            (moves && c.slip != Vec3{} ? kSlips : 0) | (moves && c.across != Vec3{} ? kThin : 0));
    });
    const ListLoop loop{team, "order contacts", kContactGrain, s.places};
    const auto moves = [&](std::size_t k) { return (s.look[k] & kMoves) != 0; };
    s.order.clear();
    compact_if(loop, contacts.size(), moves, s.order, 0, count_of);
    s.packed.frictionless =
        options.normal_rows && std::ranges::none_of(s.look, [](std::uint8_t look) { return (look & kRubs) != 0; });
    const auto any = [&](std::uint8_t what) {
        return std::ranges::any_of(s.look, [&](std::uint8_t look) { return (look & what) != 0; });
    };
    s.any_extras = any(kThin) || (!s.packed.frictionless && any(kSlips));
    const auto in_order = [](std::uint8_t look) { return (look & kInOrder) != 0; };
    if (!std::ranges::all_of(s.look, in_order))
        std::ranges::sort(s.order, [&](std::int32_t i, std::int32_t j) { return less(at(i), at(j)); });
}

Sym3 symmetric(const Mat3& a) {
    return {.xx = a.m[0], .yy = a.m[4], .zz = a.m[8], .xy = a.m[1], .xz = a.m[2], .yz = a.m[5]};
}

ContactScratch::PlacedBody placed_body(std::size_t id, const ContactBodies& bodies) {
    const double inv_mass = bodies.inv_mass[id];
    return {bodies.position[id], inv_mass, inv_mass > 0 ? symmetric(bodies.inv_inertia[id]) : Sym3{},
            bodies.locked_of(id)};
}

// Notes how the bodies in contact are placed, and which of them as in the solve before.
void place_bodies(const ContactBodies& bodies, bool known, Team* team, ContactScratch& s) {
    const std::size_t before = known ? s.placed.size() : 0;
    s.placed.resize(s.bodies.size());
    s.body_stands.resize(s.bodies.size());
    for_each(team, "place bodies", s.bodies.size(), kBodyGrain, [&](std::size_t k) {
        const ContactScratch::PlacedBody now = placed_body(at(s.bodies[k]), bodies);
        s.body_stands[k] = k < before && same_bits(s.placed[k], now) ? 1 : 0;
        if (s.body_stands[k] == 0) s.placed[k] = now;
    });
}

// The pairs of body ids that have contacts, and where in the order those of each begin.
void gather_pairs(std::span<const Contact> contacts, Team* team, ContactScratch& s) {
    const auto pair_at = [&](std::size_t i) {
        const Contact& c = contacts[at(s.order[i])];
        return BodyPair{c.a, c.b};
    };
    const auto begins = [&](std::size_t i) { return i == 0 || !(pair_at(i - 1) == pair_at(i)); };
    const ListLoop loop{team, "gather pairs", kContactGrain, s.places};
    s.look.resize(s.order.size());
    const auto look = [&](std::size_t i) { return (s.look[i] = begins(i) ? 1 : 0) != 0; };
    s.first_contact.clear();
    compact_if(
        loop, s.order.size(), look, [&](std::size_t i) { return s.look[i] != 0; }, s.first_contact, 0, count_of);
    s.pairs.resize(s.first_contact.size());
    for_each(team, "gather pairs", s.pairs.size(), kContactGrain,
             [&](std::size_t p) { s.pairs[p] = pair_at(at(s.first_contact[p])); });
    s.first_contact.push_back(count_of(s.order.size()));
}

// Numbers the bodies of the pairs in id order, copies their velocities, and puts the numbers in place of the ids.
void gather_bodies(const ContactBodies& bodies, Team* team, ContactScratch& s) {
    s.local.assign(bodies.velocity.size(), -1);
    for (const BodyPair& pair : s.pairs) s.local[at(pair.a)] = s.local[at(pair.b)] = 0;
    s.bodies.clear();
    s.movable.clear();
    for (std::size_t id = 0; id < s.local.size(); ++id) {
        if (s.local[id] < 0) continue;
        s.local[id] = count_of(s.bodies.size());
        s.bodies.push_back(count_of(id));
        s.movable.push_back(bodies.inv_mass[id] > 0);
    }
    s.velocity.resize(s.bodies.size());
    s.start_velocity.resize(s.bodies.size());
    for_each(team, "gather bodies", s.bodies.size(), kBodyGrain, [&](std::size_t k) {
        const std::size_t id = at(s.bodies[k]);
        // + 0: no component of a BodyVelocity is -0.
        s.velocity[k] = {.linear = bodies.velocity[id] + Vec3{}, .angular = bodies.angular_velocity[id] + Vec3{}};
        s.start_velocity[k] = s.velocity[k];
    });
    for (BodyPair& pair : s.pairs) pair = {s.local[at(pair.a)], s.local[at(pair.b)]};
}

constexpr std::int32_t kBodiesPerRegion = 64, kMostRegions = 256;
constexpr int kCellBits = 4; // per axis

// The 12 bits of a cell of a 16 x 16 x 16 grid in Morton order: cells near each other have numbers near each other.
std::int32_t morton_cell(const Vec3& relative) {
    constexpr double kCells = 1 << kCellBits;
    std::int32_t code = 0;
    const double x[3] = {relative.x, relative.y, relative.z};
    for (int axis = 0; axis < 3; ++axis) {
        const auto cell = static_cast<std::int32_t>(std::max(0.0, std::min(x[axis] * kCells, kCells - 1)));
        for (int bit = 0; bit < kCellBits; ++bit) code |= (cell >> bit & 1) << (3 * bit + axis);
    }
    return code;
}

// Where the movable bodies of every island are, and how many.
void find_extents(const ContactBodies& bodies, std::size_t num_islands, ContactScratch& s) {
    s.island_of_body.assign(s.bodies.size(), -1);
    for (std::size_t k = 0; k < s.pairs.size(); ++k)
        for (const std::int32_t body : {s.pairs[k].a, s.pairs[k].b})
            if (s.movable[at(body)]) s.island_of_body[at(body)] = s.island_of_pair[k];
    s.extents.assign(num_islands, {});
    for (std::size_t k = 0; k < s.bodies.size(); ++k) {
        if (s.island_of_body[k] < 0) continue;
        ContactScratch::Extent& e = s.extents[at(s.island_of_body[k])];
        const Vec3& x = bodies.position[at(s.bodies[k])];
        e.low = e.bodies == 0 ? x : min(e.low, x);
        e.high = e.bodies == 0 ? x : max(e.high, x);
        ++e.bodies;
    }
}

std::int32_t num_regions(const ContactScratch::Extent& island) {
    return std::clamp(island.bodies / kBodiesPerRegion, 1, kMostRegions);
}

// Numbers regions of an island's bodies near each other, so that threads that share out the packets of every colour in
// that order meet mostly the same bodies in all of them: a velocity that another thread wrote last takes longer to
// fetch than a contact to solve. They are the island's own: parts and activation go by packets.
void number_regions(const ContactBodies& bodies, ContactScratch& s) {
    const std::size_t n = s.bodies.size();
    s.region.assign(n, 0);
    find_extents(bodies, at(s.num_islands), s);
    s.most_regions = 1;
    for (const ContactScratch::Extent& e : s.extents) s.most_regions = std::max(s.most_regions, num_regions(e));
    if (s.most_regions == 1) return;
    s.cell.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        s.cell[k] = 0;
        if (s.island_of_body[k] < 0) continue;
        const ContactScratch::Extent& e = s.extents[at(s.island_of_body[k])];
        const double size = std::max(max_component(e.high - e.low), std::numeric_limits<double>::min());
        s.cell[k] = morton_cell((bodies.position[at(s.bodies[k])] - e.low) / size);
    }
    s.body_order.resize(n);
    std::iota(s.body_order.begin(), s.body_order.end(), 0);
    stable_sort_by_key(s.cell, 1 << (3 * kCellBits), s.body_order, s.counts, s.sorted);
    for (const std::int32_t body : s.body_order) { // an island's in the order of their cells
        if (s.island_of_body[at(body)] < 0) continue;
        ContactScratch::Extent& e = s.extents[at(s.island_of_body[at(body)])];
        s.region[at(body)] = static_cast<std::int32_t>(std::int64_t{e.numbered} * num_regions(e) / e.bodies);
        ++e.numbered;
    }
}

// Moves the packets of every (island, colour), four pairs each, into the order of their pairs' mean region; what is
// left over stays behind them.
void order_packets_by_region(ContactScratch& s) {
    const auto same = [&](std::int32_t p, std::int32_t q) {
        return s.island_of_pair[at(p)] == s.island_of_pair[at(q)] && s.color[at(p)] == s.color[at(q)];
    };
    s.sorted = s.pair_order;
    for (std::size_t first = 0, end = 0; first < s.pair_order.size(); first = end) {
        while (end < s.pair_order.size() && same(s.pair_order[first], s.pair_order[end])) ++end;
        const auto full = static_cast<std::int32_t>((end - first) / kPacketLanes);
        s.packet_order.resize(at(full));
        std::iota(s.packet_order.begin(), s.packet_order.end(), 0);
        const auto pair_at = [&](std::int32_t packet) { return first + at(packet) * kPacketLanes; };
        const auto region = [&](std::int32_t packet) { // times kPacketLanes
            std::int32_t sum = 0;
            for (std::size_t lane = 0; lane < kPacketLanes; ++lane)
                sum += s.region_of_pair[at(s.pair_order[pair_at(packet) + lane])];
            return sum;
        };
        std::sort(s.packet_order.begin(), s.packet_order.end(),
                  [&](std::int32_t p, std::int32_t q) { return std::pair(region(p), p) < std::pair(region(q), q); });
        for (std::int32_t k = 0; k < full; ++k)
            std::copy_n(s.pair_order.begin() + static_cast<std::ptrdiff_t>(pair_at(s.packet_order[at(k)])),
                        kPacketLanes, s.sorted.begin() + static_cast<std::ptrdiff_t>(pair_at(k)));
    }
    s.pair_order.swap(s.sorted);
}

// By region, forwards where the number of active contacts is even, else backwards: when the pairs are sorted by that
// number afterwards, a packet with pairs of two numbers has them from the same end.
void sort_by_region_to_and_fro(ContactScratch& s) {
    s.region_to_and_fro.resize(s.pairs.size());
    for (std::size_t k = 0; k < s.pairs.size(); ++k) {
        const std::int32_t regions = num_regions(s.extents[at(s.island_of_pair[k])]);
        s.region_to_and_fro[k] = s.num_awake[k] % 2 == 0 ? s.region_of_pair[k] : regions - 1 - s.region_of_pair[k];
    }
    stable_sort_by_key(s.region_to_and_fro, s.most_regions, s.pair_order, s.counts, s.sorted);
}

bool is_parked(const Contact& c, const Vec3& warm_impulse, const ContactBodies& bodies,
               const ContactSolveOptions& options, const ContactScratch& s) {
    if (warm_impulse != Vec3{}) return false;
    const std::size_t a = at(c.a), b = at(c.b);
    const auto velocity_of = [&](std::size_t body) {
        const BodyVelocity& v = s.velocity[at(s.local[body])];
        const Vec3 point = point_on(c, static_cast<std::int32_t>(body));
        return v.linear + cross(v.angular, point - bodies.position[body]);
    };
    const double margin = options.tuning.parked_margin * std::min(c.tolerance, options.tolerance);
    return c.target < -margin - length(velocity_of(b) - velocity_of(a));
}

constexpr std::size_t kPairGrain = 32; // body pairs of a task

// Marks the inactive (parked) contacts of every pair, counts the others, and finds the least tolerance of all.
void park_contacts(std::span<const Contact> contacts, const ContactBodies& bodies, const ContactSolveOptions& options,
                   std::span<const Vec3> impulses, ContactScratch& s) {
    s.parked.resize(s.order.size());
    s.num_awake.resize(s.pairs.size());
    s.tolerance.resize(s.pairs.size());
    for_each(options.team, "park contacts", s.pairs.size(), kPairGrain, [&](std::size_t p) {
        s.num_awake[p] = 0;
        s.tolerance[p] = options.tolerance;
        for (std::int32_t i = s.first_contact[p]; i < s.first_contact[p + 1]; ++i) {
            const std::size_t c = at(s.order[at(i)]);
            s.parked[at(i)] = is_parked(contacts[c], options.warm_start ? impulses[c] : Vec3{}, bodies, options, s);
            s.num_awake[p] += s.parked[at(i)] ? 0 : 1;
            s.tolerance[p] = std::min(s.tolerance[p], contacts[c].tolerance);
        }
    });
}

void find_colors_and_islands(Team* team, ContactScratch& s) {
    s.color.resize(s.pairs.size());
    s.island_of_pair.resize(s.pairs.size());
    for_each(team, "colors and islands", 2, 1, [&](std::size_t k) {
        if (k == 0)
            s.num_colors = color_pairs(s.pairs, s.movable, s.coloring, s.color);
        else
            s.num_islands = find_islands(s.pairs, s.movable, s.graph, s.island_of_pair);
    });
}

// Sorts the pairs by (island, colour). Within a colour pairs with equally many active contacts come together, because
// they fill a packet best, and of those the ones near each other.
void sort_pairs(const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& s) {
    s.pair_order.resize(s.pairs.size());
    std::iota(s.pair_order.begin(), s.pair_order.end(), 0);
    std::int32_t most = 0;
    for (const std::int32_t awake : s.num_awake) most = std::max(most, awake);
    s.missing.resize(s.pairs.size());
    for (std::size_t k = 0; k < s.pairs.size(); ++k) s.missing[k] = most - s.num_awake[k];
    number_regions(bodies, s);
    s.region_of_pair.resize(s.pairs.size());
    for (std::size_t k = 0; k < s.pairs.size(); ++k) {
        const BodyPair& p = s.pairs[k];
        s.region_of_pair[k] = s.region[at(s.movable[at(p.a)] ? p.a : p.b)];
    }
    if (s.most_regions > 1 && options.tuning.to_and_fro) sort_by_region_to_and_fro(s);
    stable_sort_by_key(s.missing, most + 1, s.pair_order, s.counts, s.sorted);
    stable_sort_by_key(s.color, s.num_colors, s.pair_order, s.counts, s.sorted);
    stable_sort_by_key(s.island_of_pair, s.num_islands, s.pair_order, s.counts, s.sorted);
    if (s.most_regions > 1) order_packets_by_region(s);
}

// Whether the pairs are in the order of the solve before, with as many contacts each, active and parked ones.
bool order_stands(bool same_pairs, const ContactBodies& bodies, const ContactSolveOptions& options, ContactScratch& s) {
    const bool same_counts = same_pairs && s.num_awake == s.last.num_awake && s.first_contact == s.last.first_contact;
    const bool same_regions = s.most_regions == 1 || (options.tuning.to_and_fro == s.last.to_and_fro &&
                                                      std::ranges::count(s.body_stands, 0) == 0);
    if (same_counts && same_regions) return true;
    s.pair_order.swap(s.last.pair_order);
    sort_pairs(bodies, options, s);
    return same_counts && s.pair_order == s.last.pair_order;
}

// Begins the islands anew, where they were.
void restart_islands(ContactScratch& s) {
    for (ContactScratch::Island& island : s.islands) {
        ContactScratch::Island fresh;
        static_cast<ContactScratch::IslandPlace&>(fresh) = island;
        island = fresh;
    }
}

// Cuts the islands out of the list of pairs.
void cut_islands(ContactScratch& s) {
    s.islands.assign(at(s.num_islands), {});
    for (std::size_t k = 0; k < s.pair_order.size(); ++k) {
        ContactScratch::Island& island = s.islands[at(s.island_of_pair[at(s.pair_order[k])])];
        if (island.end == 0) island.first = count_of(k);
        island.end = count_of(k + 1);
    }
}

void set_tolerances(double most, ContactScratch& s) {
    for (ContactScratch::Island& island : s.islands) island.tolerance = most;
    for (std::size_t p = 0; p < s.pairs.size(); ++p) {
        double& tolerance = s.islands[at(s.island_of_pair[p])].tolerance;
        tolerance = std::min(tolerance, s.tolerance[p]);
    }
}

// Which rows each block has, in `pair_order`; the parked ones behind the others.
void lay_out_blocks(ContactScratch& s) {
    s.blocks.resize(s.pair_order.size());
    std::int32_t first = 0;
    for (std::size_t k = 0; k < s.pair_order.size(); ++k) {
        const std::size_t p = at(s.pair_order[k]);
        ContactBlock& block = s.blocks[k];
        block.a = s.pairs[p].a;
        block.b = s.pairs[p].b;
        block.color = s.color[p];
        block.first = first;
        block.parked = first + s.num_awake[p];
        block.end = first += s.first_contact[p + 1] - s.first_contact[p];
    }
}

void set_masses(ContactBlock& block, const ContactScratch& s) {
    const ContactScratch::PlacedBody &a = s.placed[at(block.a)], &b = s.placed[at(block.b)];
    block.inv_mass_a = a.inv_mass;
    block.inv_mass_b = b.inv_mass;
    block.inv_inertia_a = a.inv_inertia;
    block.inv_inertia_b = b.inv_inertia;
    block.locked_a = static_cast<AxisMask>(a.locked);
    block.locked_b = static_cast<AxisMask>(b.locked);
}

/// The step of tangents that outlive it.
constexpr std::uint64_t kNoStep = ~std::uint64_t{0};

TangentPair choose_tangents(const Contact& c, Cone cone, const ContactSolveOptions& options) {
    if (cone != Cone::pyramid) return any_tangents(c.normal);
    return keyed_tangents(c, options.seed, c.sticks ? kNoStep : options.step);
}

// A row without its mass, target, friction and impulse.
ContactRow make_row(const Contact& c, const Vec3& arm_a, const ContactBlock& block, Cone cone,
                    const ContactSolveOptions& options) {
    ContactRow row;
    row.normal = c.normal;
    row.arm_a = arm_a;
    row.across = c.across;
    row.arm_b = (row.arm_a + block.offset) + row.across;
    const TangentPair t = choose_tangents(c, cone, options);
    row.tangent_1 = t.t1;
    row.tangent_2 = t.t2;
    return row;
}

// Whether the row is what make_row() and set_mass() would make again in a block that stands.
bool row_stands(const ContactRow& row, const Contact& c, const Vec3& arm_a) {
    return same_bits(row.normal, c.normal) && same_bits(row.arm_a, arm_a) && same_bits(row.across, c.across);
}

// As its row has it.
double friction_of(const Contact& c, std::size_t i, const ContactSolveOptions& options) {
    return options.bounds.empty() || options.bounds[i] < 0 ? c.friction : -options.bounds[i];
}

void set_mass(Cone cone, const ContactBlock& block, PrincipalMasses& principal, ContactRow& row) {
    if ((block.locked_a | block.locked_b) != 0) return set_locked_mass(cone, block, row);
    switch (cone) {
    case Cone::none: return set_normal_mass(block, row);
    case Cone::disc:
    case Cone::bounded: return principal.add(block, row);
    case Cone::pyramid:
    case Cone::frozen: break;
    }
    set_effective_mass(block, row);
}

// Masses of the blocks, and their rows. Those that stand get their target and impulse alone.
void make_rows(std::span<const Contact> contacts, const ContactSolveOptions& options, std::span<const Vec3> impulses,
               bool same_places, ContactScratch& s) {
    const Cone cone = cone_of(options, s);
    const bool keyed = cone == Cone::pyramid; // tangents are others in every step
    s.rows.resize(s.order.size());
    s.source.resize(s.order.size());
    s.block_stands.resize(s.blocks.size());
    const auto make = [&](std::size_t k, PrincipalMasses& principal) {
        const std::size_t p = at(s.pair_order[k]);
        ContactBlock& block = s.blocks[k];
        const Vec3 offset = s.placed[at(block.a)].position - s.placed[at(block.b)].position;
        const bool stands = same_places && !keyed && s.body_stands[at(block.a)] && s.body_stands[at(block.b)] &&
                            same_bits(block.offset, offset);
        if (!stands) set_masses(block, s);
        block.offset = offset;
        bool all_stand = stands;
        std::int32_t awake = block.first, parked = block.parked;
        for (std::int32_t i = s.first_contact[p]; i < s.first_contact[p + 1]; ++i) {
            const std::int32_t r = s.parked[at(i)] ? parked++ : awake++;
            s.source[at(r)] = s.order[at(i)];
            const Contact& c = contacts[at(s.order[at(i)])];
            ContactRow& row = s.rows[at(r)];
            const Vec3 arm_a = c.point - s.placed[at(block.a)].position;
            if (!stands || !row_stands(row, c, arm_a)) {
                all_stand = false;
                row = make_row(c, arm_a, block, cone, options);
                set_mass(cone, block, principal, row);
            }
        }
        s.block_stands[k] = all_stand ? 1 : 0;
    };
    const auto start = [&](const ContactBlock& block) { // frames are final now
        for (std::int32_t r = block.first; r < block.end; ++r) {
            ContactRow& row = s.rows[at(r)];
            const Vec3 warm = options.warm_start ? impulses[at(s.source[at(r)])] : Vec3{};
            const Contact& c = contacts[at(s.source[at(r)])];
            row.local.target = {c.target, dot(row.tangent_1, c.slip), dot(row.tangent_2, c.slip)};
            row.local.friction = friction_of(c, at(s.source[at(r)]), options);
            row.local.impulse = cut_to_cone(cone, to_contact(row, warm), row.local.friction);
        }
    };
    const std::size_t pairs = s.blocks.size(), chunks = (pairs + kPairGrain - 1) / kPairGrain;
    for_each(options.team, "contact rows", chunks, 1, [&](std::size_t chunk) {
        const std::size_t begin = chunk * kPairGrain, end = std::min(pairs, begin + kPairGrain);
        PrincipalMasses principal(options.isa);
        for (std::size_t k = begin; k < end; ++k) make(k, principal);
        principal.flush();
        for (std::size_t k = begin; k < end; ++k) start(s.blocks[k]);
    });
}

void lay_out_packets(ContactScratch& s) {
    s.packed.clear();
    s.groups.clear();
    for (ContactScratch::Island& island : s.islands) {
        island.first_packet = count_of(s.packed.packets.size());
        island.first_group = count_of(s.groups.size());
        lay_out_packets(s.blocks, island.first, island.end, s.packed, s.groups);
        island.end_packet = count_of(s.packed.packets.size());
        island.end_group = count_of(s.groups.size());
    }
    resize_rows(s.packed);
}

// In islands that are solved exactly soon: where nothing can part from the script, contacts yield (interior_point.cpp).
// Sweeps, which others are left to, move all bodies of an island for it.
void press_few(const ContactSolveOptions& options, ContactScratch& s) {
    if (options.presses.empty() || !options.exact || options.tangents == Tangents::random) return;
    s.counts.assign(s.islands.size(), 0);
    for (std::size_t body = 0; body < s.bodies.size(); ++body)
        if (s.movable[body]) ++s.counts[at(s.island_of_body[body])];
    for (std::size_t i = 0; i < s.islands.size(); ++i) {
        const ContactScratch::Island& island = s.islands[i];
        if (s.counts[i] > options.tuning.bodies_factorised_soon) continue;
        for (std::int32_t k = island.first; k < island.end; ++k)
            for (std::int32_t r = s.blocks[at(k)].first; r < s.blocks[at(k)].parked; ++r)
                s.rows[at(r)].local.target.x += std::max(0.0, options.presses[at(s.source[at(r)])]);
    }
}

void fill_packets(Team* team, ContactScratch& s) {
    for_each(team, "pack contacts", s.packed.packets.size(), kPairGrain, [&](std::size_t p) {
        const auto pairs =
            std::span(s.block_stands).subspan(at(s.packed.first_block[p]), at(s.packed.packets[p].num_pairs));
        if (std::ranges::count(pairs, 0) == 0)
            refill_packet(s.rows, p, s.packed);
        else
            fill_packet(s.blocks, s.rows, p, s.packed);
    });
}

// What this solve has is compared with what the one before had.
void remember_last(ContactScratch& s) {
    s.pairs.swap(s.last.pairs);
    s.movable.swap(s.last.movable);
    s.first_contact.swap(s.last.first_contact);
    s.num_awake.swap(s.last.num_awake);
}

} // namespace

void stable_sort_by_key(std::span<const std::int32_t> key, int num_keys, std::vector<std::int32_t>& order,
                        std::vector<std::int32_t>& counts, std::vector<std::int32_t>& sorted) {
    counts.assign(at(num_keys) + 1, 0);
    for (const std::int32_t item : order) ++counts[at(key[at(item)]) + 1];
    std::inclusive_scan(counts.begin(), counts.end(), counts.begin());
    sorted.resize(order.size());
    for (const std::int32_t item : order) sorted[at(counts[at(key[at(item)])]++)] = item;
    order.swap(sorted);
}

void assemble(std::span<const Contact> contacts, const ContactBodies& bodies, const ContactSolveOptions& options,
              std::span<const Vec3> impulses, ContactScratch& s) {
    const bool known = std::exchange(s.last.complete, false);
    remember_last(s);
    order_contacts(contacts, bodies, options, s);
    gather_pairs(contacts, options.team, s);
    gather_bodies(bodies, options.team, s);
    place_bodies(bodies, known, options.team, s);
    park_contacts(contacts, bodies, options, impulses, s);
    const bool same_pairs = known && s.pairs == s.last.pairs && s.movable == s.last.movable;
    if (!same_pairs) find_colors_and_islands(options.team, s);
    const Cone cone = cone_of(options, s), before = std::exchange(s.last.cone, cone);
    const bool same_cone = before == cone || (is_disc(before) && is_disc(cone));
    const bool same_places = order_stands(same_pairs, bodies, options, s) && same_cone;
    s.last.to_and_fro = options.tuning.to_and_fro;
    if (same_places) {
        restart_islands(s);
    } else {
        cut_islands(s);
        lay_out_blocks(s);
        lay_out_packets(s);
    }
    resize_extras(s.any_extras, s.packed);
    set_tolerances(options.tolerance, s);
    make_rows(contacts, options, impulses, same_places, s);
    press_few(options, s);
    fill_packets(options.team, s);
    s.last.complete = true;
}

} // namespace flotilla
