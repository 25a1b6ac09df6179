// SPDX-License-Identifier: MIT
// Waiting for another thread: a while in a loop, then asleep, so that the core goes to whoever has work.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace flotilla {

[[nodiscard]] inline std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

inline void pause_briefly() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/// ns that a thread spins before it sleeps. Waking one costs 2 to 50 us, and beside other work up to a slice of the
/// scheduler's, milliseconds; so much is worth waiting for and no more.
inline constexpr std::int64_t kSpinTime = 50'000;

/// Whether ready() became true in `time` ns.
template <class Ready>
[[nodiscard]] bool spin(std::int64_t time, Ready&& ready) {
    if (ready()) return true;
    const std::int64_t end = now_ns() + time;
    do {
        for (int turn = 0; turn < 16; ++turn) {
            pause_briefly();
            if (ready()) return true;
        }
    } while (now_ns() < end);
    return false;
}

/// Where one thread sleeps. Who makes its ready() true calls wake() afterwards; both use sequentially consistent
/// operations on what ready() reads, so that in their one order either the sleeper's check comes after the change, or
/// the waker's check after the sleeper's announcement: no wake-up is lost.
class Bed {
  public:
    enum State : int { up, idle, in_run, at_end };

    /// Returns when ready() holds, or when woken: then it may not hold.
    template <class Ready>
    void sleep(State why, Ready&& ready) {
        state_.store(why);
        if (!ready()) state_.wait(why);
        state_.store(up);
    }
    [[nodiscard]] State state() const { return static_cast<State>(state_.load()); }
    /// Whether it slept for that reason.
    bool wake(State why) {
        int expected = why;
        if (state_.load() != why || !state_.compare_exchange_strong(expected, up)) return false;
        state_.notify_one();
        return true;
    }

  private:
    alignas(64) std::atomic<int> state_ = up;
};

} // namespace flotilla
