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

void FirstHits::look(const StepView& view, Workers& workers, std::span<const ListedPair> list) {
    hits_before_.swap(hits_);
    before_.swap(hitting_);
    hits_.resize(workers.each.size());
    for (std::vector<Hit>& hits : hits_) hits.clear();
    seen_.assign(list.size(), {});
    const auto closes = [&](std::size_t i, int thread) {
        if (verdict(view.trajectories, *list[i].record) != Verdict::open) return false;
        return look_at_pair(view, workers[thread], thread, list[i], i);
    };
    if (Division* division = workers.team.division()) {
        close_divided(PairWork::queries, view, workers.team, list, closes);
        share_times(*division, list);
    } else {
        workers.team.for_each("look for first hits", list.size(), kPairGrain,
                              [&](std::size_t i, int thread) { closes(i, thread); });
    }
    find_first(view, workers, list);
}

/// Whether it closed the pair.
bool FirstHits::look_at_pair(const StepView& view, Worker& worker, int thread, const ListedPair& listed,
                             std::size_t place) {
    const CollisionFinding* before = known(view, listed.pair);
    if (before == nullptr) ++worker.counters.pairs;
    const CollisionFinding found = before != nullptr ? *before : look_at(view, worker, *listed.record);
    if (!found.urgent) return true;
    std::vector<Hit>& hits = hits_[at(thread)];
    const Landing& landing = *found.landing; // where something calls for an impulse there is one
    const double room = landing.lengths.separation / std::max(landing.way * view.dt, landing.lengths.separation);
    seen_[place] = {landing.time, room, thread, static_cast<std::int32_t>(hits.size())};
    const auto version = [&](std::int32_t body) { return view.trajectories.version(at(body)); };
    hits.push_back({listed.pair, version(listed.pair.a), version(listed.pair.b), found});
    return false;
}

/// Tells all ranks of the hits that this one found, without what it found of them.
void FirstHits::share_times(const Division& division, std::span<const ListedPair> list) {
    struct Told {
        std::int32_t place = 0;
        double time = 0, room = 0;
    };
    ByteWriter out;
    for (std::size_t i = 0; i < list.size(); ++i)
        if (seen_[i].hits()) out.add(Told{static_cast<std::int32_t>(i), seen_[i].time, seen_[i].room});
    const GatheredBytes told = gather_bytes(division.ranks(), out.take());
    for (int rank = 0; rank < division.size(); ++rank) {
        if (rank == division.rank()) continue;
        auto in = reader_of(told.of(rank));
        while (!in.rest().empty()) {
            Told hit;
            in.read(hit);
            seen_[at(hit.place)] = {hit.time, hit.room, -1, -1};
        }
    }
}

/// Of each body the earliest. A minimum: it does not depend on the order.
void FirstHits::find_first(const StepView& view, Workers& workers, std::span<const ListedPair> list) {
    hitting_.clear();
    compact_if(
        {&workers.team, "first hits", kPlaceGrain, places_}, list.size(),
        [&](std::size_t i) { return seen_[i].hits(); }, hitting_, 0,
        [&](std::size_t i) {
            return Place{list[i].pair, i, seen_[i]};
        });
    first_.resize(view.model.size());
    for (const Place& hit : hitting_)
        for (const std::int32_t body : {hit.pair.a, hit.pair.b})
            first_[at(body)] = {kNever, view.trajectories.version(at(body))};
    for (const Place& hit : hitting_)
        for (const std::int32_t body : {hit.pair.a, hit.pair.b})
            first_[at(body)].time = std::min(first_[at(body)].time, hit.seen.time);
}

bool FirstHits::stands(const StepView& view, const Hit& hit) {
    return view.trajectories.version(at(hit.pair.a)) == hit.version_a &&
           view.trajectories.version(at(hit.pair.b)) == hit.version_b;
}

const CollisionFinding* FirstHits::known(const StepView& view, const CandidatePair& pair) const {
    const auto it = std::ranges::lower_bound(before_, pair, {}, &Place::pair);
    if (it == before_.end() || !(it->pair == pair) || it->seen.thread < 0) return nullptr;
    const Hit& hit = hits_before_[at(it->seen.thread)][at(it->seen.number)];
    return stands(view, hit) ? &hit.finding : nullptr;
}

const CollisionFinding* FirstHits::found(const StepView& view, const CandidatePair& pair, std::size_t place) const {
    const Seen& seen = seen_[place];
    if (seen.thread < 0) return nullptr;
    const Hit& hit = hits_[at(seen.thread)][at(seen.number)];
    return hit.pair == pair && stands(view, hit) ? &hit.finding : nullptr;
}

bool FirstHits::waits(const StepView& view, const CandidatePair& pair, std::size_t place) const {
    const Seen& seen = seen_[place];
    bool moved = false, later = false;
    for (const std::int32_t body : {pair.a, pair.b}) {
        if (!view.model.bodies[at(body)].movable()) continue;
        moved |= view.trajectories.version(at(body)) != first_[at(body)].version;
        later |= first_[at(body)].time < seen.time - seen.room;
    }
    return later && !moved;
}

} // namespace flotilla
