// SPDX-License-Identifier: MIT
#include "pair/pair_lists.hpp"

#include <atomic>
#include <limits>
#include <utility>

#include "base/index.hpp"
#include "geometry/rounding.hpp"
#include "pair/divided.hpp"
#include "pair/pair_distance.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kBodyGrain = 128, kPairGrain = 256, kLookGrain = 1024; // items of a task

constexpr double kUnknown = std::numeric_limits<double>::infinity();

double speed_of(const StepView& view, std::size_t body) {
    const Impulsive mover = view.clusters.impulsive(view.clusters.of(body));
    return length(mover.velocity) + length(mover.angular_velocity) * view.model.shape_of(body).radius;
}

/// What a list of pairs is made of: the boxes of which part of the motion, how near, and whether speeds are asked for.
struct ListKind {
    const char* name;
    ListReach reach;
    bool with_speed = false, wakes = false;
};

void set_bounds(const StepView& view, std::size_t body, const Box& box, const ListKind& kind, ListBuffers& lists) {
    const bool movable = view.model.bodies[body].movable();
    lists.swept[body] = {box, movable ? list_reach(view.model, body, kind.reach) : 0.0, movable};
    lists.bounds[body] = {displacement_of(view.trajectories.motion(body)),
                          kind.with_speed ? speed_of(view, body) : kUnknown};
}

/// Boxes and bounds of the bodies that stand still, once for as long as the same ones do.
void place_still(const StepView& view, Team& team, ListBuffers& lists) {
    if (lists.still_placed == lists.still_version) return;
    const std::size_t n = view.model.size();
    lists.swept.resize(n);
    lists.bounds.resize(n);
    team.for_each("bounds of still bodies", n, kBodyGrain, [&](std::size_t i, int) {
        const Body& body = view.model.bodies[i];
        if (body.movable() || body.scripted()) return;
        const double waking = body.dynamic() ? list_reach(view.model, i, ListReach::proximity) : 0.0;
        lists.swept[i] = {view.trajectories.start_box(i), 0, false, waking, body.present};
        lists.bounds[i] = {};
    });
    lists.still_placed = lists.still_version;
}

PairSearch search_of(const StepView& view, const ListBuffers& lists, bool wakes) {
    const Model* filters = view.model.filter.empty() ? nullptr : &view.model;
    return {lists.swept, view.model.active, lists.still_version, wakes, view.savings, filters};
}

/// Candidate pairs of bodies with the given boxes.
template <class BoxOf>
const std::vector<CandidatePair>& find_pairs(const StepView& view, PairBook& book, Team& team, const ListKind& kind,
                                             BoxOf&& box_of) {
    place_still(view, team, book.lists);
    const std::vector<std::int32_t>& active = view.model.active;
    team.for_each(kind.name, active.size(), kBodyGrain, [&](std::size_t k, int) {
        set_bounds(view, at(active[k]), box_of(at(active[k])), kind, book.lists);
    });
    return book.finder().find(team, search_of(view, book.lists, kind.wakes));
}

Box swept_box(const StepView& view, std::size_t body) { return view.trajectories.motion(body).swept(); }

/// Those of the pairs that `wanted(pair, record)` wants, the record being null where there is none yet; all of them get
/// one.
template <class Wanted>
const std::vector<ListedPair>& list_pairs(const StepView& view, PairBook& book, Team& team,
                                          const std::vector<CandidatePair>& pairs, Wanted&& wanted) {
    ListBuffers& l = book.lists;
    l.record.resize(pairs.size());
    l.wanted.resize(pairs.size());
    std::atomic<bool> missing = false;
    const auto find = [&](std::size_t begin, std::size_t end) {
        const std::size_t count = end - begin;
        book.table.find(std::span(pairs).subspan(begin, count), std::span(l.record).subspan(begin, count));
        std::size_t found = 0;
        for (std::size_t i = begin; i < end; ++i) {
            if (l.record[i] != nullptr) book.table.use(*l.record[i]);
            l.wanted[i] = wanted(pairs[i], l.record[i]) ? 1 : 0;
            if (l.record[i] == nullptr && l.wanted[i] != 0) missing.store(true, std::memory_order_relaxed);
            found += l.wanted[i];
        }
        return found;
    };
    const auto keep = [&](std::size_t begin, std::size_t end, std::size_t place) {
        for (std::size_t i = begin; i < end; ++i)
            if (l.wanted[i] != 0) l.listed[place++] = {pairs[i], l.record[i]};
    };
    const auto resize = [&](std::size_t total) { l.listed.resize(total); };
    compact({&team, "pair records", kPairGrain, l.chunk_places}, pairs.size(), find, resize, keep);
    if (missing) // one thread alone may make records
        for (ListedPair& p : l.listed)
            if (p.record == nullptr) p.record = &book.table.get(view.model, view.state, p.pair.a, p.pair.b);
    return l.listed;
}

/// Whether stage 1 would find nothing but a pair apart, by bounds: no proximity that approaches fast enough either.
bool calm_by_bounds(const StepView& view, const PairRecord& pair) {
    const Settings& s = view.model.settings;
    if (s.ccd == CcdMethod::cubic || s.collision_pair_iterations == 0)
        return false; // a miss of the cubic proves nothing; without iterations an operation does nothing
    const double speed = (1 + kLengthRounding) * (view.bounds[at(pair.a)].speed + view.bounds[at(pair.b)].speed);
    return speed < (1 - kLengthRounding) * view.approach;
}

/// Does what the operation of a listed pair would do, where bounds say that it would find nothing.
bool close_by_bounds(const StepView& view, PairRecord& pair, ListReach reach) {
    if (!stays_by_bounds(view, pair)) return false;
    if (reach == ListReach::proximity) {
        if (!calm_by_bounds(view, pair)) return false;
        if (pair.cache.start_distance < pair.lengths.proximity) pair.processed.expect();
    }
    commit(view.trajectories, pair, Verdict::apart);
    return true;
}

} // namespace

double list_reach(const Model& model, std::size_t body, ListReach reach) {
    const PairLengths own = body_lengths(model, body);
    switch (reach) {
    case ListReach::separation: return own.separation;
    case ListReach::proximity: return own.proximity;
    case ListReach::fall: break;
    }
    return std::max(own.proximity, fall_in_step(model, body));
}

const std::vector<CandidatePair>& swept_pairs(const StepView& view, PairBook& book, Team& team, ListReach reach) {
    constexpr std::size_t kFew = 64; // a body in so many
    SweptMotions& frozen = book.lists.frozen;
    const bool known = frozen.pairs != nullptr && frozen.reach == reach;
    frozen.version.resize(view.model.size());
    const std::vector<std::int32_t>& active = view.model.active;
    frozen.differs.resize(active.size());
    const auto look = [&](std::size_t k) {
        const std::uint64_t version = view.trajectories.version(at(active[k]));
        const bool differs = std::exchange(frozen.version[at(active[k])], version) != version;
        return (frozen.differs[k] = differs ? 1 : 0) != 0;
    };
    compact_if(
        {&team, "changed bodies", kLookGrain, book.lists.chunk_places}, active.size(), look,
        [&](std::size_t k) { return frozen.differs[k] != 0; }, frozen.changed, 0,
        [&](std::size_t k) { return active[k]; });
    if (known && frozen.changed.empty()) return *frozen.pairs;
    frozen.reach = reach;
    const ListKind kind{"swept bounds", reach, reach == ListReach::proximity};
    if (known && frozen.changed.size() * kFew <= view.model.active.size()) {
        for_each(&team, "bounds of changed bodies", frozen.changed.size(), kBodyGrain, [&](std::size_t k) {
            const std::size_t i = at(frozen.changed[k]);
            set_bounds(view, i, swept_box(view, i), kind, book.lists);
        });
        frozen.pairs = &book.finder().update(team, search_of(view, book.lists, false), frozen.changed);
    } else {
        frozen.pairs = &find_pairs(view, book, team, kind, [&](std::size_t i) { return swept_box(view, i); });
    }
    return *frozen.pairs;
}

const std::vector<CandidatePair>& waking_pairs(const StepView& view, PairBook& book, Team& team) {
    book.lists.forget_motions();
    return find_pairs(view, book, team, {"waking bounds", ListReach::proximity, true, true},
                      [&](std::size_t i) { return swept_box(view, i); });
}

FrozenList freeze(const StepView& view, PairBook& book, Team& team, ListReach reach) {
    // In stage 1 pairs are closed ahead of their turn only where that is not to be left out.
    const bool closes = reach == ListReach::separation || view.savings.calm_pairs;
    const bool divided = closes && team.division() != nullptr;
    std::atomic<std::size_t> closed = 0;
    const auto wanted = [&](const CandidatePair& p, PairRecord* pair) {
        if (view.clusters.of(at(p.a)) == view.clusters.of(at(p.b))) return false;
        if (pair == nullptr) return true;
        pair->processed.confirm();
        if (apart(view.trajectories, *pair)) return false;
        if (closes && !divided && close_by_bounds(view, *pair, reach)) closed.fetch_add(1, std::memory_order_relaxed);
        return true;
    };
    const std::vector<ListedPair>& listed = list_pairs(view, book, team, swept_pairs(view, book, team, reach), wanted);
    if (divided)
        closed = close_divided(PairWork::bounds, view, team, listed,
                               [&](std::size_t i, int) { return close_by_bounds(view, *listed[i].record, reach); });
    return {listed, listed.size() - closed};
}

const std::vector<ListedPair>& end_pairs(const StepView& view, PairBook& book, Team& team) {
    book.lists.forget_motions();
    const auto& pairs = find_pairs(view, book, team, {"end bounds", ListReach::fall},
                                   [&](std::size_t i) { return view.trajectories.at_end(i).swept(); });
    return list_pairs(view, book, team, pairs, [](const CandidatePair&, PairRecord*) { return true; });
}

} // namespace flotilla
