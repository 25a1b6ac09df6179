// SPDX-License-Identifier: MIT
#include <algorithm>

#include <omp.h>
#include <pthread.h>
#include <sys/mman.h>
#include <tbb/task.h>

#include "base/environment.hpp"
#include "parallel/threads.hpp"

namespace flotilla {

int usable_cores() { return std::max(omp_get_num_procs(), 1); }

int default_threads() {
    if (const int threads = threads_from_environment(); threads > 0) return threads;
    return std::max(omp_get_max_threads(), 1);
}

bool among_workers() { return omp_in_parallel() != 0 || tbb::task::current_context() != nullptr; }

namespace {

/// Whether the system has address space for the stacks of so many more threads. OpenMP ends the process where it has
/// not; all that can be done is to ask before.
bool has_room(int threads) {
    constexpr std::size_t kGuard = 1u << 16, kOfOpenMP = 1u << 20; // bytes a thread, and of what describes all of them
    std::size_t stack = 0;
    pthread_attr_t attributes;
    if (pthread_getattr_default_np(&attributes) != 0 || pthread_attr_getstacksize(&attributes, &stack) != 0)
        return true;
    pthread_attr_destroy(&attributes);
    const std::size_t size = static_cast<std::size_t>(threads) * (stack + kGuard) + kOfOpenMP;
    void* const room = ::mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (room == MAP_FAILED) return false;
    ::munmap(room, size);
    return true;
}

} // namespace

void with_threads(int wanted, const CallRef<int, int>& work) {
    static thread_local int at_hand = 1; // OpenMP keeps those of a thread's last region
    if (wanted > at_hand && !has_room(wanted - at_hand)) wanted = 1;
    at_hand = wanted;
#pragma omp parallel num_threads(wanted)
    work(omp_get_thread_num(), omp_get_num_threads());
}

} // namespace flotilla
