// SPDX-License-Identifier: MIT
// Items that come and go in order and are worked on side by side in between (frames of a run that become files), on
// oneTBB.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "parallel/threads.hpp"

namespace flotilla {

/// The stages of item i, which has place i % places to itself from its begin to its end.
struct OrderedStages {
    std::function<void(std::size_t i)> begin, work, end;
};

/// Calls begin(i) for i in [0, n) one after another, work(i) on at most `threads` threads, and end(i) one after another
/// and in order. At most `places` items are under way. Throws what a plain loop would throw, after as many calls of
/// end().
void run_ordered_stages(std::size_t n, int threads, std::size_t places, const OrderedStages& stages);

/// read(i) makes an item, make(item) something of it, and use(made, i) takes that, in order.
template <class Read, class Make, class Use>
void in_order(std::size_t n, int threads, Read&& read, Make&& make, Use&& use) {
    struct Place {
        std::optional<decltype(read(std::size_t{}))> item;
        std::optional<decltype(make(*item))> made;
    };
    std::vector<Place> places(2 * static_cast<std::size_t>(threads > 1 ? threads : 1));
    const auto at = [&](std::size_t i) -> Place& { return places[i % places.size()]; };
    const auto begin = [&](std::size_t i) { at(i).item.emplace(read(i)); };
    const auto work = [&](std::size_t i) { at(i).made.emplace(make(*at(i).item)); };
    const auto end = [&](std::size_t i) { use(*at(i).made, i); };
    run_ordered_stages(n, threads, places.size(), {begin, work, end});
}

} // namespace flotilla
