// SPDX-License-Identifier: MIT
#include <algorithm>
#include <vector>

#include <omp.h>
#include <sched.h>
#include <tbb/task.h>

#include "parallel/environment.hpp"
#include "parallel/threads.hpp"

namespace flotilla {

int usable_cores() { return std::max(omp_get_num_procs(), 1); }

int default_threads() {
    if (const int threads = threads_from_environment(); threads > 0) return threads;
    return std::max(omp_get_max_threads(), 1);
}

bool among_workers() { return omp_in_parallel() != 0 || tbb::task::current_context() != nullptr; }

void leave_place() {
    const int places = omp_get_num_places();
    if (places == 0) return; // nobody is bound
    cpu_set_t cores;
    CPU_ZERO(&cores);
    std::vector<int> ids;
    for (int place = 0; place < places; ++place) {
        ids.resize(static_cast<std::size_t>(omp_get_place_num_procs(place)));
        omp_get_place_proc_ids(place, ids.data());
        for (const int id : ids) CPU_SET(static_cast<std::size_t>(id), &cores);
    }
    sched_setaffinity(0, sizeof cores, &cores); // where that fails it stays where it is
}

void with_threads(int wanted, const CallRef<int, int>& work) {
#pragma omp parallel num_threads(wanted)
    work(omp_get_thread_num(), omp_get_num_threads());
}

} // namespace flotilla
