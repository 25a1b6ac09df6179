// SPDX-License-Identifier: MIT
// Order-preserving parallel compaction: an array whose length follows from its items is filled by a team, in the order
// of the plain loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "parallel/team.hpp"

namespace flotilla {

/// The loop over the items, and its scratch.
struct ListLoop {
    Team* team;                       ///< null: a plain loop
    const char* name;                 ///< of the tasks, for records
    std::size_t grain;                ///< items of a task, >= 1
    std::vector<std::size_t>& places; ///< scratch, kept by the caller
};

/// Two passes over [0, n) in chunks, with a prefix sum between them. count(begin, end) returns how many places the
/// chunk fills, resize(total) makes room, and fill(begin, end, place) fills them from `place` on.
template <class Count, class Resize, class Fill>
void compact(const ListLoop& loop, std::size_t n, Count&& count, Resize&& resize, Fill&& fill) {
    const std::size_t chunks = (n + loop.grain - 1) / loop.grain;
    const auto begin_of = [&](std::size_t chunk) { return chunk * loop.grain; };
    const auto end_of = [&](std::size_t chunk) { return std::min(n, (chunk + 1) * loop.grain); };
    std::vector<std::size_t>& places = loop.places;
    places.assign(chunks + 1, 0);
    for_each(loop.team, loop.name, chunks, 1, [&](std::size_t k) { places[k + 1] = count(begin_of(k), end_of(k)); });
    std::partial_sum(places.begin(), places.end(), places.begin());
    resize(places.back());
    for_each(loop.team, loop.name, chunks, 1, [&](std::size_t k) { fill(begin_of(k), end_of(k), places[k]); });
}

/// Replaces what `out` holds from place `from` on by item(i) of those i in [0, n) that are kept, in their order.
/// look(i), of the first pass, returns whether i is kept; kept(i), of the second, must return the same. `from` is at
/// most out.size().
template <class Look, class Kept, class T, class Item>
void compact_if(const ListLoop& loop, std::size_t n, Look&& look, Kept&& kept, std::vector<T>& out, std::size_t from,
                Item&& item) {
    const auto count = [&](std::size_t begin, std::size_t end) {
        std::size_t sum = 0;
        for (std::size_t i = begin; i < end; ++i) sum += look(i) ? 1u : 0u;
        return sum;
    };
    const auto fill = [&](std::size_t begin, std::size_t end, std::size_t place) {
        for (std::size_t i = begin; i < end; ++i)
            if (kept(i)) out[from + place++] = item(i);
    };
    const auto resize = [&](std::size_t total) { out.resize(from + total); };
    compact(loop, n, count, resize, fill);
}

/// The same with one predicate for both passes.
template <class Kept, class T, class Item>
void compact_if(const ListLoop& loop, std::size_t n, Kept&& kept, std::vector<T>& out, std::size_t from, Item&& item) {
    compact_if(loop, n, kept, kept, out, from, item);
}

/// Makes `out` as large as all parts together and calls put(place, part) for each, `place` being the size of those
/// before it.
template <class Part, class Out, class Put>
void gather_parts(const ListLoop& loop, std::span<const Part> parts, Out& out, Put&& put) {
    const auto count = [&](std::size_t begin, std::size_t end) {
        std::size_t sum = 0;
        for (std::size_t k = begin; k < end; ++k) sum += parts[k].size();
        return sum;
    };
    const auto fill = [&](std::size_t begin, std::size_t end, std::size_t place) {
        for (std::size_t k = begin; k < end; place += parts[k++].size()) put(place, parts[k]);
    };
    const auto resize = [&](std::size_t total) { out.resize(total); };
    compact(loop, parts.size(), count, resize, fill);
}

} // namespace flotilla
