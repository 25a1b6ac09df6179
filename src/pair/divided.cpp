// SPDX-License-Identifier: MIT
#include "pair/divided.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"

namespace flotilla {
namespace {

/// Of a cluster, and of each of its members.
struct ClusterPart {
    ClusterChange change;
};
struct MemberPart {
    Motion motion;
    Pose end;
    Vec3 turn;
    std::uint64_t version = 0;
};

/// Adds up, and leaves as many zeros.
template <class T>
void take_from(std::vector<T>& sum, std::vector<T>& from, T (*join)(T, T)) {
    sum.resize(std::max(sum.size(), from.size()));
    for (std::size_t k = 0; k < from.size(); ++k) sum[k] = join(sum[k], std::exchange(from[k], T{}));
}
template <class T>
void add_to(std::vector<T>& sum, const std::vector<T>& other, T (*join)(T, T)) {
    sum.resize(std::max(sum.size(), other.size()));
    for (std::size_t k = 0; k < other.size(); ++k) sum[k] = join(sum[k], other[k]);
}
template <class T>
T plus(T a, T b) {
    return a + b;
}
double greater(double a, double b) { return std::max(a, b); }

} // namespace

void write_cluster(ByteWriter& out, const Clusters& clusters, const Trajectories& trajectories, std::int32_t id) {
    out.add(ClusterPart{clusters.change(id)});
    for (const std::int32_t i : clusters[id].members)
        out.add(MemberPart{clusters.motion()[at(i)], trajectories.end_pose(at(i)), trajectories.turn(at(i)),
                           trajectories.version(at(i))});
}

std::size_t size_of_cluster(const Clusters& clusters, std::int32_t id) {
    return sizeof(ClusterPart) + clusters[id].members.size() * sizeof(MemberPart);
}

void read_cluster(std::span<const std::byte> bytes, std::int32_t id, Movers& movers) {
    auto in = reader_of(bytes);
    ClusterPart cluster;
    in.read(cluster);
    movers.clusters().take(id, cluster.change);
    for (const std::int32_t i : movers.clusters()[id].members) {
        MemberPart member;
        in.read(member);
        movers.clusters().take_motion(at(i), member.motion);
        movers.trajectories().take_end(at(i), member.end, member.turn, member.version);
    }
}

std::size_t share_closed(const Division& division, std::span<const ListedPair> list,
                         std::span<const std::uint8_t> closed) {
    ByteWriter out;
    for (std::size_t i = 0; i < list.size(); ++i) {
        if (closed[i] == 0) continue;
        out.add(static_cast<std::int32_t>(i));
        out.add(RecordState(*list[i].record));
    }
    const GatheredBytes told = gather_bytes(division.ranks(), out.take());
    for (int rank = 0; rank < division.size(); ++rank) {
        if (rank == division.rank()) continue;
        auto in = reader_of(told.of(rank));
        while (!in.rest().empty()) {
            std::int32_t place = 0;
            RecordState state;
            in.read(place), in.read(state);
            state.put(*list[at(place)].record);
        }
    }
    return told.all.size() / kClosedBytes;
}

CountedWork::CountedWork(Workers& workers) {
    collect(workers, counters);
    largest_push = take_largest_push(workers);
    for (Worker& worker : workers.each) {
        take_from<std::int64_t>(work, worker.work, plus);
        take_from<std::size_t>(hitting, worker.hitting, plus);
        take_from<double>(hardest, worker.hardest, greater);
        pushed.insert(pushed.end(), worker.pushed.begin(), worker.pushed.end());
        worker.pushed.clear();
    }
}

void CountedWork::write(ByteWriter& out) const {
    out.add(counters), out.add(work), out.add(hitting), out.add(hardest), out.add(largest_push), out.add(pushed);
}

void CountedWork::add(const CountedWork& other) {
    counters.pairs += other.counters.pairs;
    counters.impulses += other.counters.impulses;
    counters.settled += other.counters.settled;
    counters.detection_ms += other.counters.detection_ms;
    counters.response_ms += other.counters.response_ms;
    add_to<std::int64_t>(work, other.work, plus);
    add_to<std::size_t>(hitting, other.hitting, plus);
    add_to<double>(hardest, other.hardest, greater);
    largest_push = std::max(largest_push, other.largest_push);
    pushed.insert(pushed.end(), other.pushed.begin(), other.pushed.end());
}

void CountedWork::give(Worker& worker) const {
    worker.counters = counters;
    worker.work = work;
    worker.hitting = hitting;
    worker.hardest = hardest;
    worker.largest_push = largest_push;
    worker.pushed = pushed;
}

} // namespace flotilla
