// SPDX-License-Identifier: MIT
#include "broadphase/pairs.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "parallel/compact.hpp"
#include "parallel/team_sort.hpp"

namespace flotilla {
namespace {

constexpr std::int64_t kMaxCellsPerBody = 64;
constexpr double kCellOfMedian = 1.5;      // cell edge in median body sizes
constexpr double kLargestCoordinate = 1e6; // cells; farther away bodies share the outermost one
constexpr std::size_t kBodyGrain = 128, kCellGrain = 128, kChunkGrain = 16, kPairGrain = 2048; // items of a task

Box inflated(const SweptBody& b) {
    const Vec3 r{b.reach, b.reach, b.reach};
    return {b.box.lower - r, b.box.upper + r};
}

bool near(const SweptBody& a, const SweptBody& b) { return boxes_overlap(a.box, b.box, a.reach + b.reach); }

std::int64_t cell_key(const std::array<std::int64_t, 3>& c) {
    constexpr std::int64_t kOffset = 1 << 20;
    return ((c[0] + kOffset) << 42) | ((c[1] + kOffset) << 21) | (c[2] + kOffset);
}

} // namespace

const std::vector<CandidatePair>& Broadphase::find(Team& team, const std::vector<SweptBody>& bodies) {
    choose_grid(bodies);
    rasterize(team, bodies);
    const std::size_t chunks = pair_cells(team, bodies);
    gather(team, chunks + pair_large(team, bodies, chunks));
    team_sort(team, pairs_, sorted_pairs_, std::less<>());
    return pairs_;
}

const std::vector<CandidatePair>& Broadphase::update(Team& team, const std::vector<SweptBody>& bodies,
                                                     std::span<const std::int32_t> changed) {
    has_changed_.assign(bodies.size(), 0);
    for (const std::int32_t i : changed) has_changed_[static_cast<std::size_t>(i)] = 1;
    const auto stays = [&](std::size_t i) {
        const CandidatePair& p = pairs_[i];
        return (has_changed_[static_cast<std::size_t>(p.a)] | has_changed_[static_cast<std::size_t>(p.b)]) == 0;
    };
    const auto item = [&](std::size_t i) { return pairs_[i]; };
    compact_if({&team, "pairs that stay", kPairGrain, places_}, pairs_.size(), stays, kept_, 0, item);
    gather(team, pair_changed(team, bodies, changed));
    std::sort(pairs_.begin(), pairs_.end());
    sorted_pairs_.resize(kept_.size() + pairs_.size());
    std::merge(kept_.begin(), kept_.end(), pairs_.begin(), pairs_.end(), sorted_pairs_.begin());
    pairs_.swap(sorted_pairs_);
    return pairs_;
}

// Few bodies are held against all others: no grid to make.
std::size_t Broadphase::pair_changed(Team& team, const std::vector<SweptBody>& bodies,
                                     std::span<const std::int32_t> changed) {
    found_.resize(std::max(found_.size(), changed.size()));
    team.for_each("pairs of changed bodies", changed.size(), 1, [&](std::size_t k, int) {
        const std::int32_t a = changed[k];
        const SweptBody& p = bodies[static_cast<std::size_t>(a)];
        auto& out = found_[k];
        out.clear();
        for (std::int32_t b = 0; b < static_cast<std::int32_t>(bodies.size()); ++b) {
            const SweptBody& q = bodies[static_cast<std::size_t>(b)];
            if (!near(p, q) || a == b || (!p.movable && !q.movable)) continue;
            if (b < a && has_changed_[static_cast<std::size_t>(b)] != 0) continue; // found from the other side
            out.push_back({std::min(a, b), std::max(a, b)});
        }
    });
    return changed.size();
}

void Broadphase::choose_grid(const std::vector<SweptBody>& bodies) {
    sizes_.clear();
    origin_ = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
               std::numeric_limits<double>::infinity()};
    for (const SweptBody& b : bodies) {
        if (!b.movable) continue;
        sizes_.push_back(max_component(extent(b.box)) + 2 * b.reach);
        origin_ = min(origin_, b.box.lower);
    }
    if (sizes_.empty()) return;
    const auto middle = sizes_.begin() + static_cast<std::ptrdiff_t>(sizes_.size() / 2);
    std::nth_element(sizes_.begin(), middle, sizes_.end());
    cell_size_ = std::max(kCellOfMedian * *middle, std::numeric_limits<double>::min());
}

std::array<std::int64_t, 3> Broadphase::cell_of(const Vec3& p) const {
    const auto index = [&](double x, double x0) {
        // NaN and infinity go to the outermost cell: min and max keep their second operand there.
        return static_cast<std::int64_t>(
            std::floor(std::max(std::min((x - x0) / cell_size_, kLargestCoordinate), -kLargestCoordinate)));
    };
    return {index(p.x, origin_.x), index(p.y, origin_.y), index(p.z, origin_.z)};
}

Broadphase::CellRange Broadphase::cells_of(const SweptBody& body) const {
    const Box box = inflated(body);
    CellRange r{cell_of(box.lower), cell_of(box.upper)};
    const std::int64_t count = (r.high[0] - r.low[0] + 1) * (r.high[1] - r.low[1] + 1) * (r.high[2] - r.low[2] + 1);
    r.count = count > kMaxCellsPerBody || count <= 0 ? 0 : count;
    return r;
}

void Broadphase::rasterize(Team& team, const std::vector<SweptBody>& bodies) {
    ranges_.resize(bodies.size());
    offset_.resize(bodies.size());
    team.for_each("rasterize: count", bodies.size(), kBodyGrain,
                  [&](std::size_t i, int) { ranges_[i] = cells_of(bodies[i]); });
    large_.clear();
    std::size_t cells = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        offset_[i] = cells;
        cells += static_cast<std::size_t>(ranges_[i].count);
        if (ranges_[i].count == 0) large_.push_back(static_cast<std::int32_t>(i));
    }
    cells_.resize(cells);
    team.for_each("rasterize: scatter", bodies.size(), kBodyGrain, [&](std::size_t i, int) {
        const CellRange& r = ranges_[i];
        if (r.count == 0) return;
        Cell* out = cells_.data() + offset_[i];
        for (std::int64_t x = r.low[0]; x <= r.high[0]; ++x)
            for (std::int64_t y = r.low[1]; y <= r.high[1]; ++y)
                for (std::int64_t z = r.low[2]; z <= r.high[2]; ++z)
                    *out++ = {cell_key({x, y, z}), static_cast<std::int32_t>(i)};
    });
    team_sort(team, cells_, sorted_cells_,
              [](const Cell& p, const Cell& q) { return p.key != q.key ? p.key < q.key : p.body < q.body; });
}

std::size_t Broadphase::pair_cells(Team& team, const std::vector<SweptBody>& bodies) {
    const std::size_t n = cells_.size(), chunks = (n + kCellGrain - 1) / kCellGrain;
    found_.resize(std::max(found_.size(), chunks));
    // A chunk takes the runs of one cell that begin in it.
    team.for_chunks("pairs of cells", n, kCellGrain, [&](std::size_t first, std::size_t last, int) {
        auto& out = found_[first / kCellGrain];
        out.clear();
        std::size_t begin = first;
        while (begin > 0 && begin < last && cells_[begin].key == cells_[begin - 1].key) ++begin;
        for (std::size_t end = begin; begin < last; begin = end) {
            while (end < n && cells_[end].key == cells_[begin].key) ++end;
            pair_run(begin, end, bodies, out);
        }
    });
    return chunks;
}

void Broadphase::pair_run(std::size_t begin, std::size_t end, const std::vector<SweptBody>& bodies,
                          std::vector<CandidatePair>& out) const {
    for (std::size_t i = begin; i < end; ++i)
        for (std::size_t j = i + 1; j < end; ++j) {
            const auto a = cells_[i].body, b = cells_[j].body;
            const SweptBody &p = bodies[static_cast<std::size_t>(a)], &q = bodies[static_cast<std::size_t>(b)];
            if ((!p.movable && !q.movable) || !near(p, q)) continue;
            // A pair is met in every cell that both fill: it counts in the first, the lower corner of the common part.
            const Vec3 corner = max(inflated(p).lower, inflated(q).lower);
            if (cell_key(cell_of(corner)) == cells_[begin].key) out.push_back({a, b});
        }
}

std::size_t Broadphase::pair_large(Team& team, const std::vector<SweptBody>& bodies, std::size_t first_chunk) {
    if (large_.empty()) return 0;
    const std::size_t n = bodies.size(), chunks = (n + kBodyGrain - 1) / kBodyGrain;
    found_.resize(std::max(found_.size(), first_chunk + chunks));
    team.for_chunks("pairs of large bodies", n, kBodyGrain, [&](std::size_t first, std::size_t last, int) {
        auto& out = found_[first_chunk + first / kBodyGrain];
        out.clear();
        for (std::size_t i = first; i < last; ++i) {
            const auto b = static_cast<std::int32_t>(i);
            const SweptBody& q = bodies[i];
            for (const std::int32_t a : large_) {
                if (a == b || (ranges_[i].count == 0 && b < a)) continue; // two large ones: once
                const SweptBody& p = bodies[static_cast<std::size_t>(a)];
                if ((p.movable || q.movable) && near(p, q)) out.push_back({std::min(a, b), std::max(a, b)});
            }
        }
    });
    return chunks;
}

void Broadphase::gather(Team& team, std::size_t chunks) {
    const std::span<const std::vector<CandidatePair>> parts(found_.data(), chunks);
    const auto put = [&](std::size_t place, const std::vector<CandidatePair>& part) {
        std::copy(part.begin(), part.end(), pairs_.begin() + static_cast<std::ptrdiff_t>(place));
    };
    gather_parts({&team, "gather pairs", kChunkGrain, places_}, parts, pairs_, put);
}

} // namespace flotilla
