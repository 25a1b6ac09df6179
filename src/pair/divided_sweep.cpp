// SPDX-License-Identifier: MIT
#include "pair/divided_sweep.hpp"

#include <algorithm>
#include <memory>
#include <tuple>

#include "base/index.hpp"

namespace flotilla {
namespace {

/// The last colour takes all pairs that find none free: its tasks may share clusters.
constexpr std::uint8_t kChain = kColors - 1;

} // namespace

DividedSweep::DividedSweep(const Division& division, const SweepBuffers& buffers, const SharedSweep& shared)
    : division_(division), buffers_(buffers), shared_(shared) {
    find_waves();
}

void DividedSweep::find_waves() {
    const auto& tasks = buffers_.tasks;
    const auto color = [&](const SweepBuffers::SweepTask& t) { return buffers_.color[at(t.place)]; };
    std::vector<std::size_t> wave_of(tasks.size());
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        const bool goes_on = t > 0 && tasks[t].round == tasks[t - 1].round && color(tasks[t]) == color(tasks[t - 1]) &&
                             color(tasks[t]) != kChain;
        if (!goes_on) waves_.push_back({own_.size(), own_.size()});
        wave_of[t] = waves_.size() - 1;
        const auto [a, b] = buffers_.things[at(tasks[t].place)];
        if (!division_.owns(a, b)) continue;
        own_.push_back(static_cast<std::int32_t>(t));
        pairs_.push_back(tasks[t].place);
        waves_.back().end_own = own_.size();
    }
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    find_transfers(wave_of);
}

/// Backwards through the tasks, with the rank and the wave of the next one that uses each cluster.
void DividedSweep::find_transfers(const std::vector<std::size_t>& wave_of) {
    struct User {
        int rank = -1;
        std::size_t wave = 0;
    };
    const int rank = division_.rank();
    std::vector<User> next(buffers_.used_colors.size());
    for (std::size_t t = buffers_.tasks.size(); t-- > 0;) {
        const auto& things = buffers_.things[at(buffers_.tasks[t].place)];
        const int owner = division_.owner(things[0], things[1]);
        for (const std::int32_t cluster : things) {
            if (cluster < 0) continue;
            const User user = std::exchange(next[at(cluster)], {owner, wave_of[t]});
            if (user.rank < 0 && owner == rank) last_.push_back(cluster);
            if (user.rank < 0 || user.rank == owner) continue;
            if (owner == rank) out_.push_back({wave_of[t], user.wave, user.rank, cluster});
            if (user.rank == rank) in_.push_back({wave_of[t], user.wave, owner, cluster});
        }
    }
    if (division_.log() != nullptr) begin_log(wave_of);
    const auto order = [](const Transfer& x, const Transfer& y) {
        return std::tie(x.wave, x.partner, x.cluster) < std::tie(y.wave, y.partner, y.cluster);
    };
    std::sort(out_.begin(), out_.end(), order);
    std::sort(in_.begin(), in_.end(), order);
    sent_ = messages_of(out_);
    received_ = messages_of(in_);
    for (Message& message : received_) receive(message);
    std::stable_sort(received_.begin(), received_.end(),
                     [](const Message& x, const Message& y) { return x.needed < y.needed; });
}

std::vector<DividedSweep::Message> DividedSweep::messages_of(std::span<const Transfer> transfers) {
    std::vector<Message> messages;
    for (std::size_t begin = 0, end = 0; begin < transfers.size(); begin = end) {
        Message& message = messages.emplace_back();
        message.needed = transfers[begin].needed;
        for (; end < transfers.size() && transfers[end].wave == transfers[begin].wave &&
               transfers[end].partner == transfers[begin].partner;
             ++end)
            message.needed = std::min(message.needed, transfers[end].needed);
        message.transfers = transfers.subspan(begin, end - begin);
    }
    return messages;
}

/// Begins to.
void DividedSweep::receive(Message& message) {
    std::size_t size = 0;
    for (const Transfer& t : message.transfers) size += size_of_cluster(shared_.movers.clusters(), t.cluster);
    message.bytes.resize(size);
    const RankMessage from{message.transfers.front().partner, message.bytes};
    message.exchange = division_.ranks().prepare({}, std::span(&from, 1));
    message.exchange->start();
}

void DividedSweep::take(std::size_t wave) {
    for (; next_received_ < received_.size() && received_[next_received_].needed <= wave; ++next_received_) {
        Message& message = received_[next_received_];
        message.exchange->wait();
        std::span<const std::byte> rest = message.bytes;
        for (const Transfer& t : message.transfers) {
            read_cluster(rest, t.cluster, shared_.movers);
            rest = rest.subspan(size_of_cluster(shared_.movers.clusters(), t.cluster));
        }
    }
}

void DividedSweep::hand_on(std::size_t wave) {
    for (; next_sent_ < sent_.size() && sent_[next_sent_].transfers.front().wave == wave; ++next_sent_) {
        Message& message = sent_[next_sent_];
        ByteWriter writer;
        for (const Transfer& t : message.transfers)
            write_cluster(writer, shared_.movers.clusters(), shared_.movers.trajectories(), t.cluster);
        message.bytes = writer.take();
        const RankMessage to{message.transfers.front().partner, message.bytes};
        message.exchange = division_.ranks().prepare(std::span(&to, 1), {});
        message.exchange->start();
    }
}

void DividedSweep::write_own(ByteWriter& out) const {
    out.add(static_cast<std::uint64_t>(pairs_.size()));
    for (const std::int32_t place : pairs_) {
        out.add(place);
        out.add(RecordState(shared_.record(at(place))));
        if (!shared_.result) continue;
        const std::span<const std::byte> result = shared_.result(at(place));
        out.add_bytes(result.data(), result.size());
    }
    out.add(static_cast<std::uint64_t>(last_.size()));
    for (const std::int32_t cluster : last_) {
        out.add(cluster);
        write_cluster(out, shared_.movers.clusters(), shared_.movers.trajectories(), cluster);
    }
}

void DividedSweep::read_other(std::span<const std::byte> bytes, CountedWork& counted) {
    auto in = reader_of(bytes);
    std::uint64_t pairs = 0, clusters = 0;
    in.read(pairs);
    for (; pairs > 0; --pairs) {
        std::int32_t place = 0;
        RecordState state;
        in.read(place), in.read(state);
        state.put(shared_.record(at(place)));
        if (!shared_.result) continue;
        for (std::byte& byte : shared_.result(at(place))) in.read(byte);
    }
    in.read(clusters);
    for (; clusters > 0; --clusters) {
        std::int32_t cluster = 0;
        in.read(cluster);
        read_cluster(in.rest(), cluster, shared_.movers);
        in.skip(size_of_cluster(shared_.movers.clusters(), cluster));
    }
    CountedWork other;
    other.read(in);
    counted.add(other);
}

void DividedSweep::begin_log(const std::vector<std::size_t>& wave_of) {
    const std::int64_t begin = thread_ns();
    for (std::size_t t = 0; t < wave_of.size(); ++t)
        logged_.push_back({wave_of[t], buffers_.things[at(buffers_.tasks[t].place)], 0});
    for (const std::int32_t cluster : last_) {
        const std::int32_t first = shared_.movers.clusters()[cluster].members.front();
        versions_.push_back(shared_.movers.trajectories().version(at(first)));
    }
    division_.log()->own_ns += thread_ns() - begin;
}

void DividedSweep::log_task(std::int32_t task) {
    logged_[at(task)].ns = std::exchange(division_.log()->items, {}).front().ns;
}

void DividedSweep::log() const {
    const std::int64_t begin = thread_ns();
    LoggedSweep sweep{logged_, 0, 0, told_};
    const Clusters& clusters = shared_.movers.clusters();
    for (std::size_t k = 0; k < last_.size(); ++k) {
        const std::int32_t first = clusters[last_[k]].members.front();
        if (shared_.movers.trajectories().version(at(first)) != versions_[k]) ++sweep.changed;
        sweep.cluster_bytes = size_of_cluster(clusters, last_[k]);
    }
    division_.log()->sections.emplace_back(std::move(sweep));
    division_.log()->own_ns += thread_ns() - begin;
}

void DividedSweep::share(Workers& workers, const CountedWork& before) {
    for (Message& message : sent_) message.exchange->wait();
    CountedWork counted(workers);
    ByteWriter out;
    write_own(out);
    counted.write(out);
    const GatheredBytes told = gather_bytes(division_.ranks(), out.take());
    told_ = told.all.size();
    for (int rank = 0; rank < division_.size(); ++rank)
        if (rank != division_.rank()) read_other(told.of(rank), counted);
    counted.add(before);
    counted.give(workers[0]);
}

} // namespace flotilla
