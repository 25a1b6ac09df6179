// SPDX-License-Identifier: MIT
#include "pair/worker.hpp"

namespace flotilla {

void collect(Workers& workers, StageCounters& counters) {
    for (const auto& worker : workers) {
        StageCounters& c = worker->counters;
        counters.pairs += c.pairs;
        counters.impulses += c.impulses;
        counters.settled += c.settled;
        counters.detection_ms += c.detection_ms;
        counters.response_ms += c.response_ms;
        c = {};
    }
}

} // namespace flotilla
