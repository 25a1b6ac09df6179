// SPDX-License-Identifier: MIT
#include "collision/first_hits.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "pair/divided.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16, kPlaceGrain = 512; // pairs of a task

} // namespace

void FirstHits::start() {
    hitting_.clear();
    seen_hitting_.clear();
}

FirstHits::Looked FirstHits::look(const StepView& view, Workers& workers, std::span<const ListedPair> list) {
    by_thread_before_.swap(by_thread_);
    before_.swap(hitting_);
    seen_before_.swap(seen_hitting_);
    by_thread_.resize(workers.each.size());
    for (OfThread& t : by_thread_) t.hits.clear(), t.looked = {};
    seen_.resize(list.size());
    const auto closes = [&](std::size_t i, int thread) {
        if (verdict(view.trajectories, *list[i].record) != Verdict::open) return false;
        return look_at_pair(view, workers[thread], thread, list[i], i);
    };
    Division* const division = workers.team.division();
    std::size_t closed = 0;
    if (division != nullptr) {
        std::ranges::fill(seen_, Seen{});
        closed = close_divided(PairWork::queries, view, workers.team, list, closes);
    } else {
        workers.team.for_each("look for first hits", list.size(), kPairGrain, [&](std::size_t i, int thread) {
            seen_[i] = {};
            closes(i, thread);
        });
    }
    Looked all;
    for (const OfThread& t : by_thread_) {
        all.examined += t.looked.examined;
        all.closed += t.looked.closed;
    }
    if (division != nullptr) all = share(*division, all.examined, closed);
    find_first(view, workers, list);
    return all;
}

/// Whether it closed the pair.
bool FirstHits::look_at_pair(const StepView& view, Worker& worker, int thread, const ListedPair& listed,
                             std::size_t place) {
    OfThread& out = by_thread_[at(thread)];
    const CollisionFinding* before = known(view, listed.pair);
    if (before == nullptr) ++out.looked.examined;
    const CollisionFinding found = before != nullptr ? *before : look_at(view, worker, *listed.record);
    if (!found.urgent) {
        ++out.looked.closed;
        return true;
    }
    const Landing& landing = *found.landing; // where something calls for an impulse there is one
    const double room = landing.lengths.separation / std::max(landing.way * view.dt, landing.lengths.separation);
    seen_[place] = {landing.time, room, thread, static_cast<std::int32_t>(out.hits.size())};
    const auto version = [&](std::int32_t body) { return view.trajectories.version(at(body)); };
    out.hits.push_back({listed.pair, version(listed.pair.a), version(listed.pair.b), found});
    return false;
}

/// Tells all ranks of the hits that this one found, without what it found of them. Returns what all looked at.
FirstHits::Looked FirstHits::share(const Division& division, std::size_t examined, std::size_t closed) {
    struct Told {
        std::int64_t place = 0;
        double time = 0, room = 0;
    };
    ByteWriter out;
    out.add(examined);
    for (std::size_t i = 0; i < seen_.size(); ++i)
        if (seen_[i].time < kNever) out.add(Told{static_cast<std::int64_t>(i), seen_[i].time, seen_[i].room});
    const GatheredBytes told = gather_bytes(division.ranks(), out.take());
    Looked all{.examined = 0, .closed = closed};
    for (int rank = 0; rank < division.size(); ++rank) {
        auto in = reader_of(told.of(rank));
        in.read(examined);
        all.examined += examined;
        while (!in.rest().empty()) {
            Told hit;
            in.read(hit);
            if (rank != division.rank()) seen_[static_cast<std::size_t>(hit.place)] = {hit.time, hit.room, -1, -1};
        }
    }
    return all;
}

/// Of each body the earliest. A minimum: it does not depend on the order.
void FirstHits::find_first(const StepView& view, Workers& workers, std::span<const ListedPair> list) {
    hitting_.clear();
    seen_hitting_.clear();
    const auto hits = [&](std::size_t i) { return seen_[i].time < kNever; };
    const ListLoop loop{&workers.team, "first hits", kPlaceGrain, places_};
    compact_if(loop, list.size(), hits, hitting_, 0, [&](std::size_t i) { return list[i]; });
    compact_if(loop, list.size(), hits, seen_hitting_, 0, [&](std::size_t i) { return seen_[i]; });
    first_.resize(view.model.size());
    for (const ListedPair& hit : hitting_)
        for (const std::int32_t body : {hit.pair.a, hit.pair.b})
            first_[at(body)] = {kNever, view.trajectories.version(at(body))};
    for (std::size_t k = 0; k < hitting_.size(); ++k)
        for (const std::int32_t body : {hitting_[k].pair.a, hitting_[k].pair.b})
            first_[at(body)].time = std::min(first_[at(body)].time, seen_hitting_[k].time);
}

const CollisionFinding* FirstHits::known(const StepView& view, const CandidatePair& pair) const {
    const auto it = std::ranges::lower_bound(before_, pair, {}, &ListedPair::pair);
    if (it == before_.end() || !(it->pair == pair)) return nullptr;
    const Seen& seen = seen_before_[static_cast<std::size_t>(it - before_.begin())];
    if (seen.thread < 0) return nullptr;
    const Hit& hit = by_thread_before_[at(seen.thread)].hits[at(seen.number)];
    const auto moved = [&](std::int32_t body, std::uint64_t version) {
        return view.trajectories.version(at(body)) != version;
    };
    return moved(pair.a, hit.version_a) || moved(pair.b, hit.version_b) ? nullptr : &hit.finding;
}

const CollisionFinding* FirstHits::found(const StepView& view, std::size_t hit) const {
    const Seen& seen = seen_hitting_[hit];
    const CandidatePair& pair = hitting_[hit].pair;
    const auto moved = [&](std::int32_t body) {
        return view.trajectories.version(at(body)) != first_[at(body)].version;
    };
    if (seen.thread < 0 || moved(pair.a) || moved(pair.b)) return nullptr;
    return &by_thread_[at(seen.thread)].hits[at(seen.number)].finding;
}

bool FirstHits::waits(const StepView& view, std::size_t hit) const {
    const Seen& seen = seen_hitting_[hit];
    bool moved = false, later = false;
    for (const std::int32_t body : {hitting_[hit].pair.a, hitting_[hit].pair.b}) {
        if (!view.model.bodies[at(body)].movable()) continue;
        moved |= view.trajectories.version(at(body)) != first_[at(body)].version;
        later |= first_[at(body)].time < seen.time - seen.room;
    }
    return later && !moved;
}

} // namespace flotilla
