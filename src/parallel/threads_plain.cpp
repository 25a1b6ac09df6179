// SPDX-License-Identifier: MIT
// Threads that ThreadSanitizer sees whole; made for every region, which costs too much for anything but tests.
#include <algorithm>
#include <thread>
#include <vector>

#include "base/environment.hpp"
#include "parallel/threads.hpp"

namespace flotilla {

int usable_cores() { return std::max(static_cast<int>(std::thread::hardware_concurrency()), 1); }

int default_threads() {
    const int threads = threads_from_environment();
    return threads > 0 ? threads : usable_cores();
}

bool among_workers() { return false; }

void with_threads(int wanted, const CallRef<int, int>& work) {
    std::vector<std::jthread> threads;
    for (int k = 1; k < wanted; ++k) threads.emplace_back([&work, k, wanted] { work(k, wanted); });
    work(0, wanted);
}

} // namespace flotilla
