// SPDX-License-Identifier: MIT
// How the threads of one parallel region share out sections of work, whoever of them has a core at the time.
//
// A section has phases, one after another, and each phase the same number of shares. Share k belongs to thread k, which
// finds in its caches what it left there in the phase before; but whoever comes first claims it. A phase is over when
// all its shares are done. So nothing waits for a thread that has not come: others do its share, and it finds the
// section closed.
//
// Claims. Phases are numbered through the life of the crew; a share's counter holds the next phase in which it is to be
// done and goes up by one with every claim. Since phase p + 1 begins when every share of p is done, the counters only
// grow, and a claim of p, a compare-and-swap from p to p + 1, succeeds once, and never after p is over.
//
// Lifetime. A helper reads the notice of the section (what to call, on what) before it claims and uses it after it
// claimed only. A claim that succeeds shows that the section is not over, and it will not be before the share is done;
// so notice and callee are alive.
//
// Order. Shares end with an increment of done_ (release) and a phase begins with a read of it (acquire): what a share
// wrote, every share of later phases sees, and the caller after the section.
//
// Waits. Each is for a claimed share (its thread runs, or the system will let it: shares do not wait for one another,
// save in ordered runs, which say for themselves why they end) or for the next section or the end of the region, which
// the caller announces.
#pragma once

#include <atomic>
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel/threads.hpp"
#include "parallel/wait.hpp"

namespace flotilla {

class Crew {
  public:
    /// (phase, share, thread); a thread has one share at a time.
    using Work = CallRef<std::size_t, int, int>;

    /// Of at most `threads`. Helpers are only woken while fewer than `most_awake` threads are awake: more than there
    /// are cores would take them from each other.
    Crew(int threads, int most_awake) : most_awake_(most_awake), seats_(static_cast<std::size_t>(threads)) {}

    // The caller's, thread 0 of the region.
    void begin(int present);
    /// Calls work for all shares of phase 0, then of phase 1 and so on.
    void run(int shares, std::size_t phases, const Work& work);
    /// No more sections: helpers may leave.
    void dismiss();
    /// Returns when all helpers have left. Returns the ns that it took.
    std::int64_t join();

    // A helper's: takes part in sections until it is dismissed.
    void serve(int thread);

    // For waits within a share: ns to spin before (where there are more threads than cores, others need them), and
    // sleep.
    [[nodiscard]] std::int64_t spin_time() const { return present_ > most_awake_ ? kSpinTime / 16 : kSpinTime; }
    template <class Ready>
    void sleep_in_run(int thread, Ready&& ready) {
        seat(thread).bed.sleep(Bed::in_run, ready);
    }
    /// Wakes one thread that sleeps so, where cores may be free.
    void wake_one();
    void wake_all_in_run();

    [[nodiscard]] double helped_ms(int thread) const {
        return 1e-6 * static_cast<double>(seats_[static_cast<std::size_t>(thread)].helped);
    }

  private:
    struct Seat {
        alignas(64) std::atomic<std::uint64_t> next = 0; ///< phase
        Bed bed;
        alignas(64) std::int64_t helped = 0; ///< ns in sections of several phases
    };
    /// The section. Written while none is open, between two increments of version; whoever reads the same even version
    /// before and after has one section's.
    struct alignas(64) Notice {
        std::atomic<std::uint64_t> version = 0, first = 0, done_before = 0;
        std::atomic<std::size_t> phases = 0;
        std::atomic<void (*)(void*, std::size_t, int, int)> function = nullptr;
        std::atomic<void*> object = nullptr;
        std::atomic<int> shares = 0;
    };
    struct Section {
        std::uint64_t first = 0, done_before = 0;
        std::size_t phases = 0;
        int shares = 0;
        Work work;

        [[nodiscard]] std::uint64_t end() const { return first + phases; }
        /// What done_ comes to with phase p.
        [[nodiscard]] std::uint64_t done_after(std::uint64_t p) const {
            return done_before + (p - first + 1) * static_cast<std::uint64_t>(shares);
        }
    };

    [[nodiscard]] Seat& seat(int k) { return seats_[static_cast<std::size_t>(k)]; }
    void publish(const Section& section);
    [[nodiscard]] bool read(std::uint64_t version, Section& section) const;
    void invite(int shares);
    [[nodiscard]] int num_awake() const;
    void help(int thread, const Section& section);
    bool claim(int share, std::uint64_t phase);
    void perform(const Section& section, std::uint64_t phase, int share, int thread);
    bool take_over(const Section& section, std::uint64_t phase, int thread);
    [[nodiscard]] bool over(const Section& section, std::uint64_t phase) const {
        return done_.load() >= section.done_after(phase);
    }

    int most_awake_;
    int present_ = 1;
    std::uint64_t next_phase_ = 1;
    std::vector<Seat> seats_;
    std::fenv_t environment_{}; ///< the caller's rounding and traps, which helpers take
    std::uint64_t version_at_begin_ = 0;
    Notice notice_;
    alignas(64) std::atomic<std::uint64_t> done_ = 0; ///< shares, of all sections
    alignas(64) std::atomic<bool> dismissed_ = false;
    alignas(64) std::atomic<int> left_ = 0; ///< helpers that have left the region
};

} // namespace flotilla
