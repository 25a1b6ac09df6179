// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>

#include "parallel/items.hpp"
#include "parallel/parallel_for.hpp"

namespace flotilla {

void parallel_for(std::size_t n, int threads, const std::function<void(std::size_t)>& work) {
    if (threads <= 1 || n <= 1) {
        for (std::size_t i = 0; i < n; ++i) work(i);
        return;
    }
    Items items(work);
    std::atomic<std::size_t> next = 0;
    const auto some = [&](int, int) {
        for (std::size_t i = next++; i < n; i = next++) items.run(i);
    };
    with_threads(static_cast<int>(std::min(n, static_cast<std::size_t>(threads))), CallRef<int, int>::of(some));
    items.rethrow();
}

} // namespace flotilla
