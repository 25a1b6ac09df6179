// SPDX-License-Identifier: MIT
#include "parallel/crew.hpp"

#include <algorithm>
#include <bit>
#include <thread>

namespace flotilla {
namespace {

/// ns that a thread lets the owner of a share come before it does the share itself: longer than a signal from core to
/// core takes.
constexpr std::int64_t kPatience = 500;
/// The same in chains, whose shares may well wait so long for one another: to look for shares to take over reads what
/// every thread writes.
constexpr std::int64_t kPatienceInChain = 16 * kPatience;

} // namespace

void Crew::begin(int present) {
    present_ = present;
    version_at_begin_ = notice_.version.load(std::memory_order_relaxed);
    dismissed_.store(false, std::memory_order_relaxed);
    left_.store(0, std::memory_order_relaxed);
    std::fegetenv(&environment_);
}

void Crew::publish(const Section& section) {
    Notice& n = notice_;
    const std::uint64_t version = n.version.load(std::memory_order_relaxed);
    n.version.store(version + 1, std::memory_order_relaxed);
    n.first.store(section.first, std::memory_order_release);
    n.done_before.store(section.done_before, std::memory_order_release);
    n.phases.store(section.phases, std::memory_order_release);
    n.chain_begin.store(section.chain_begin, std::memory_order_release);
    n.chain_end.store(section.chain_end, std::memory_order_release);
    n.chain.store(section.chain, std::memory_order_release);
    n.function.store(section.work.function, std::memory_order_release);
    n.object.store(section.work.object, std::memory_order_release);
    n.shares.store(section.shares, std::memory_order_release);
    n.version.store(version + 2); // before sleepers are searched for
}

// A value of a later section synchronises with its writing, which comes after the version became odd: the second read
// of the version sees that.
bool Crew::read(std::uint64_t version, Section& section) const {
    const Notice& n = notice_;
    section.first = n.first.load(std::memory_order_acquire);
    section.done_before = n.done_before.load(std::memory_order_acquire);
    section.phases = n.phases.load(std::memory_order_acquire);
    section.chain_begin = n.chain_begin.load(std::memory_order_acquire);
    section.chain_end = n.chain_end.load(std::memory_order_acquire);
    section.chain = n.chain.load(std::memory_order_acquire);
    section.work.function = n.function.load(std::memory_order_acquire);
    section.work.object = n.object.load(std::memory_order_acquire);
    section.shares = n.shares.load(std::memory_order_acquire);
    return n.version.load(std::memory_order_acquire) == version;
}

int Crew::num_awake() const {
    return static_cast<int>(std::count_if(seats_.begin(), seats_.begin() + present_,
                                          [](const Seat& s) { return s.bed.state() == Bed::up; }));
}

void Crew::invite(int shares) {
    const int most = std::min(shares, present_);
    int awake = -1;
    for (int k = 1; k < most; ++k) {
        if (seat(k).bed.state() != Bed::idle) continue;
        if (awake < 0) awake = num_awake();
        if (awake >= most_awake_) return;
        awake += seat(k).bed.wake(Bed::idle) ? 1 : 0;
    }
}

void Crew::wake_one() {
    if (num_awake() >= most_awake_) return;
    for (int k = 0; k < present_; ++k)
        if (seat(k).bed.wake(Bed::in_run)) return;
}

void Crew::wake_all_in_run() {
    for (int k = 0; k < present_; ++k) seat(k).bed.wake(Bed::in_run);
}

bool Crew::claim(int share, std::uint64_t phase) {
    std::uint64_t free = 2 * phase;
    return seat(share).next.load(std::memory_order_relaxed) == free &&
           seat(share).next.compare_exchange_strong(free, free + 1, std::memory_order_acq_rel);
}

void Crew::perform(const Section& section, std::uint64_t phase, int share, int thread) {
    section.work(static_cast<std::size_t>(phase - section.first), share, thread);
    finish(section, phase, share, thread);
}

void Crew::finish(const Section& section, std::uint64_t phase, int share, int thread) {
    std::uint64_t next = phase + 1;
    bool goes_on = false; // in the same stretch
    if (section.chained(phase)) {
        next = section.first + section.chain->next_after(phase - section.first, share);
        goes_on = section.chained(next);
    }
    seat(share).next.store(2 * next, std::memory_order_release);
    if (goes_on) return;
    if (done_.fetch_add(1) + 1 == section.done_after(section.stretch_of(phase)) && thread != 0)
        seat(0).bed.wake(Bed::at_end);
}

/// Of a claimed share: whether its neighbours have done what they have in the phases before.
bool Crew::ready(const Section& section, std::uint64_t phase, int share) const {
    const std::size_t words = PhaseChain::words(section.shares);
    for (std::size_t w = 0; w < words; ++w)
        for (std::uint64_t set = section.chain->near[static_cast<std::size_t>(share) * words + w]; set != 0;
             set &= set - 1)
            if (seat(static_cast<int>(64 * w) + std::countr_zero(set)).next.load(std::memory_order_acquire) < 2 * phase)
                return false;
    return true;
}

void Crew::perform_in_chain(const Section& section, std::uint64_t phase, int share, int thread) {
    const auto is_ready = [&] { return ready(section, phase, share); };
    while (!spin(kPatienceInChain, is_ready)) take_over_ready(section, phase, thread);
    perform(section, phase, share, thread);
}

/// With a share claimed: does what is ready in phases before of shares that nobody claimed, or gives the core away.
void Crew::take_over_ready(const Section& section, std::uint64_t before, int thread) {
    bool any = false;
    for (int share = 0; share < section.shares; ++share) {
        const std::uint64_t next = seat(share).next.load(std::memory_order_acquire);
        if (next % 2 != 0 || next >= 2 * before || !ready(section, next / 2, share) || !claim(share, next / 2))
            continue;
        perform(section, next / 2, share, thread);
        any = true;
    }
    if (!any) std::this_thread::yield();
}

/// The thread's own share of a chain, until it is done or others do it.
void Crew::do_chain(const Section& section, int thread) {
    const std::uint64_t end = 2 * (section.first + section.chain_end);
    for (;;) {
        const std::uint64_t next = seat(thread).next.load(std::memory_order_acquire);
        if (next >= end) return;
        if (next % 2 == 0 && claim(thread, next / 2))
            perform_in_chain(section, next / 2, thread, thread);
        else if (!spin(spin_time(), [&] { return seat(thread).next.load(std::memory_order_relaxed) != next; }))
            return;
    }
}

void Crew::do_share(const Section& section, std::size_t stretch, int thread) {
    const std::uint64_t phase = section.first_phase(stretch);
    if (section.chained(phase))
        do_chain(section, thread);
    else if (claim(thread, phase))
        perform(section, phase, thread, thread);
}

/// Does the shares that nobody claimed, of a chain a phase of each; whether there were any.
bool Crew::take_over(const Section& section, std::size_t stretch, int thread) {
    bool any = false;
    const std::uint64_t first = section.first_phase(stretch);
    for (int share = 0; share < section.shares; ++share) {
        const std::uint64_t phase =
            section.chained(first) ? seat(share).next.load(std::memory_order_acquire) / 2 : first;
        if (phase != first && !section.chained(phase)) continue;
        if (!claim(share, phase)) continue;
        any = true;
        if (section.chained(first))
            perform_in_chain(section, phase, share, thread);
        else
            perform(section, phase, share, thread);
    }
    return any;
}

void Crew::run(int shares, std::size_t phases, const PhaseChain* chain, const Work& work) {
    const bool chained = chain != nullptr && chain->size() > 0;
    const Section section{.first = next_phase_,
                          .done_before = done_.load(std::memory_order_relaxed),
                          .phases = phases,
                          .chain_begin = chained ? chain->begin : phases,
                          .chain_end = chained ? chain->end : phases,
                          .chain = chained ? chain : nullptr,
                          .shares = shares,
                          .work = work};
    next_phase_ += phases;
    for (int k = 0; k < shares; ++k)
        if (seat(k).next.load(std::memory_order_relaxed) != 2 * section.first)
            seat(k).next.store(2 * section.first, std::memory_order_relaxed);
    publish(section);
    invite(shares);
    bool late = phases == 1; // whether owners seem not to be there; one phase's shares share out their own work
    for (std::size_t s = 0; s < section.num_stretches(); ++s) {
        const auto is_over = [&] { return over(section, s); };
        const bool in_chain = section.chained(section.first_phase(s));
        do_share(section, s, 0);
        if (is_over() || (!late && spin(in_chain ? kPatienceInChain : kPatience, is_over))) continue;
        late = take_over(section, s, 0);
        while (in_chain && !spin(kPatienceInChain, is_over)) // what is claimed now may be free in its next phase
            if (!take_over(section, s, 0)) std::this_thread::yield();
        while (!spin(spin_time(), is_over)) seat(0).bed.sleep(Bed::at_end, is_over);
    }
}

void Crew::help(int thread, const Section& section) {
    const std::uint64_t done = done_.load(std::memory_order_acquire) - section.done_before;
    const std::size_t stretches = section.num_stretches();
    std::size_t s = std::min<std::size_t>(stretches, done / static_cast<unsigned>(section.shares));
    for (bool late = false; s < stretches; ++s) {
        const auto is_over = [&] { return over(section, s); };
        const bool in_chain = section.chained(section.first_phase(s));
        do_share(section, s, thread);
        if (s + 1 == stretches) return;
        if (is_over() || (!late && spin(in_chain ? kPatienceInChain : kPatience, is_over))) continue;
        late = take_over(section, s, thread);
        if (!spin(spin_time(), is_over)) return; // others do without
    }
}

void Crew::serve(int thread) {
    std::fenv_t own;
    std::fegetenv(&own);
    std::fesetenv(&environment_);
    std::uint64_t seen = version_at_begin_;
    const auto called = [&] {
        const std::uint64_t version = notice_.version.load();
        return (version != seen && version % 2 == 0) || dismissed_.load();
    };
    for (;;) {
        while (!spin(spin_time(), called)) seat(thread).bed.sleep(Bed::idle, called);
        if (dismissed_.load()) break;
        const std::uint64_t version = notice_.version.load(std::memory_order_acquire);
        Section section;
        if (version % 2 != 0 || version == seen || !read(version, section)) continue;
        seen = version;
        if (thread >= section.shares) continue;
        const std::int64_t begin = section.phases > 1 ? now_ns() : 0;
        help(thread, section);
        if (begin > 0) seat(thread).helped += now_ns() - begin;
    }
    std::fesetenv(&own);
    if (left_.fetch_add(1) + 2 == present_) seat(0).bed.wake(Bed::at_end);
}

void Crew::dismiss() {
    dismissed_.store(true);
    for (int k = 1; k < present_; ++k) seat(k).bed.wake(Bed::idle);
}

std::int64_t Crew::join() {
    const auto all_left = [&] { return left_.load() + 1 == present_; };
    if (all_left()) return 0;
    const std::int64_t begin = now_ns();
    while (!spin(spin_time(), all_left)) seat(0).bed.sleep(Bed::at_end, all_left);
    return now_ns() - begin;
}

} // namespace flotilla
