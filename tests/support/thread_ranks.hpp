// SPDX-License-Identifier: MIT
// Ranks that are threads of one process, so that what is divided among ranks is tested without MPI, and where builds
// with sanitizers see all of it.
#pragma once

#include <barrier>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "parallel/ranks.hpp"

namespace flotilla::test {

/// What the ranks have in common.
class Post {
  public:
    explicit Post(int size) : all_here_(size), own_(static_cast<std::size_t>(size)) {}

    void put(int from, int to, std::vector<std::byte> bytes) {
        const std::lock_guard held(lock_);
        sent_[{from, to}].push_back(std::move(bytes));
        arrived_.notify_all();
    }
    /// The number of the next message from one to another that is to be received.
    std::size_t ticket(int from, int to) {
        const std::lock_guard held(lock_);
        return tickets_[{from, to}]++;
    }
    void take(int from, int to, std::size_t ticket, std::span<std::byte> bytes) {
        std::unique_lock held(lock_);
        arrived_.wait(held, [&] { return sent_[{from, to}].size() > ticket; });
        const std::vector<std::byte>& message = sent_[{from, to}][ticket];
        if (message.size() != bytes.size()) std::terminate(); // MPI would say so, or not
        std::copy(message.begin(), message.end(), bytes.begin());
    }
    void gather(int rank, std::span<const std::byte> own, std::span<std::byte> all) {
        own_[static_cast<std::size_t>(rank)] = own;
        all_here_.arrive_and_wait();
        auto place = all.begin();
        for (const auto& of_rank : own_) place = std::copy(of_rank.begin(), of_rank.end(), place);
        all_here_.arrive_and_wait();
    }

  private:
    using Way = std::pair<int, int>;
    std::barrier<> all_here_;
    std::vector<std::span<const std::byte>> own_;
    std::mutex lock_;
    std::condition_variable arrived_;
    std::map<Way, std::vector<std::vector<std::byte>>> sent_;
    std::map<Way, std::size_t> tickets_;
};

class ThreadRanks : public Ranks {
  public:
    ThreadRanks(int rank, int size, Post& post) : Ranks(rank, size), post_(post) {}

    std::unique_ptr<RankExchange> prepare(std::span<const RankMessage> sends,
                                          std::span<const RankMessage> receives) override {
        return std::make_unique<Exchange>(rank(), post_, sends, receives);
    }
    void gather(std::span<const std::byte> own, std::span<const std::size_t>, std::span<std::byte> all) override {
        post_.gather(rank(), own, all);
    }

  private:
    class Exchange : public RankExchange {
      public:
        Exchange(int rank, Post& post, std::span<const RankMessage> sends, std::span<const RankMessage> receives)
            : rank_(rank),
              post_(post),
              sends_(sends.begin(), sends.end()),
              receives_(receives.begin(), receives.end()) {}
        void start() override {
            for (const RankMessage& m : sends_) post_.put(rank_, m.partner, {m.bytes.begin(), m.bytes.end()});
            tickets_.clear();
            for (const RankMessage& m : receives_) tickets_.push_back(post_.ticket(m.partner, rank_));
        }
        void wait() override {
            for (std::size_t k = 0; k < receives_.size(); ++k)
                post_.take(receives_[k].partner, rank_, tickets_[k], receives_[k].bytes);
        }

      private:
        int rank_;
        Post& post_;
        std::vector<RankMessage> sends_, receives_;
        std::vector<std::size_t> tickets_;
    };

    Post& post_;
};

/// Calls work(ranks) on a thread for each of `size` ranks, and returns when all have ended.
template <class Work>
void on_ranks(int size, Work&& work) {
    Post post(size);
    std::vector<std::thread> threads;
    for (int rank = 0; rank < size; ++rank)
        threads.emplace_back([&, rank] {
            ThreadRanks ranks(rank, size, post);
            work(ranks);
        });
    for (std::thread& thread : threads) thread.join();
}

} // namespace flotilla::test
