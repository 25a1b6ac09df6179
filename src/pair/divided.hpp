// SPDX-License-Identifier: MIT
// Loops over pairs divided among ranks (parallel/division.hpp), and what ranks tell one another of pairs and clusters.
//
// Verdicts and flags of pairs, clusters and end states are the same on all ranks before and after each of these loops;
// caches of pairs are not: those of a pair are its owner's. So whatever a cache decides (which pairs are closed ahead
// of their turn) its owner alone decides, and tells.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pair/impulses.hpp"
#include "pair/pair_lists.hpp"
#include "pair/worker.hpp"
#include "parallel/division.hpp"

namespace flotilla {

/// The body, or -1 where it has infinite mass.
[[nodiscard]] inline std::int32_t shared_body(const Model& model, std::int32_t body) {
    return model.bodies[static_cast<std::size_t>(body)].movable() ? body : -1;
}
[[nodiscard]] inline bool owns(const Division& division, const Model& model, const CandidatePair& pair) {
    return division.owns(shared_body(model, pair.a), shared_body(model, pair.b));
}

/// What is told of a pair.
struct RecordState {
    VersionedVerdict verdict;
    Processed processed;
    bool active = false;

    explicit RecordState(const PairRecord& record)
        : verdict(record.verdict), processed(record.processed), active(record.active) {}
    RecordState() = default;
    void put(PairRecord& record) const {
        record.verdict = verdict;
        record.processed = processed;
        record.active = active;
    }
};

/// What an operation changes of a cluster, end states of its members included.
void write_cluster(ByteWriter& out, const Clusters& clusters, const Trajectories& trajectories, std::int32_t id);
/// Bytes that write_cluster() adds.
[[nodiscard]] std::size_t size_of_cluster(const Clusters& clusters, std::int32_t id);
/// Takes them, placing bodies anew whose end states have another version.
void read_cluster(std::span<const std::byte> bytes, std::int32_t id, Movers& movers);

/// Bytes that are told of a closed pair.
inline constexpr std::size_t kClosedBytes = sizeof(std::int32_t) + sizeof(RecordState);
/// What closing a pair takes: some arithmetic, or a query, whose time is worth being measured.
enum class PairWork : std::uint8_t { bounds, queries };

/// Tells all ranks of the pairs of a list that this one closed, flagged in `closed`. Returns how many all of them did.
std::size_t share_closed(const Division& division, std::span<const ListedPair> list,
                         std::span<const std::uint8_t> closed);

/// Calls close(i) for this rank's pairs of the list, side by side, which says whether it closed the pair, and shares
/// what came of it. Returns how many all ranks closed.
template <class Close>
std::size_t close_divided(PairWork work, const StepView& view, Team& team, std::span<const ListedPair> list,
                          Close&& close) {
    constexpr std::size_t kGrain = 64;
    Division& division = *team.division();
    std::vector<std::uint8_t> closed(list.size(), 0);
    team.for_each(
        work == PairWork::queries ? "examine" : "pair records", list.size(), kGrain, [&](std::size_t i, int thread) {
            const CandidatePair& p = list[i].pair;
            const std::int32_t payer = Division::payer(shared_body(view.model, p.a), shared_body(view.model, p.b));
            if (payer < 0 || division.owner(payer) != division.rank()) return;
            std::optional<CostOf> cost;
            if (work == PairWork::queries) cost.emplace(division, payer);
            if (close(i, thread)) closed[i] = 1;
        });
    const std::size_t all = share_closed(division, list, closed);
    division.log_loop(all * kClosedBytes);
    return all;
}

/// What all workers of this rank counted in a divided loop.
struct CountedWork {
    StageCounters counters;
    std::vector<std::int64_t> work;
    std::vector<std::size_t> hitting;
    std::vector<double> hardest;
    double largest_push = 0;
    std::vector<CandidatePair> pushed;

    /// Takes it from the workers, which are left with nothing counted.
    explicit CountedWork(Workers& workers);
    CountedWork() = default;
    void write(ByteWriter& out) const;
    template <class Reader>
    void read(Reader& in) {
        in.read(counters), in.read(work), in.read(hitting), in.read(hardest), in.read(largest_push), in.read(pushed);
    }
    void add(const CountedWork& other);
    /// Gives it to a worker.
    void give(Worker& worker) const;
};

} // namespace flotilla
