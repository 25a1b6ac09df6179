// SPDX-License-Identifier: MIT
// Sorting by a team. The result is that of std::sort where equal items are the same bits, whatever the number of
// threads.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <vector>

#include "parallel/team.hpp"

namespace flotilla {

namespace team_sort_detail {

constexpr std::size_t kLeastRun = 256, kRuns = 64;

/// Items sorted, and later merged, by one task: a power of two, so that merged runs are cut where tasks are.
inline std::size_t run_length(std::size_t n) { return std::max(kLeastRun, std::bit_ceil(n / kRuns)); }

/// How many of the first `k` items of the merged sequence come from `a`; of equal ones a's come first.
template <class T, class Less>
std::size_t merge_split(const T* a, std::size_t size_a, const T* b, std::size_t size_b, std::size_t k,
                        const Less& less) {
    std::size_t low = k > size_b ? k - size_b : 0, high = std::min(k, size_a);
    while (low < high) {
        const std::size_t i = (low + high) / 2; // from a, k - i from b
        if (less(b[k - i - 1], a[i]))
            high = i;
        else
            low = i + 1;
    }
    return low;
}

} // namespace team_sort_detail

/// `buffer` is scratch, kept by the caller.
template <class T, class Less>
void team_sort(Team& team, std::vector<T>& items, std::vector<T>& buffer, Less less) {
    using namespace team_sort_detail;
    const std::size_t n = items.size(), run = run_length(n);
    if (n <= run || (team.alone() && team.recorder() == nullptr)) {
        if (!std::is_sorted(items.begin(), items.end(), less)) std::sort(items.begin(), items.end(), less);
        return;
    }
    team.for_chunks("sort", n, run, [&](std::size_t begin, std::size_t end, int) {
        std::sort(items.begin() + static_cast<std::ptrdiff_t>(begin), items.begin() + static_cast<std::ptrdiff_t>(end),
                  less);
    });
    buffer.resize(n);
    for (std::size_t sorted = run; sorted < n; sorted *= 2) {
        team.for_chunks("merge", n, run, [&](std::size_t begin, std::size_t end, int) {
            const std::size_t first = begin / (2 * sorted) * (2 * sorted);
            const T *a = items.data() + first, *b = a + std::min(sorted, n - first);
            const std::size_t size_a = std::min(sorted, n - first), size_b = std::min(sorted, n - first - size_a);
            const std::size_t from = merge_split(a, size_a, b, size_b, begin - first, less);
            const std::size_t to = merge_split(a, size_a, b, size_b, end - first, less);
            std::merge(a + from, a + to, b + (begin - first - from), b + (end - first - to), buffer.data() + begin,
                       less);
        });
        items.swap(buffer);
    }
}

/// std::merge of the sorted items before and after place `middle` into `out`, which is another vector.
template <class T, class Less>
void team_merge(Team& team, const std::vector<T>& items, std::size_t middle, std::vector<T>& out, Less less) {
    using namespace team_sort_detail;
    const std::size_t n = items.size();
    const T *a = items.data(), *b = a + middle;
    out.resize(n);
    team.for_chunks("merge", n, run_length(n), [&](std::size_t begin, std::size_t end, int) {
        const std::size_t from = merge_split(a, middle, b, n - middle, begin, less);
        const std::size_t to = merge_split(a, middle, b, n - middle, end, less);
        std::merge(a + from, a + to, b + (begin - from), b + (end - to), out.data() + begin, less);
    });
}

} // namespace flotilla
