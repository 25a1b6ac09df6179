// SPDX-License-Identifier: MIT
#include "parallel/background.hpp"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>

#include "base/floating_point.hpp"
#include "parallel/beside.hpp"

namespace flotilla {

/// Waits end: each is for a job that is running. Where none is, the thread that wants the jobs done does them.
struct Background::Jobs {
    explicit Jobs(std::size_t most) : most_waiting(most) {}

    /// Does the first job, or waits for the one that is running.
    void advance(std::unique_lock<std::mutex>& held) {
        if (running) return changed.wait(held);
        if (waiting.empty()) return;
        const std::function<void()> job = std::move(waiting.front());
        waiting.pop_front();
        if (error) return;
        running = true;
        held.unlock();
        std::exception_ptr thrown;
        try {
            const DefaultFloatingPoint environment; // TBB's threads may have another one
            job();
        } catch (...) {
            thrown = std::current_exception();
        }
        held.lock();
        error = thrown;
        running = false;
        changed.notify_all();
    }
    void rethrow() const {
        if (error) std::rethrow_exception(error);
    }

    std::size_t most_waiting;
    std::mutex lock;
    std::condition_variable changed;
    std::deque<std::function<void()>> waiting;
    bool running = false;
    bool called = false; ///< a thread is on its way
    std::exception_ptr error;
};

Background::Background(std::size_t most_waiting)
    : jobs_(std::make_shared<Jobs>(most_waiting)), beside_(std::make_unique<Beside>()) {}

Background::~Background() {
    try {
        finish();
    } catch (...) { // finish() was there to be called
    }
}

void Background::add(std::function<void()> job) {
    std::unique_lock held(jobs_->lock);
    while (!jobs_->error && jobs_->waiting.size() >= jobs_->most_waiting) jobs_->advance(held);
    jobs_->rethrow();
    jobs_->waiting.push_back(std::move(job));
    if (std::exchange(jobs_->called, true)) return;
    held.unlock();
    beside_->start([jobs = jobs_] {
        std::unique_lock own(jobs->lock);
        jobs->called = false; // a thread that adds after this finds it running or calls anew
        while (!jobs->waiting.empty() && !jobs->running) jobs->advance(own);
    });
}

void Background::finish() {
    std::unique_lock held(jobs_->lock);
    while (jobs_->running || !jobs_->waiting.empty()) jobs_->advance(held);
    jobs_->rethrow();
}

} // namespace flotilla
