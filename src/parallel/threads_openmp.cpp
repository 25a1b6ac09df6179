// SPDX-License-Identifier: MIT
#include <algorithm>

#include <omp.h>
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

void with_threads(int wanted, const CallRef<int, int>& work) {
#pragma omp parallel num_threads(wanted)
    work(omp_get_thread_num(), omp_get_num_threads());
}

} // namespace flotilla
