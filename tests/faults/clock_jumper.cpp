// SPDX-License-Identifier: MIT
// Loaded before a program (LD_PRELOAD), makes its clocks jump at every look: that of the day to anywhere within a year,
// that of the machine forward by up to a minute, as after a suspension.
#include <dlfcn.h>
#include <time.h>

#include <atomic>
#include <cstdint>

namespace {

std::atomic<std::uint64_t> looks{0};
std::atomic<std::int64_t> forward{0}; ///< s

std::uint64_t random_bits() {
    std::uint64_t x = (looks.fetch_add(1) + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    return x ^ (x >> 31);
}

} // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
    using Read = int (*)(clockid_t, timespec*);
    static const auto read = reinterpret_cast<Read>(dlsym(RTLD_NEXT, "clock_gettime"));
    const int result = read(clock, time);
    constexpr std::uint64_t kYear = 31'536'000, kMinute = 60; // s
    if (clock == CLOCK_REALTIME)
        time->tv_sec += static_cast<time_t>(random_bits() % kYear) - static_cast<time_t>(kYear / 2);
    else if (clock == CLOCK_MONOTONIC)
        time->tv_sec += forward += static_cast<std::int64_t>(random_bits() % kMinute);
    return result;
}
