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
    std::erase_if(records_, [&](const PairRecord& r) { return r.step != step_; });
    for (PairRecord& r : records_) {
        r.active = r.processed = false;
        r.start_distance = std::exchange(r.end_distance, -1.0);
    }
    step_ = step;
    if (!slots_.empty()) index(slots_.size());
}

void PairTable::clear() {
    records_.clear();
    std::fill(slots_.begin(), slots_.end(), -1);
}

std::size_t PairTable::slot(std::int32_t a, std::int32_t b) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = mixed(a, b) & mask;
    while (slots_[i] >= 0) {
        const PairRecord& r = records_[static_cast<std::size_t>(slots_[i])];
        if (r.a == a && r.b == b) break;
        i = (i + 1) & mask;
    }
    return i;
}

const PairRecord* PairTable::find(std::int32_t a, std::int32_t b) const {
    if (slots_.empty()) return nullptr;
    const std::int32_t index = slots_[slot(a, b)];
    return index < 0 ? nullptr : &records_[static_cast<std::size_t>(index)];
}

PairRecord& PairTable::get(const Model& model, const State& state, std::int32_t a, std::int32_t b) {
    if (2 * (records_.size() + 1) > slots_.size()) index(std::max(kFirstSlots, 2 * slots_.size()));
    const std::size_t i = slot(a, b);
    if (slots_[i] < 0) {
        slots_[i] = static_cast<std::int32_t>(records_.size());
        PairRecord r;
        r.a = a;
        r.b = b;
        r.lengths = pair_lengths(model, state, a, b);
        records_.push_back(std::move(r));
    }
    PairRecord& record = records_[static_cast<std::size_t>(slots_[i])];
    record.step = step_;
    return record;
}

void PairTable::index(std::size_t slots) {
    slots_.assign(slots, -1);
    for (std::size_t k = 0; k < records_.size(); ++k)
        slots_[slot(records_[k].a, records_[k].b)] = static_cast<std::int32_t>(k);
}

} // namespace flotilla
