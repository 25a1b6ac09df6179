// SPDX-License-Identifier: MIT
// How the threads of one parallel region share out sections of work, whoever of them has a core at the time.
//
// A section has phases, one after another, and each phase the same number of shares. Share k belongs to thread k, which
// finds in its caches what it left there in the phase before; but whoever comes first claims it. A phase is over when
// all its shares are done. So nothing waits for a thread that has not come: others do its share, and it finds the
// section closed.
//
// A chain is a stretch of phases in which a share waits for its neighbours alone: it may begin a phase when they have
// done what they have in the phases before. It passes over phases in which it has nothing to do. All other phases are
// stretches of their own; stretches follow one another when all shares are done with them.
//
// Claims. Phases are numbered through the life of the crew. A share's counter holds twice the next phase in which it is
// to be done, and one more while somebody does it. Since a share is done in the order of its phases, the counters only
// grow, and a claim of p, a compare-and-swap from 2p to 2p + 1, succeeds once, and never after p is over.
//
// Lifetime. A helper reads the notice of the section (what to call, on what) before it claims and uses it after it
// claimed only. A claim that succeeds shows that the section is not over, and it will not be before the share is done;
// so notice, chain and callee are alive.
//
// Order. A stretch ends for a share with an increment of done_ (release) and the next begins with a read of it
// (acquire): what a share wrote, every share of later stretches sees, and the caller after the section. Within a chain
// the counters of the shares take the place of done_.
//
// Waits. Each is for a claimed share (its thread runs, or the system will let it: shares do not wait for one another,
// save in ordered runs, which say for themselves why they end, and in chains) or for the next section or the end of the
// region, which the caller announces. In a chain threads wait for neighbours with a share claimed, and meanwhile do
// what is ready of shares that nobody claimed in earlier phases. So chains end: of what is left, the share with the
// lowest phase waits for nothing; who claimed it does it, and where nobody did, whoever waits in a later phase will,
// or the caller.
#pragma once

#include <atomic>
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "parallel/threads.hpp"
#include "parallel/wait.hpp"

namespace flotilla {

/// Phases of a section in which shares wait for some of the others alone.
struct PhaseChain {
    std::size_t begin = 0, end = 0; ///< phases
    /// By share, the set of its neighbours: words() words of a bit for each share.
    std::span<const std::uint64_t> near{};
    /// By share, a number for each phase of the chain: the next one after it in which the share has something to do,
    /// else the chain's end; counted from `begin`. In the first all have something to do.
    std::span<const std::int32_t> next{};

    [[nodiscard]] static std::size_t words(int shares) { return (static_cast<std::size_t>(shares) + 63) / 64; }
    [[nodiscard]] std::size_t size() const { return end - begin; }
    [[nodiscard]] std::size_t next_after(std::size_t phase, int share) const {
        const std::size_t row = static_cast<std::size_t>(share) * size();
        return begin + static_cast<std::size_t>(next[row + (phase - begin)]);
    }
    /// Whether the share has something to do in a phase, which may lie outside of the chain.
    [[nodiscard]] bool works(std::size_t phase, int share) const {
        return phase <= begin || phase >= end || next_after(phase - 1, share) == phase;
    }
};

class Crew {
  public:
    /// (phase, share, thread); a thread has one share at a time.
    using Work = CallRef<std::size_t, int, int>;

    /// Of at most `threads`. Helpers are only woken while fewer than `most_awake` threads are awake: more than there
    /// are cores would take them from each other.
    Crew(int threads, int most_awake) : most_awake_(most_awake), seats_(static_cast<std::size_t>(threads)) {}

    // The caller's, thread 0 of the region.
    void begin(int present);
    /// Calls work for all shares of phase 0, then of phase 1 and so on; `chain` may be null.
    void run(int shares, std::size_t phases, const PhaseChain* chain, const Work& work);
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
        alignas(64) std::atomic<std::uint64_t> next = 0; ///< twice the phase; + 1: claimed
        Bed bed;
        alignas(64) std::int64_t helped = 0; ///< ns in sections of several phases
    };
    /// The section. Written while none is open, between two increments of version; whoever reads the same even version
    /// before and after has one section's.
    struct alignas(64) Notice {
        std::atomic<std::uint64_t> version = 0, first = 0, done_before = 0;
        std::atomic<std::size_t> phases = 0, chain_begin = 0, chain_end = 0;
        std::atomic<const PhaseChain*> chain = nullptr;
        std::atomic<void (*)(void*, std::size_t, int, int)> function = nullptr;
        std::atomic<void*> object = nullptr;
        std::atomic<int> shares = 0;
    };
    struct Section {
        std::uint64_t first = 0, done_before = 0;
        std::size_t phases = 0, chain_begin = 0, chain_end = 0; ///< no chain: both are `phases`
        const PhaseChain* chain = nullptr;
        int shares = 0;
        Work work;

        [[nodiscard]] std::uint64_t end() const { return first + phases; }
        [[nodiscard]] bool chained(std::uint64_t phase) const {
            return first + chain_begin <= phase && phase < first + chain_end;
        }
        /// A chain is one stretch, every other phase one of its own.
        [[nodiscard]] std::size_t num_stretches() const {
            return phases - (chain_end > chain_begin ? chain_end - chain_begin - 1 : 0);
        }
        [[nodiscard]] std::size_t stretch_of(std::uint64_t phase) const {
            const std::size_t p = phase - first;
            return p < chain_begin ? p : p < chain_end ? chain_begin : p - (phases - num_stretches());
        }
        [[nodiscard]] std::uint64_t first_phase(std::size_t stretch) const {
            return first + stretch + (stretch > chain_begin ? phases - num_stretches() : 0);
        }
        /// What done_ comes to with a stretch.
        [[nodiscard]] std::uint64_t done_after(std::size_t stretch) const {
            return done_before + (stretch + 1) * static_cast<std::uint64_t>(shares);
        }
    };

    [[nodiscard]] Seat& seat(int k) { return seats_[static_cast<std::size_t>(k)]; }
    [[nodiscard]] const Seat& seat(int k) const { return seats_[static_cast<std::size_t>(k)]; }
    void publish(const Section& section);
    [[nodiscard]] bool read(std::uint64_t version, Section& section) const;
    void invite(int shares);
    [[nodiscard]] int num_awake() const;
    void help(int thread, const Section& section);
    bool claim(int share, std::uint64_t phase);
    void perform(const Section& section, std::uint64_t phase, int share, int thread);
    void finish(const Section& section, std::uint64_t phase, int share, int thread);
    void do_share(const Section& section, std::size_t stretch, int thread);
    void do_chain(const Section& section, int thread);
    void perform_in_chain(const Section& section, std::uint64_t phase, int share, int thread);
    [[nodiscard]] bool ready(const Section& section, std::uint64_t phase, int share) const;
    void take_over_ready(const Section& section, std::uint64_t before, int thread);
    bool take_over(const Section& section, std::size_t stretch, int thread);
    [[nodiscard]] bool over(const Section& section, std::size_t stretch) const {
        return done_.load() >= section.done_after(stretch);
    }

    int most_awake_;
    int present_ = 1;
    std::uint64_t next_phase_ = 1;
    std::vector<Seat> seats_;
    std::fenv_t environment_{}; ///< the caller's rounding and traps, which helpers take
    std::uint64_t version_at_begin_ = 0;
    Notice notice_;
    alignas(64) std::atomic<std::uint64_t> done_ = 0; ///< shares of stretches, of all sections
    alignas(64) std::atomic<bool> dismissed_ = false;
    alignas(64) std::atomic<int> left_ = 0; ///< helpers that have left the region
};

} // namespace flotilla
