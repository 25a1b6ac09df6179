// SPDX-License-Identifier: MIT
#include "parallel/parallel_for.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include <sched.h>

#include "parallel/first_error.hpp"

namespace flotilla {
namespace {

/// 0 where the variable is unset or no positive number.
int threads_from(const char* variable) {
    const char* text = std::getenv(variable);
    int threads = 0;
    if (text != nullptr) std::from_chars(text, text + std::strlen(text), threads);
    return std::max(threads, 0);
}

/// The items in turn, handed out one by one.
class Queue {
  public:
    Queue(std::size_t n, const std::function<void(std::size_t)>& work) : n_(n), work_(work) {}

    void run() {
        for (std::size_t i = next_++; i < n_ && !error_.any(); i = next_++) {
            try {
                work_(i);
            } catch (...) {
                error_.keep(i);
            }
        }
    }
    void rethrow() const { error_.rethrow(); }

  private:
    std::size_t n_;
    const std::function<void(std::size_t)>& work_;
    std::atomic<std::size_t> next_ = 0;
    FirstError error_;
};

} // namespace

int usable_cores() {
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) == 0) return std::max(CPU_COUNT(&set), 1);
    return std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

int default_threads() {
    for (const char* variable : {"FLOTILLA_NUM_THREADS", "OMP_NUM_THREADS"})
        if (const int threads = threads_from(variable); threads > 0) return threads;
    return usable_cores();
}

void parallel_for(std::size_t n, int threads, const std::function<void(std::size_t)>& work) {
    const std::size_t helpers = std::min(n, static_cast<std::size_t>(std::max(threads, 1))) - (n > 0 ? 1 : 0);
    if (helpers == 0) {
        for (std::size_t i = 0; i < n; ++i) work(i);
        return;
    }
    Queue queue(n, work);
    std::vector<std::thread> team;
    for (std::size_t k = 0; k < helpers; ++k) team.emplace_back([&queue] { queue.run(); });
    queue.run();
    for (auto& thread : team) thread.join();
    queue.rethrow();
}

} // namespace flotilla
