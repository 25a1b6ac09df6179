// SPDX-License-Identifier: MIT
#include "collision/found_hits.hpp"

#include <algorithm>
#include <tuple>

#include "base/index.hpp"
#include "collision/late_hits.hpp"
#include "collision/pair_hits.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kPairGrain = 16; // pairs of a task

} // namespace

void look_for_hits(const StepView& view, PairBook& book, Workers& workers, StageCounters& counters,
                   std::vector<FoundHit>& found, const std::function<bool(std::int32_t, std::int32_t)>& asked) {
    const std::span<const ListedPair> list = freeze(view, book, workers.team, ListReach::proximity).pairs;
    found.clear();
    for (Worker& worker : workers.each) worker.found.clear();
    workers.team.for_each("look for hits", list.size(), kPairGrain, [&](std::size_t i, int thread) {
        if (i + 1 < list.size()) fetch_record(*list[i + 1].record);
        PairRecord& record = *list[i].record;
        if (verdict(view.trajectories, record) != Verdict::open) return;
        if (!asked(record.a, record.b)) return;
        Worker& worker = workers[thread];
        ++worker.counters.pairs;
        if (!find_hits(view, worker, record)) return;
        for (const ContactPoint& point : worker.hits) worker.found.push_back({list[i].record, point});
        FoundHit& first = worker.found[worker.found.size() - worker.hits.size()];
        first.landing = worker.landing;
        first.within = worker.first_within;
    });
    collect(workers, counters);
    for (const Worker& worker : workers.each) found.insert(found.end(), worker.found.begin(), worker.found.end());
    std::stable_sort(found.begin(), found.end(), [](const FoundHit& x, const FoundHit& y) {
        return std::tuple(x.record->a, x.record->b) < std::tuple(y.record->a, y.record->b);
    });
    if (!found.empty()) ++counters.sweeps;
}

bool hasten_parting(const StepView& view, Movers& movers, StageCounters& counters, std::vector<FoundHit>& found) {
    bool any = false;
    const auto parts = [](const FoundHit& f) { return f.landing && f.landing->parts; };
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found.size();) {
        PairRecord& record = *found[i].record;
        std::size_t end = i + 1;
        while (end < found.size() && found[end].record == &record) ++end;
        if (!parts(found[i])) {
            for (; i < end; ++i) found[kept++] = found[i];
            continue;
        }
        if (hasten(view, movers.clusters(), {record.a, record.b}, found[i].point, *found[i].landing)) {
            any = true;
            movers.evolve(record.a);
            movers.evolve(record.b);
        } else {
            commit(view.trajectories, record, Verdict::settled);
            ++counters.settled;
        }
        i = end;
    }
    found.resize(kept);
    return any;
}

} // namespace flotilla
