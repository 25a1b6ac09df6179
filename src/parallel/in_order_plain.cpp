// SPDX-License-Identifier: MIT
#include <algorithm>

#include "parallel/parallel_for.hpp"
#include "parallel/stage_errors.hpp"

namespace flotilla {

void run_ordered_stages(std::size_t n, int threads, std::size_t places, const OrderedStages& stages) {
    StageErrors run(stages, places);
    for (std::size_t first = 0; first < n && !run.stopped(); first += places) {
        const std::size_t count = std::min(places, n - first);
        for (std::size_t k = 0; k < count; ++k) run.begin(first + k);
        parallel_for(count, threads, [&](std::size_t k) { run.work(first + k); });
        for (std::size_t k = 0; k < count; ++k) run.end(first + k);
    }
    run.rethrow();
}

} // namespace flotilla
