// SPDX-License-Identifier: MIT
#include <algorithm>

#include <tbb/parallel_for.h>

#include "parallel/arena.hpp"
#include "parallel/items.hpp"
#include "parallel/parallel_for.hpp"

namespace flotilla {

void parallel_for(std::size_t n, int threads, const std::function<void(std::size_t)>& work) {
    if (threads <= 1 || n <= 1) {
        for (std::size_t i = 0; i < n; ++i) work(i);
        return;
    }
    Items items(work);
    const Unbound unbound;
    Arena arena(std::min(n, static_cast<std::size_t>(threads)));
    arena->execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, n, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) items.run(i);
            },
            tbb::auto_partitioner());
    });
    items.rethrow();
}

} // namespace flotilla
