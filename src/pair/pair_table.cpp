// SPDX-License-Identifier: MIT
#include "pair/pair_table.hpp"

#include <algorithm>
#include <utility>

#include "base/prefetch.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kFirstSlots = 1024;
constexpr std::size_t kGrain = 512; // records of a task

std::uint64_t mixed(std::int32_t a, std::int32_t b) {
    std::uint64_t z = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

} // namespace

void fetch_record(const PairRecord& record) {
    fetch_to_write(&record);
    fetch_to_write(&record.cache.doubt);
}

void PairTable::start_step(Team& team, std::int64_t step) {
    const auto unused = [&](const PairRecord& r) { return r.a >= 0 && r.step != step_; };
    const auto start = [&](std::size_t i) {
        PairRecord& r = records_[i];
        r.active = false;
        r.processed = {};
        PairCache& known = r.cache;
        known.start_distance = std::exchange(known.end_distance, -1.0);
        if (known.start_distance < 0) known.slack = -1; // the last step did not search
        return unused(r);
    };
    const auto kept = [&](std::size_t i) { return unused(records_[i]); };
    const auto item = [&](std::size_t i) { return &records_[i]; };
    const std::size_t first = free_.size();
    compact_if({&team, "start pairs", kGrain, places_}, records_.size(), start, kept, free_, first, item);
    for (std::size_t i = first; i < free_.size(); ++i) erase(free_[i]->a, free_[i]->b);
    team.for_each("forget pairs", free_.size() - first, kGrain,
                  [&](std::size_t i, int) { *free_[first + i] = PairRecord(); });
    step_ = step;
}

void PairTable::restart_step(Team& team) {
    team.for_each("restart pairs", records_.size(), kGrain, [&](std::size_t i, int) {
        records_[i].active = false;
        records_[i].processed = {};
    });
}

void PairTable::clear() {
    records_.clear();
    free_.clear();
    std::fill(slots_.begin(), slots_.end(), Slot{});
}

void PairTable::forget(std::span<const std::uint8_t> marked) {
    const auto is_marked = [&](std::int32_t body) { return marked[static_cast<std::size_t>(body)] != 0; };
    for (std::size_t i = 0; i < records_.size(); ++i) {
        PairRecord& r = records_[i];
        if (r.a < 0 || !(is_marked(r.a) || is_marked(r.b))) continue;
        erase(r.a, r.b);
        r = PairRecord();
        free_.push_back(&r);
    }
}

std::size_t PairTable::slot(std::int32_t a, std::int32_t b) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = mixed(a, b) & mask;
    while (slots_[i].record != nullptr && (slots_[i].a != a || slots_[i].b != b)) i = (i + 1) & mask;
    return i;
}

PairRecord* PairTable::find(std::int32_t a, std::int32_t b) {
    return slots_.empty() ? nullptr : slots_[slot(a, b)].record;
}

const PairRecord* PairTable::find(std::int32_t a, std::int32_t b) const {
    return slots_.empty() ? nullptr : slots_[slot(a, b)].record;
}

void PairTable::find(std::span<const CandidatePair> pairs, std::span<PairRecord*> out) {
    if (slots_.empty()) return std::fill(out.begin(), out.end(), nullptr);
    for (const CandidatePair& p : pairs) __builtin_prefetch(&slots_[mixed(p.a, p.b) & (slots_.size() - 1)]);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        out[i] = slots_[slot(pairs[i].a, pairs[i].b)].record;
        if (out[i] != nullptr) fetch_to_write(out[i]);
    }
}

PairRecord& PairTable::get(const Model& model, const State& state, std::int32_t a, std::int32_t b) {
    if (2 * (records_.size() - free_.size() + 1) > slots_.size()) index(std::max(kFirstSlots, 2 * slots_.size()));
    Slot& s = slots_[slot(a, b)];
    if (s.record == nullptr) {
        PairRecord& r = new_record();
        r.a = a;
        r.b = b;
        r.lengths = pair_lengths(model, state, a, b);
        s = {a, b, &r};
    }
    use(*s.record);
    return *s.record;
}

PairRecord& PairTable::new_record() {
    if (free_.empty()) return records_.add();
    PairRecord& r = *free_.back();
    free_.pop_back();
    return r;
}

/// Closes the gap by the entries behind it that would not be found across it (Knuth, The Art of Computer Programming 3,
/// 6.4, algorithm R).
void PairTable::erase(std::int32_t a, std::int32_t b) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t gap = slot(a, b);
    for (std::size_t i = (gap + 1) & mask; slots_[i].record != nullptr; i = (i + 1) & mask) {
        const std::size_t home = mixed(slots_[i].a, slots_[i].b) & mask;
        if (((i - home) & mask) < ((i - gap) & mask)) continue;
        slots_[gap] = slots_[i];
        gap = i;
    }
    slots_[gap] = {};
}

void PairTable::index(std::size_t slots) {
    slots_.assign(slots, {});
    for (std::size_t i = 0; i < records_.size(); ++i)
        if (PairRecord& r = records_[i]; r.a >= 0) slots_[slot(r.a, r.b)] = {r.a, r.b, &r};
}

std::size_t PairTable::memory() const {
    std::size_t bytes = slots_.size() * sizeof(Slot) + records_.size() * sizeof(PairRecord);
    for (std::size_t i = 0; i < records_.size(); ++i)
        if (const auto& kept = records_[i].cache.candidates) bytes += sizeof(PairCandidates) + kept->list.memory();
    return bytes;
}

} // namespace flotilla
