// SPDX-License-Identifier: MIT
#include "broadphase/pairs.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "base/index.hpp"
#include "broadphase/swept_boxes.hpp"
#include "parallel/compact.hpp"
#include "parallel/team_sort.hpp"

namespace flotilla {
namespace {

constexpr std::int64_t kMaxCellsPerBody = 64, kNoLimit = std::int64_t{1} << 18;
constexpr std::size_t kFewestBodies = 8;   // whose boxes are compared in less time than sorted into cells
constexpr double kCellOfMedian = 1.5;      // cell edge in median body sizes
constexpr double kLargestCoordinate = 1e6; // cells; farther away bodies share the outermost one
constexpr std::size_t kBodyGrain = 128, kCellGrain = 128, kChunkGrain = 16, kPairGrain = 2048; // items of a task

std::int64_t cell_key(const std::array<std::int64_t, 3>& c) {
    constexpr std::int64_t kOffset = 1 << 20;
    return ((c[0] + kOffset) << 42) | ((c[1] + kOffset) << 21) | (c[2] + kOffset);
}

CandidatePair pair_of(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

} // namespace

void BodyGrid::choose_cells(const std::vector<Item>& items) {
    sizes_.clear();
    origin_ = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
               std::numeric_limits<double>::infinity()};
    for (const Item& item : items) {
        if (!item.sizes_cells) continue;
        sizes_.push_back(max_component(extent(item.box)));
        origin_ = min(origin_, item.box.lower);
    }
    if (sizes_.empty()) return;
    const auto middle = sizes_.begin() + static_cast<std::ptrdiff_t>(sizes_.size() / 2);
    std::nth_element(sizes_.begin(), middle, sizes_.end());
    cell_size_ = std::max(kCellOfMedian * *middle, std::numeric_limits<double>::min());
}

std::array<std::int64_t, 3> BodyGrid::cell_of(const Vec3& p) const {
    const auto index = [&](double x, double x0) {
        // NaN and infinity go to the outermost cell: min and max keep their second operand there.
        return static_cast<std::int64_t>(
            std::floor(std::max(std::min((x - x0) / cell_size_, kLargestCoordinate), -kLargestCoordinate)));
    };
    return {index(p.x, origin_.x), index(p.y, origin_.y), index(p.z, origin_.z)};
}

std::int64_t BodyGrid::cell_key_of(const Vec3& p) const { return cell_key(cell_of(p)); }

BodyGrid::CellRange BodyGrid::cells_of(const Box& box) const {
    CellRange r{cell_of(box.lower), cell_of(box.upper)};
    const std::int64_t count = (r.high[0] - r.low[0] + 1) * (r.high[1] - r.low[1] + 1) * (r.high[2] - r.low[2] + 1);
    r.count = count > most_cells_ || count <= 0 ? 0 : count;
    return r;
}

template <typename Visit>
void for_cells(const BodyGrid::CellRange& r, Visit&& visit) {
    for (std::int64_t x = r.low[0]; x <= r.high[0]; ++x)
        for (std::int64_t y = r.low[1]; y <= r.high[1]; ++y)
            for (std::int64_t z = r.low[2]; z <= r.high[2]; ++z) visit(cell_key({x, y, z}));
}

void BodyGrid::build(Team& team, const std::vector<Item>& items, std::int64_t most_cells, std::size_t fewest) {
    choose_cells(items);
    most_cells_ = most_cells;
    const bool has_cells = !sizes_.empty() && items.size() >= fewest; // else nothing says how large they should be
    ranges_.resize(items.size());
    offset_.resize(items.size());
    team.for_each("rasterize: count", items.size(), kBodyGrain,
                  [&](std::size_t i, int) { ranges_[i] = has_cells ? cells_of(items[i].box) : CellRange{}; });
    large_.clear();
    std::size_t cells = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        offset_[i] = cells;
        cells += static_cast<std::size_t>(ranges_[i].count);
        if (ranges_[i].count == 0) large_.push_back(items[i].body);
    }
    cells_.resize(cells);
    team.for_each("rasterize: scatter", items.size(), kBodyGrain, [&](std::size_t i, int) {
        if (ranges_[i].count == 0) return;
        Cell* out = cells_.data() + offset_[i];
        for_cells(ranges_[i], [&](std::int64_t key) { *out++ = {key, items[i].body}; });
    });
    team_sort(team, cells_, sorted_cells_,
              [](const Cell& p, const Cell& q) { return p.key != q.key ? p.key < q.key : p.body < q.body; });
}

template <typename Visit>
void BodyGrid::for_near(const Box& box, Visit&& visit) const {
    for (const std::int32_t body : large_) visit(body);
    if (cells_.empty()) return;
    const CellRange range = cells_of(box);
    if (range.count == 0) {
        for (const Cell& c : cells_) visit(c.body);
        return;
    }
    for_cells(range, [&](std::int64_t key) {
        auto c = std::lower_bound(cells_.begin(), cells_.end(), key,
                                  [](const Cell& cell, std::int64_t k) { return cell.key < k; });
        for (; c != cells_.end() && c->key == key; ++c) visit(c->body);
    });
}

const std::vector<CandidatePair>& Broadphase::find(Team& team, const PairSearch& search) {
    sort_in_still(team, search);
    sort_in_active(team, search);
    std::size_t chunks = pair_cells(team, search);
    chunks += pair_large(team, search, chunks);
    gather(team, chunks + pair_still(team, search, chunks));
    team_sort(team, pairs_, sorted_pairs_, std::less<>());
    return pairs_;
}

void Broadphase::sort_in_still(Team& team, const PairSearch& search) {
    if (has_still_ && still_version_ == search.still_version) return;
    items_.clear();
    auto active = search.active.begin();
    for (std::size_t i = 0; i < search.bodies.size(); ++i) {
        if (active != search.active.end() && at(*active) == i) {
            ++active;
            continue;
        }
        const SweptBody& b = search.bodies[i];
        if (b.present) items_.push_back({static_cast<std::int32_t>(i), inflated(b.box, b.waking_reach), true});
    }
    build_grid(team, search, still_);
    still_version_ = search.still_version;
    has_still_ = true;
}

void Broadphase::sort_in_active(Team& team, const PairSearch& search) {
    items_.clear();
    for (const std::int32_t i : search.active) {
        const SweptBody& b = search.bodies[at(i)];
        items_.push_back({i, inflated(b), b.movable});
    }
    build_grid(team, search, active_);
}

void Broadphase::build_grid(Team& team, const PairSearch& search, BodyGrid& grid) {
    const bool large = search.savings.large_bodies;
    grid.build(team, items_, large ? kMaxCellsPerBody : kNoLimit, large ? kFewestBodies : 0);
}

const std::vector<CandidatePair>& Broadphase::update(Team& team, const PairSearch& search,
                                                     std::span<const std::int32_t> changed) {
    has_changed_.assign(search.bodies.size(), 0);
    for (const std::int32_t i : changed) has_changed_[at(i)] = 1;
    const auto stays = [&](std::size_t i) {
        const CandidatePair& p = pairs_[i];
        return (has_changed_[at(p.a)] | has_changed_[at(p.b)]) == 0;
    };
    const auto item = [&](std::size_t i) { return pairs_[i]; };
    compact_if({&team, "pairs that stay", kPairGrain, places_}, pairs_.size(), stays, kept_, 0, item);
    gather(team, pair_changed(team, search, changed));
    std::sort(pairs_.begin(), pairs_.end());
    sorted_pairs_.resize(kept_.size() + pairs_.size());
    std::merge(kept_.begin(), kept_.end(), pairs_.begin(), pairs_.end(), sorted_pairs_.begin());
    pairs_.swap(sorted_pairs_);
    return pairs_;
}

// Few bodies are held against all others: no grid to make.
std::size_t Broadphase::pair_changed(Team& team, const PairSearch& search, std::span<const std::int32_t> changed) {
    found_.resize(std::max(found_.size(), changed.size()));
    team.for_each("pairs of changed bodies", changed.size(), 1, [&](std::size_t k, int) {
        const std::int32_t a = changed[k];
        const SweptBody& p = search.bodies[at(a)];
        auto& out = found_[k];
        out.clear();
        for (const std::int32_t b : search.active) {
            if (a == b || !may_pair(p, search.bodies[at(b)], false)) continue;
            if (b < a && has_changed_[at(b)] != 0) continue; // found from the other side
            out.push_back(pair_of(a, b));
        }
        pair_with_still(a, search, out);
    });
    return changed.size();
}

std::size_t Broadphase::pair_cells(Team& team, const PairSearch& search) {
    const std::vector<BodyGrid::Cell>& cells = active_.cells();
    const std::size_t n = cells.size(), chunks = (n + kCellGrain - 1) / kCellGrain;
    found_.resize(std::max(found_.size(), chunks));
    // A chunk takes the runs of one cell that begin in it.
    team.for_chunks("pairs of cells", n, kCellGrain, [&](std::size_t first, std::size_t last, int) {
        auto& out = found_[first / kCellGrain];
        out.clear();
        std::size_t begin = first;
        while (begin > 0 && begin < last && cells[begin].key == cells[begin - 1].key) ++begin;
        for (std::size_t end = begin; begin < last; begin = end) {
            while (end < n && cells[end].key == cells[begin].key) ++end;
            pair_run(begin, end, search, out);
        }
    });
    return chunks;
}

void Broadphase::pair_run(std::size_t begin, std::size_t end, const PairSearch& search,
                          std::vector<CandidatePair>& out) const {
    const std::vector<BodyGrid::Cell>& cells = active_.cells();
    for (std::size_t i = begin; i < end; ++i)
        for (std::size_t j = i + 1; j < end; ++j) {
            const auto a = cells[i].body, b = cells[j].body;
            const SweptBody &p = search.bodies[at(a)], &q = search.bodies[at(b)];
            if (!may_pair(p, q, false)) continue;
            // A pair is met in every cell that both fill: it counts in the first, the lower corner of the common part.
            const Vec3 corner = max(inflated(p).lower, inflated(q).lower);
            if (active_.cell_key_of(corner) == cells[begin].key) out.push_back({a, b});
        }
}

std::size_t Broadphase::pair_large(Team& team, const PairSearch& search, std::size_t first_chunk) {
    const std::vector<std::int32_t>& large = active_.large();
    if (large.empty()) return 0;
    const std::size_t n = search.active.size(), chunks = (n + kBodyGrain - 1) / kBodyGrain;
    found_.resize(std::max(found_.size(), first_chunk + chunks));
    team.for_chunks("pairs of large bodies", n, kBodyGrain, [&](std::size_t first, std::size_t last, int) {
        auto& out = found_[first_chunk + first / kBodyGrain];
        out.clear();
        for (std::size_t i = first; i < last; ++i) {
            const std::int32_t b = search.active[i];
            const bool b_large = std::binary_search(large.begin(), large.end(), b);
            for (const std::int32_t a : large) {
                if (a == b || (b_large && b < a)) continue; // two large ones: once
                if (may_pair(search.bodies[at(a)], search.bodies[at(b)], false)) out.push_back(pair_of(a, b));
            }
        }
    });
    return chunks;
}

std::size_t Broadphase::pair_still(Team& team, const PairSearch& search, std::size_t first_chunk) {
    const std::size_t n = search.active.size(), chunks = (n + kBodyGrain - 1) / kBodyGrain;
    found_.resize(std::max(found_.size(), first_chunk + chunks));
    team.for_chunks("pairs with still bodies", n, kBodyGrain, [&](std::size_t first, std::size_t last, int) {
        auto& out = found_[first_chunk + first / kBodyGrain];
        out.clear();
        for (std::size_t i = first; i < last; ++i) pair_with_still(search.active[i], search, out);
    });
    return chunks;
}

void Broadphase::pair_with_still(std::int32_t body, const PairSearch& search, std::vector<CandidatePair>& out) const {
    const SweptBody& p = search.bodies[at(body)];
    const auto first = static_cast<std::ptrdiff_t>(out.size());
    still_.for_near(inflated(p), [&](std::int32_t other) {
        if (may_pair(p, search.bodies[at(other)], search.wakes)) out.push_back(pair_of(body, other));
    });
    std::sort(out.begin() + first, out.end()); // a pair is met in every cell that both fill
    out.erase(std::unique(out.begin() + first, out.end()), out.end());
}

void Broadphase::gather(Team& team, std::size_t chunks) {
    const std::span<const std::vector<CandidatePair>> parts(found_.data(), chunks);
    const auto put = [&](std::size_t place, const std::vector<CandidatePair>& part) {
        std::copy(part.begin(), part.end(), pairs_.begin() + static_cast<std::ptrdiff_t>(place));
    };
    gather_parts({&team, "gather pairs", kChunkGrain, places_}, parts, pairs_, put);
}

} // namespace flotilla
