// SPDX-License-Identifier: MIT
// Filling an array whose length is only known when everything has been looked at: by a team, in the order of the plain loop.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "parallel/team.hpp"

namespace flotilla {

/// Goes twice over [0, n) in chunks of `grain`. count(begin, end) says how many places the chunk fills, resize(total) makes room, and
/// fill(begin, end, place) fills them from `place` on. `places` is scratch, kept by the caller; without a team a plain loop.
template <class Count, class Resize, class Fill>
void compact(Team* team, const char* name, std::size_t n, std::size_t grain, std::vector<std::size_t>& places,
             Count&& count, Resize&& resize, Fill&& fill) {
    const std::size_t chunks = (n + grain - 1) / grain;
    const auto end_of = [&](std::size_t chunk) { return std::min(n, (chunk + 1) * grain); };
    places.assign(chunks + 1, 0);
    for_each(team, name, chunks, 1, [&](std::size_t k) { places[k + 1] = count(k * grain, end_of(k)); });
    std::partial_sum(places.begin(), places.end(), places.begin());
    resize(places.back());
    for_each(team, name, chunks, 1, [&](std::size_t k) { fill(k * grain, end_of(k), places[k]); });
}

} // namespace flotilla
