// SPDX-License-Identifier: MIT
#include "pair/pair_table.hpp"

#include <algorithm>
#include <utility>

namespace flotilla {
namespace {

constexpr std::size_t kFirstSlots = 1024;

std::uint64_t mixed(std::int32_t a, std::int32_t b) {
    std::uint64_t z = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

} // namespace

void PairTable::start_step(std::int64_t step) {
    for (PairRecord& r : records_) {
        if (r.a < 0) continue;
        if (r.step != step_) {
            r = PairRecord();
            free_.push_back(&r);
            continue;
        }
        r.active = r.processed = false;
        r.start_distance = std::exchange(r.end_distance, -1.0);
    }
    step_ = step;
    if (!slots_.empty()) index(slots_.size());
}

void PairTable::clear() {
    records_.clear();
    free_.clear();
    std::fill(slots_.begin(), slots_.end(), Slot{});
}

std::size_t PairTable::slot(std::int32_t a, std::int32_t b) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = mixed(a, b) & mask;
    while (slots_[i].record != nullptr && (slots_[i].a != a || slots_[i].b != b)) i = (i + 1) & mask;
    return i;
}

PairRecord* PairTable::find(std::int32_t a, std::int32_t b) const {
    return slots_.empty() ? nullptr : slots_[slot(a, b)].record;
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
    if (free_.empty()) return records_.emplace_back();
    PairRecord& r = *free_.back();
    free_.pop_back();
    return r;
}

void PairTable::index(std::size_t slots) {
    slots_.assign(slots, {});
    for (PairRecord& r : records_)
        if (r.a >= 0) slots_[slot(r.a, r.b)] = {r.a, r.b, &r};
}

} // namespace flotilla
