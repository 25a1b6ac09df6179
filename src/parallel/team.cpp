// SPDX-License-Identifier: MIT
#include "parallel/team.hpp"

#include <atomic>
#include <exception>

#include "parallel/team_work.hpp"

namespace flotilla {
namespace {

/// A region that waited at its end for late threads for more than this share of its time did not pay: the machine is
/// busy with other work. Then some regions do without helpers, twice as many each time.
constexpr double kMostLate = 0.125;
constexpr int kLongestRest = 32;

/// Threads in regions of all teams of the process. It only steers how many threads a region asks for.
std::atomic<int> threads_in_regions = 0;

} // namespace

Team::Team(const TeamOptions& options)
    : options_(options),
      size_(std::max(options.threads, 1)),
      present_(size_),
      times_(static_cast<std::size_t>(size_)),
      crew_(size_, options.crowds ? size_ : usable_cores()),
      ordered_(std::make_unique<OrderedMemory>(size_)),
      chunks_(std::make_unique<Chunks>(size_)) {}

Team::~Team() = default;

std::vector<ThreadTimes> Team::times() const {
    std::vector<ThreadTimes> out;
    for (int k = 0; k < size_; ++k) {
        const PaddedTimes& times = times_[static_cast<std::size_t>(k)];
        out.push_back(times.value);
        out.back().busy_ms += crew_.helped_ms(k) + rate_.ms(times.busy);
    }
    return out;
}

int Team::wanted() const {
    if (!options_.yields || size_ == 1) return size_; // in another region OpenMP decides
    if (among_workers()) return 1;
    return std::clamp(size_ - threads_in_regions.load(std::memory_order_relaxed), 1, size_);
}

void Team::run_region(const CallRef<>& work) {
    if (in_region_) return work();
    const int threads = rest_left_ > 0 ? 1 : wanted();
    if (rest_left_ > 0) --rest_left_;
    threads_in_regions.fetch_add(threads, std::memory_order_relaxed);
    in_region_ = true;
    std::exception_ptr error;
    const auto guarded = [&] {
        try {
            work();
        } catch (...) {
            error = std::current_exception();
        }
    };
    if (threads == 1) {
        present_ = 1;
        guarded();
    } else {
        enter(CallRef<>::of(guarded), threads);
    }
    in_region_ = false;
    present_ = size_;
    threads_in_regions.fetch_sub(threads, std::memory_order_relaxed);
    if (error) std::rethrow_exception(error);
}

void Team::enter(const CallRef<>& work, int threads) {
    const std::int64_t begin = now_ns();
    std::int64_t late = 0;
    std::atomic<bool> begun = false;
    const auto body = [&](int thread, int granted) {
        if (thread > 0) {
            // The caller is on its way: it is a thread of this region as well.
            while (!spin(kSpinTime, [&] { return begun.load(); })) begun.wait(false);
            return crew_.serve(thread);
        }
        present_ = granted;
        crew_.begin(granted);
        begun.store(true);
        begun.notify_all();
        work();
        dismiss();
        late = crew_.join();
    };
    with_threads(threads, CallRef<int, int>::of(body));
    const bool paid = static_cast<double>(late) <= kMostLate * static_cast<double>(now_ns() - begin);
    rest_ = paid ? rest_ / 2 : std::clamp(2 * rest_, 1, kLongestRest);
    if (!paid) rest_left_ = rest_;
}

void Team::dismiss() {
    if (!in_region_ || present_ == 1) return;
    present_ = 1;
    crew_.dismiss();
}

void Team::run_chunks(const char* name, std::size_t chunks, const Task& work) {
    if (!in_region_ && size_ > 1) return region([&] { run_chunks(name, chunks, work); });
    TaskRecorder* recorder = this->recorder();
    const int threads = width(chunks);
    const std::int32_t region =
        recorder != nullptr ? recorder->begin_region(name, RegionKind::loop, static_cast<std::int32_t>(chunks), nullptr)
                            : -1;
    const auto run_one = [&](std::size_t chunk, int share) {
        const std::int64_t begin = recorder != nullptr ? recorder->now() : 0;
        work(chunk, share);
        if (recorder != nullptr)
            recorder->add_task(share, {begin, recorder->now(), region, static_cast<std::int32_t>(chunk)});
    };
    if (threads == 1) {
        const TickWatch watch(ticks_of(0));
        for (std::size_t chunk = 0; chunk < chunks; ++chunk) run_one(chunk, 0);
        times_of(0).tasks += static_cast<std::int64_t>(chunks);
    } else {
        FirstError error;
        chunks_->start(chunks, threads);
        const auto section = [&](std::size_t, int share, int) {
            ThreadTimes& times = times_of(share);
            const TickWatch watch(ticks_of(share));
            chunks_->take(static_cast<std::size_t>(share), [&](std::size_t chunk, std::size_t whose) {
                ++times.tasks;
                times.stolen += whose != static_cast<std::size_t>(share) ? 1 : 0;
                if (error.before(chunk)) return;
                try {
                    run_one(chunk, share);
                } catch (...) {
                    error.keep(chunk);
                }
            });
        };
        crew_.run(threads, 1, nullptr, Crew::Work::of(section));
        error.rethrow();
    }
    if (recorder != nullptr) recorder->end_region(region);
}

void Team::run_order(const char* name, const TaskOrder& order, const Task& work) {
    if (order.size() == 0) return;
    if (!in_region_ && size_ > 1) return region([&] { run_order(name, order, work); });
    TaskRecorder* recorder = this->recorder();
    const auto tasks = static_cast<std::int32_t>(order.size());
    const std::int32_t region =
        recorder != nullptr ? recorder->begin_region(name, RegionKind::ordered, tasks, order.successors().data()) : -1;
    const int threads = width(order.size());
    if (threads == 1) {
        const TickWatch watch(ticks_of(0));
        for (std::int32_t task = 0; task < tasks; ++task) {
            const std::int64_t from = recorder != nullptr ? recorder->now() : 0;
            work(static_cast<std::size_t>(task), 0);
            if (recorder != nullptr) recorder->add_task(0, {from, recorder->now(), region, task});
        }
        times_of(0).tasks += tasks;
    } else {
        Ordered run(*this, order, work, threads, region);
        const auto section = [&](std::size_t, int share, int thread) { run.serve(share, thread); };
        crew_.run(threads, 1, nullptr, Crew::Work::of(section));
        run.rethrow();
    }
    if (recorder != nullptr) recorder->end_region(region);
}

void Team::run_phases(int shares, std::size_t phases, const PhaseChain* chain, const CallRef<std::size_t, int>& work) {
    if (!in_region_ && size_ > 1 && shares > 1) return region([&] { run_phases(shares, phases, chain, work); });
    const TickWatch watch(ticks_of(0));
    if (shares == 1 || phases == 0 || present_ == 1) {
        for (std::size_t phase = 0; phase < phases; ++phase)
            for (int share = 0; share < shares; ++share)
                if (chain == nullptr || chain->works(phase, share)) work(phase, share);
    } else {
        const auto section = [&](std::size_t phase, int share, int) { work(phase, share); };
        crew_.run(shares, phases, chain, Crew::Work::of(section));
    }
}

} // namespace flotilla
