// SPDX-License-Identifier: MIT
#include "mpi/cost_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/index.hpp"

namespace flotilla::mpi {
namespace {

constexpr double kNanosecond = 1e-9;
constexpr std::size_t kSizeBytes = 8; // that a rank tells of the size of what it will tell

/// How many pieces go from whom to whom after each stage, and for which.
class NextUsers {
  public:
    struct Handed {
        std::size_t pieces = 0, needed = 0;
    };

    explicit NextUsers(std::size_t pieces) : next_(pieces) {}

    /// A stage of a rank uses a piece; from the last use to the first.
    void use(std::size_t stage, std::int32_t piece, int rank) {
        const User user = std::exchange(next_[at(piece)], {rank, stage});
        if (user.rank < 0 || user.rank == rank) return;
        Handed& handed = handed_[{stage, rank, user.rank}];
        handed.needed = handed.pieces++ == 0 ? user.stage : std::min(handed.needed, user.stage);
    }
    template <class Work>
    void for_all(Work&& work) const {
        for (const auto& [key, handed] : handed_) work(std::get<0>(key), std::get<1>(key), std::get<2>(key), handed);
    }

  private:
    struct User {
        int rank = -1;
        std::size_t stage = 0;
    };
    std::vector<User> next_;
    std::map<std::tuple<std::size_t, int, int>, Handed> handed_;
};

} // namespace

void CostModel::add(const LoggedStep& step, bool counted) {
    cost_.resize(step.positions.size());
    std::vector<std::int64_t> of_active;
    for (const std::int32_t body : step.active) of_active.push_back(cost_[at(body)]);
    owners_.begin_step(step.positions, step.active, of_active);
    cost_.assign(step.positions.size(), 0);
    const ModelTotals before = totals_;
    clock_.assign(at(ranks_), 0);
    messages_.assign(at(ranks_), 0);
    bytes_.assign(at(ranks_), 0);
    place_ = step.place;
    work_ = 0;
    gather(step.active.size() * sizeof(std::int64_t) * at(ranks_)); // what bodies cost
    for (const LoggedSection& section : step.log.sections) std::visit([&](const auto& s) { add(s); }, section);
    gather(kSizeBytes * at(ranks_)); // hashes
    if (!counted) {
        totals_ = before;
        return;
    }
    // What dividing costs beside messages, one rank pays as well; what it does alone is what others do as well.
    const double common = std::max(0.0, (ranks_ == 1 ? step.alone : step.divided) - work_);
    ++totals_.steps;
    totals_.alone += step.alone;
    totals_.common += common;
    totals_.work += work_;
    totals_.seconds += ranks_ == 1 ? step.alone : common + *std::max_element(clock_.begin(), clock_.end());
    totals_.messages += *std::max_element(messages_.begin(), messages_.end());
    totals_.bytes += *std::max_element(bytes_.begin(), bytes_.end());
}

void CostModel::count(std::int32_t body, double seconds) {
    if (body >= 0) cost_[at(body)] += static_cast<std::int64_t>(seconds / kNanosecond);
    work_ += seconds;
}

void CostModel::add(const LoggedLoop& loop) {
    for (const LoggedItem& item : loop.items) {
        const double seconds = kNanosecond * static_cast<double>(item.ns);
        clock_[at(owners_[item.body])] += seconds;
        count(item.body, seconds);
    }
    gather_unknown(loop.bytes);
}

void CostModel::add(const LoggedSweep& sweep) {
    std::vector<Stage> stages;
    NextUsers users(cost_.size());
    for (std::size_t t = sweep.tasks.size(); t-- > 0;) {
        const LoggedSweep::Task& task = sweep.tasks[t];
        stages.resize(std::max(stages.size(), task.wave + 1));
        stages[task.wave].work.resize(at(ranks_));
        const std::int32_t payer = Division::payer(task.clusters[0], task.clusters[1]);
        const double seconds = kNanosecond * static_cast<double>(task.ns);
        stages[task.wave].work[at(owners_[payer])] += seconds;
        count(payer, seconds);
        for (const std::int32_t cluster : task.clusters)
            if (cluster >= 0) users.use(task.wave, cluster, owners_[payer]);
    }
    users.for_all([&](std::size_t wave, int from, int to, const NextUsers::Handed& h) {
        stages[wave].handed.push_back({from, to, h.pieces, h.needed});
    });
    pass(stages, sweep.cluster_bytes, place_, 1);
    gather_unknown(sweep.bytes);
    const double others = static_cast<double>(sweep.changed) * (1 - 1.0 / ranks_);
    for (double& clock : clock_) clock += others * place_;
}

void CostModel::add(const LoggedContacts& contacts) {
    std::int64_t rows = 0;
    for (const auto& packet : contacts.packets) rows += packet.rows;
    if (rows == 0 || contacts.sweeps == 0) return;
    const auto per_row = [&](std::int64_t ns, std::int64_t times) {
        return times == 0 ? 0.0 : kNanosecond * static_cast<double>(ns) / static_cast<double>(times * rows);
    };
    const double of_row = per_row(contacts.sweep_ns, contacts.sweeps);
    std::vector<Stage> colors;
    NextUsers users(cost_.size());
    std::vector<double> all(at(ranks_));
    std::vector<bool> seen(cost_.size());
    std::size_t bodies = 0;
    for (std::size_t p = contacts.packets.size(); p-- > 0;) {
        const LoggedContacts::Packet& packet = contacts.packets[p];
        colors.resize(std::max(colors.size(), at(packet.color) + 1));
        Stage& color = colors[at(packet.color)];
        color.work.resize(at(ranks_));
        const double seconds = of_row * static_cast<double>(packet.rows);
        color.work[at(owners_[packet.payer])] += seconds;
        all[at(owners_[packet.payer])] += seconds;
        count(packet.payer, seconds * static_cast<double>(contacts.sweeps));
        for (const std::int32_t body : packet.bodies) {
            users.use(at(packet.color), body, owners_[packet.payer]);
            if (!seen[at(body)]) ++bodies;
            seen[at(body)] = true;
        }
    }
    users.for_all([&](std::size_t color, int from, int to, const NextUsers::Handed& h) {
        colors[color].handed.push_back({from, to, h.pieces, color + 1}); // ranks wait for them at once
    });
    // All sweeps begin and end together, so one is like another.
    const std::vector<double> before(clock_.size(), *std::max_element(clock_.begin(), clock_.end()));
    clock_ = before;
    pass(colors, contacts.body_bytes, 0, contacts.sweeps);
    const double sweep = *std::max_element(clock_.begin(), clock_.end()) - before.front();
    clock_.assign(clock_.size(), before.front() + static_cast<double>(contacts.sweeps) * sweep);
    gather(kSizeBytes * at(ranks_) + bodies * contacts.body_bytes, contacts.sweeps);
    const double evaluation = kNanosecond * static_cast<double>(contacts.evaluation_ns);
    const double share = *std::max_element(all.begin(), all.end()) / (of_row * static_cast<double>(rows));
    for (double& clock : clock_) clock += evaluation * share;
    work_ += evaluation;
    gather_unknown(kSizeBytes * at(ranks_) + 2 * contacts.packets.size(), contacts.evaluations);
    if (contacts.impulse_bytes > 0) gather_unknown(contacts.impulse_bytes);
}

/// Moves the clocks on by one of `times` equal passes through the stages, and counts what is said in all of them.
void CostModel::pass(std::span<const Stage> stages, std::size_t piece_bytes, double piece_seconds, std::int64_t times) {
    struct Arrival {
        double time;
        int to;
        std::size_t pieces;
    };
    std::vector<std::vector<Arrival>> needed(stages.size() + 1);
    for (std::size_t k = 0; k <= stages.size(); ++k) {
        std::vector<std::size_t> placed(clock_.size());
        for (const Arrival& a : needed[k]) {
            clock_[at(a.to)] = std::max(clock_[at(a.to)], a.time);
            placed[at(a.to)] += a.pieces;
        }
        if (k == stages.size()) return;
        const Stage& stage = stages[k];
        for (std::size_t r = 0; r < clock_.size(); ++r)
            clock_[r] += piece_seconds * static_cast<double>(placed[r]) + (stage.work.empty() ? 0 : stage.work[r]);
        for (const Handed& h : stage.handed) {
            const std::size_t bytes = h.pieces * piece_bytes;
            const double arrival =
                clock_[at(h.from)] + network_.latency + static_cast<double>(bytes) / network_.bandwidth;
            needed[std::min(h.needed, stages.size())].push_back({arrival, h.to, h.pieces});
            messages_[at(h.from)] += times;
            bytes_[at(h.from)] += times * static_cast<std::int64_t>(bytes);
        }
    }
}

void CostModel::gather(std::size_t bytes, std::int64_t times) {
    if (ranks_ == 1) return;
    const double from_others = static_cast<double>(bytes) * (1 - 1.0 / ranks_);
    const double seconds = std::ceil(std::log2(ranks_)) * network_.latency + from_others / network_.bandwidth;
    clock_.assign(clock_.size(),
                  *std::max_element(clock_.begin(), clock_.end()) + static_cast<double>(times) * seconds);
    totals_.gathers += times;
    totals_.gathered_bytes += times * static_cast<std::int64_t>(from_others);
}

/// The sizes first.
void CostModel::gather_unknown(std::size_t bytes, std::int64_t times) {
    gather(kSizeBytes * at(ranks_), times);
    gather(bytes, times);
}

} // namespace flotilla::mpi
