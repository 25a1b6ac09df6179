// SPDX-License-Identifier: MIT
#include "islands/contact_graph.hpp"

#include <algorithm>
#include <numeric>

#include "base/assert.hpp"

namespace flotilla {
namespace {

std::int32_t& at(std::vector<std::int32_t>& v, std::int32_t i) { return v[static_cast<std::size_t>(i)]; }

// Halves the path on the way; roots are the lowest body of their set because the higher root is linked to the lower.
std::int32_t find_root(std::vector<std::int32_t>& parent, std::int32_t i) {
    while (at(parent, i) != i) i = at(parent, i) = at(parent, at(parent, i));
    return i;
}

void unite(std::vector<std::int32_t>& parent, std::int32_t a, std::int32_t b) {
    const std::int32_t ra = find_root(parent, a), rb = find_root(parent, b);
    at(parent, std::max(ra, rb)) = std::min(ra, rb);
}

// Fills first and next: all neighbours of every body, in pair order.
void collect_neighbours(std::span<const BodyPair> pairs, std::size_t num_bodies, ContactGraphScratch& s) {
    s.first.assign(num_bodies + 1, 0);
    s.next.resize(2 * pairs.size());
    for (const BodyPair& p : pairs) ++at(s.first, p.a), ++at(s.first, p.b);
    std::inclusive_scan(s.first.begin(), s.first.end(), s.first.begin());
    for (std::size_t k = pairs.size(); k-- > 0;) {
        at(s.next, --at(s.first, pairs[k].a)) = pairs[k].b;
        at(s.next, --at(s.first, pairs[k].b)) = pairs[k].a;
    }
}

} // namespace

int find_islands(std::span<const BodyPair> pairs, std::span<const std::uint8_t> movable, ContactGraphScratch& scratch,
                 std::span<std::int32_t> island) {
    scratch.parent.resize(movable.size());
    std::iota(scratch.parent.begin(), scratch.parent.end(), 0);
    const auto is_movable = [&](std::int32_t i) { return movable[static_cast<std::size_t>(i)] != 0; };
    for (const BodyPair& p : pairs)
        if (is_movable(p.a) && is_movable(p.b)) unite(scratch.parent, p.a, p.b);

    // A root is the lowest body of its island: numbering the roots in body order numbers islands by their lowest body.
    scratch.island_number.assign(movable.size(), -1);
    for (const BodyPair& p : pairs)
        at(scratch.island_number, find_root(scratch.parent, is_movable(p.a) ? p.a : p.b)) = 0;
    int num_islands = 0;
    for (std::int32_t& number : scratch.island_number)
        if (number == 0) number = num_islands++;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        FLOTILLA_ASSERT(is_movable(pairs[k].a) || is_movable(pairs[k].b));
        const std::int32_t body = is_movable(pairs[k].a) ? pairs[k].a : pairs[k].b;
        island[k] = at(scratch.island_number, find_root(scratch.parent, body));
    }
    return num_islands;
}

void contact_levels(std::span<const BodyPair> pairs, std::span<const std::uint8_t> movable,
                    ContactGraphScratch& scratch, std::span<std::int32_t> level) {
    collect_neighbours(pairs, movable.size(), scratch);
    scratch.queue.clear();
    for (std::size_t i = 0; i < movable.size(); ++i) {
        level[i] = movable[i] ? -1 : 0;
        if (!movable[i]) scratch.queue.push_back(static_cast<std::int32_t>(i));
    }
    for (std::size_t head = 0; head < scratch.queue.size(); ++head) { // breadth first
        const std::int32_t body = scratch.queue[head];
        for (std::int32_t k = at(scratch.first, body); k < at(scratch.first, body + 1); ++k) {
            std::int32_t& next = level[static_cast<std::size_t>(at(scratch.next, k))];
            if (next >= 0) continue;
            next = level[static_cast<std::size_t>(body)] + 1;
            scratch.queue.push_back(at(scratch.next, k));
        }
    }
}

} // namespace flotilla
