// SPDX-License-Identifier: MIT
#include "parallel/crew.hpp"

#include <algorithm>

namespace flotilla {
namespace {

/// ns that a thread lets the owner of a share come before it does the share itself: longer than a signal from core to
/// core takes.
constexpr std::int64_t kPatience = 500;

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
    return seat(share).next.load(std::memory_order_relaxed) == phase &&
           seat(share).next.compare_exchange_strong(phase, phase + 1, std::memory_order_acq_rel);
}

void Crew::perform(const Section& section, std::uint64_t phase, int share, int thread) {
    section.work(static_cast<std::size_t>(phase - section.first), share, thread);
    if (done_.fetch_add(1) + 1 == section.done_after(phase) && thread != 0) seat(0).bed.wake(Bed::at_end);
}

/// Does the shares that nobody claimed; whether there were any.
bool Crew::take_over(const Section& section, std::uint64_t phase, int thread) {
    bool any = false;
    for (int share = 0; share < section.shares; ++share)
        if (claim(share, phase)) {
            perform(section, phase, share, thread);
            any = true;
        }
    return any;
}

void Crew::run(int shares, std::size_t phases, const Work& work) {
    const Section section{next_phase_, done_.load(std::memory_order_relaxed), phases, shares, work};
    next_phase_ += phases;
    for (int k = 0; k < shares; ++k)
        if (seat(k).next.load(std::memory_order_relaxed) != section.first)
            seat(k).next.store(section.first, std::memory_order_relaxed);
    publish(section);
    invite(shares);
    bool late = phases == 1; // whether owners seem not to be there; one phase's shares share out their own work
    for (std::uint64_t p = section.first; p < section.end(); ++p) {
        const auto is_over = [&] { return over(section, p); };
        if (claim(0, p)) perform(section, p, 0, 0);
        if (is_over() || (!late && spin(kPatience, is_over))) continue;
        late = take_over(section, p, 0);
        while (!spin(spin_time(), is_over)) seat(0).bed.sleep(Bed::at_end, is_over);
    }
}

void Crew::help(int thread, const Section& section) {
    const std::uint64_t done = done_.load(std::memory_order_acquire) - section.done_before;
    std::uint64_t p =
        section.first + std::min<std::uint64_t>(section.phases, done / static_cast<unsigned>(section.shares));
    for (bool late = false; p < section.end(); ++p) {
        const auto is_over = [&] { return over(section, p); };
        if (claim(thread, p)) perform(section, p, thread, thread);
        if (p + 1 == section.end()) return;
        if (is_over() || (!late && spin(kPatience, is_over))) continue;
        late = take_over(section, p, thread);
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
