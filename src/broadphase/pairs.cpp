// SPDX-License-Identifier: MIT
#include "broadphase/pairs.hpp"

#include <algorithm>
#include <limits>

namespace flotilla {
namespace {

constexpr std::int64_t kMaxCellsPerBody = 64;
constexpr double kCellOfMedian = 1.5;      // cell edge in median body sizes
constexpr double kLargestCoordinate = 1e6; // cells; farther away bodies share the outermost one

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

const std::vector<CandidatePair>& Broadphase::find(const std::vector<SweptBody>& bodies) {
    pairs_.clear();
    choose_grid(bodies);
    rasterize(bodies);
    pair_cells(bodies);
    pair_large(bodies);
    std::sort(pairs_.begin(), pairs_.end());
    return pairs_;
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

void Broadphase::rasterize(const std::vector<SweptBody>& bodies) {
    cells_.clear();
    large_.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Box box = inflated(bodies[i]);
        const auto lo = cell_of(box.lower), hi = cell_of(box.upper);
        const std::int64_t count = (hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1);
        if (count > kMaxCellsPerBody || count <= 0) {
            large_.push_back(static_cast<std::int32_t>(i));
            continue;
        }
        for (std::int64_t x = lo[0]; x <= hi[0]; ++x)
            for (std::int64_t y = lo[1]; y <= hi[1]; ++y)
                for (std::int64_t z = lo[2]; z <= hi[2]; ++z)
                    cells_.push_back({cell_key({x, y, z}), static_cast<std::int32_t>(i)});
    }
    std::sort(cells_.begin(), cells_.end(),
              [](const Cell& p, const Cell& q) { return p.key != q.key ? p.key < q.key : p.body < q.body; });
}

void Broadphase::pair_cells(const std::vector<SweptBody>& bodies) {
    for (std::size_t begin = 0, end = 0; begin < cells_.size(); begin = end) {
        while (end < cells_.size() && cells_[end].key == cells_[begin].key) ++end;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = i + 1; j < end; ++j) {
                const auto a = cells_[i].body, b = cells_[j].body;
                const SweptBody &p = bodies[static_cast<std::size_t>(a)], &q = bodies[static_cast<std::size_t>(b)];
                if ((!p.movable && !q.movable) || !near(p, q)) continue;
                // A pair is met in every cell that both fill: it counts in the first, the lower corner of the common part.
                const Vec3 corner = max(inflated(p).lower, inflated(q).lower);
                if (cell_key(cell_of(corner)) == cells_[begin].key) pairs_.push_back({a, b});
            }
    }
}

void Broadphase::pair_large(const std::vector<SweptBody>& bodies) {
    for (std::size_t l = 0; l < large_.size(); ++l) {
        const std::int32_t a = large_[l];
        const SweptBody& p = bodies[static_cast<std::size_t>(a)];
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const auto b = static_cast<std::int32_t>(i);
            const bool both_large = std::binary_search(large_.begin(), large_.end(), b);
            if (a == b || (both_large && b < a)) continue;
            const SweptBody& q = bodies[i];
            if ((p.movable || q.movable) && near(p, q)) pairs_.push_back({std::min(a, b), std::max(a, b)});
        }
    }
}

} // namespace flotilla
