// SPDX-License-Identifier: MIT
#include <tbb/parallel_pipeline.h>

#include "parallel/arena.hpp"
#include "parallel/stage_errors.hpp"

namespace flotilla {

void run_ordered_stages(std::size_t n, int threads, std::size_t places, const OrderedStages& stages) {
    StageErrors run(stages, places);
    std::size_t next = 0;
    const auto begin = [&](tbb::flow_control& control) {
        if (next == n || run.stopped()) {
            control.stop();
            return n;
        }
        run.begin(next);
        return next++;
    };
    const auto work = [&](std::size_t i) {
        run.work(i);
        return i;
    };
    const Unbound unbound;
    Arena arena(threads > 1 ? static_cast<std::size_t>(threads) : 1);
    arena->execute([&] {
        tbb::parallel_pipeline(places,
                               tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, begin) &
                                   tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::parallel, work) &
                                   tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order,
                                                                       [&](std::size_t i) { run.end(i); }));
    });
    run.rethrow();
}

} // namespace flotilla
