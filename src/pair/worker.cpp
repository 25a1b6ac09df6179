// SPDX-License-Identifier: MIT
#include "pair/worker.hpp"

#include <algorithm>
#include <utility>

namespace flotilla {

double take_largest_push(Worker& worker) { return std::exchange(worker.largest_push, 0.0); }

double take_largest_push(Workers& workers) {
    double largest = 0;
    for (Worker& worker : workers.each) largest = std::max(largest, take_largest_push(worker));
    return largest;
}

void collect(Workers& workers, StageCounters& counters) {
    for (Worker& worker : workers.each) {
        StageCounters& c = worker.counters;
        counters.pairs += c.pairs;
        counters.impulses += c.impulses;
        counters.settled += c.settled;
        counters.detection_ms += c.detection_ms;
        counters.response_ms += c.response_ms;
        c = {};
    }
}

} // namespace flotilla
