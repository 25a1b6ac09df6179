// SPDX-License-Identifier: MIT
#include "broadphase/kept_pairs.hpp"

#include <algorithm>
#include <iterator>

#include "base/index.hpp"
#include "broadphase/swept_boxes.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

/// Of a box's largest edge. Wider: fewer bodies leave their box, more pairs are tested in vain.
constexpr double kMargin = 1.0 / 16;
/// Bodies that left their boxes are sorted in one by one where they are at most one in so many; else all are sorted
/// anew.
constexpr std::size_t kFew = 64;
constexpr std::size_t kBodyGrain = 256, kPairGrain = 2048; // items of a task

/// NaN is in no box.
bool holds(const Box& outer, const Box& inner) {
    const auto below = [](const Vec3& p, const Vec3& q) { return p.x <= q.x && p.y <= q.y && p.z <= q.z; };
    return below(outer.lower, inner.lower) && below(inner.upper, outer.upper);
}

/// Holds all that inflated(body) may become until the body leaves it.
SweptBody widened(const SweptBody& body) {
    const double margin = kMargin * max_component(extent(body.box));
    return {inflated(body.box, body.reach + margin), 0, body.movable, body.waking_reach};
}

bool ignored(const PairSearch& search, const CandidatePair& pair) {
    return search.filters != nullptr && search.filters->ignores(pair.a, pair.b);
}

} // namespace

const std::vector<CandidatePair>& KeptPairs::find(Team& team, const PairSearch& search) {
    if (!search.savings.kept_pairs) {
        wide_ = nullptr;
        return without_ignored(search, grids_.find(team, search));
    }
    cover(team, search, search.active);
    return near_ones(team, search);
}

const std::vector<CandidatePair>& KeptPairs::update(Team& team, const PairSearch& search,
                                                    std::span<const std::int32_t> changed) {
    if (!search.savings.kept_pairs) return without_ignored(search, grids_.update(team, search, changed));
    cover(team, search, changed);
    return near_ones(team, search);
}

const std::vector<CandidatePair>& KeptPairs::without_ignored(const PairSearch& search,
                                                             const std::vector<CandidatePair>& pairs) {
    if (search.filters == nullptr) return pairs;
    pairs_.clear();
    std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(pairs_),
                 [&](const CandidatePair& p) { return !ignored(search, p); });
    return pairs_;
}

std::size_t KeptPairs::lone_bodies(std::span<const std::int32_t> active) const {
    if (wide_ == nullptr) return 0;
    std::vector<std::uint8_t> met(boxes_.size(), 0);
    for (const CandidatePair& p : *wide_) met[at(p.a)] = met[at(p.b)] = 1;
    return static_cast<std::size_t>(std::count_if(
        active.begin(), active.end(), [&](std::int32_t i) { return boxes_[at(i)].movable && met[at(i)] == 0; }));
}

void KeptPairs::cover(Team& team, const PairSearch& search, std::span<const std::int32_t> changed) {
    // Sleeping bodies are always in the list: most searches leave them out again, some do not.
    const auto wide_search = [&] {
        return PairSearch{boxes_, search.active, search.still_version, true, search.savings};
    };
    if (wide_ != nullptr && still_version_ == search.still_version && boxes_.size() == search.bodies.size()) {
        list_strays(team, search, changed);
        if (strays_.empty()) return;
        if (strays_.size() * kFew <= search.active.size()) {
            for (const std::int32_t i : strays_) boxes_[at(i)] = widened(search.bodies[at(i)]);
            wide_ = &grids_.update(team, wide_search(), strays_);
            return;
        }
    } else {
        boxes_.assign(search.bodies.begin(), search.bodies.end());
        still_version_ = search.still_version;
    }
    widen_all(team, search);
    wide_ = &grids_.find(team, wide_search());
}

void KeptPairs::list_strays(Team& team, const PairSearch& search, std::span<const std::int32_t> bodies) {
    out_.resize(bodies.size());
    team.for_each("bodies in their boxes", bodies.size(), kBodyGrain, [&](std::size_t k, int) {
        const SweptBody &wide = boxes_[at(bodies[k])], &body = search.bodies[at(bodies[k])];
        out_[k] = wide.movable == body.movable && holds(wide.box, inflated(body)) ? 0 : 1;
    });
    strays_.clear();
    for (std::size_t k = 0; k < bodies.size(); ++k)
        if (out_[k] != 0) strays_.push_back(bodies[k]);
}

void KeptPairs::widen_all(Team& team, const PairSearch& search) {
    team.for_each("widen boxes", search.active.size(), kBodyGrain, [&](std::size_t k, int) {
        const std::size_t i = at(search.active[k]);
        boxes_[i] = widened(search.bodies[i]);
    });
}

const std::vector<CandidatePair>& KeptPairs::near_ones(Team& team, const PairSearch& search) {
    const std::vector<CandidatePair>& wide = *wide_;
    near_.resize(wide.size());
    const auto look = [&](std::size_t i) {
        const SweptBody &a = search.bodies[at(wide[i].a)], &b = search.bodies[at(wide[i].b)];
        near_[i] = may_pair(a, b, search.wakes) && !ignored(search, wide[i]) ? 1 : 0;
        return near_[i] != 0;
    };
    const auto kept = [&](std::size_t i) { return near_[i] != 0; };
    const auto item = [&](std::size_t i) { return wide[i]; };
    compact_if({&team, "near pairs", kPairGrain, places_}, wide.size(), look, kept, pairs_, 0, item);
    return pairs_;
}

} // namespace flotilla
