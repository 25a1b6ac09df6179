// SPDX-License-Identifier: MIT
#include "parallel/division.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <numeric>

#include "parallel/wait.hpp"

namespace flotilla {
namespace {

// Owners change where the slowest rank has so much more to do than the mean, and not before so many steps: with a body
// go what its owner knows of its pairs (neighbour lists), which has to be found again. Not measured.
constexpr double kUneven = 1.15;
constexpr int kStepsBetweenCuts = 4;
constexpr double kFading = 0.8;    // of the weights, with every step
constexpr double kLeastWeight = 1; // ns: bodies that cost nothing are shared out as well

std::size_t longest_side(std::span<const Vec3> points, std::span<const std::int32_t> some) {
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < some.size(); ++k) {
        const Vec3& p = points[static_cast<std::size_t>(some[k])];
        const std::array<double, 3> x{p.x, p.y, p.z};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = k == 0 ? x[axis] : std::min(low[axis], x[axis]);
            high[axis] = k == 0 ? x[axis] : std::max(high[axis], x[axis]);
        }
    }
    std::size_t longest = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
        if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    return longest;
}

struct Bisection {
    std::span<const Vec3> points;
    std::span<const double> weights;
    std::vector<std::int32_t>& part;

    [[nodiscard]] double coordinate(std::int32_t i, std::size_t axis) const {
        const Vec3& p = points[static_cast<std::size_t>(i)];
        return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    }
    void cut(std::span<std::int32_t> some, int first, int parts) const {
        if (parts == 1 || some.empty()) {
            for (const std::int32_t i : some) part[static_cast<std::size_t>(i)] = first;
            return;
        }
        const std::size_t axis = longest_side(points, some);
        std::sort(some.begin(), some.end(), [&](std::int32_t i, std::int32_t j) {
            const double x = coordinate(i, axis), y = coordinate(j, axis);
            return x != y ? x < y : i < j;
        });
        const int left = parts / 2;
        double all = 0;
        for (const std::int32_t i : some) all += weights[static_cast<std::size_t>(i)];
        const double wanted = all * left / parts;
        std::size_t end = 0;
        for (double sum = 0; end < some.size(); ++end) {
            const double weight = weights[static_cast<std::size_t>(some[end])];
            if (sum + 0.5 * weight >= wanted) break;
            sum += weight;
        }
        cut(some.first(end), first, left);
        cut(some.subspan(end), first + left, parts - left);
    }
};

} // namespace

std::vector<std::int32_t> bisect(std::span<const Vec3> points, std::span<const double> weights, int parts) {
    std::vector<std::int32_t> part(points.size()), all(points.size());
    std::iota(all.begin(), all.end(), 0);
    Bisection{points, weights, part}.cut(all, 0, parts);
    return part;
}

void Owners::begin_step(std::span<const Vec3> positions, std::span<const std::int32_t> active,
                        std::span<const std::int64_t> cost) {
    const bool first = owner_.size() != positions.size();
    owner_.resize(positions.size(), 0);
    weight_.resize(positions.size(), kLeastWeight);
    for (std::size_t k = 0; k < active.size(); ++k) {
        double& weight = weight_[static_cast<std::size_t>(active[k])];
        weight = kLeastWeight + kFading * (weight - kLeastWeight) + static_cast<double>(cost[k]);
    }
    imbalance_ = measured_imbalance(active);
    if (!first && (++steps_since_cut_ < kStepsBetweenCuts || imbalance_ < kUneven)) return;
    steps_since_cut_ = 0;
    std::vector<Vec3> points;
    std::vector<double> weights;
    for (const std::int32_t body : active) {
        points.push_back(positions[static_cast<std::size_t>(body)]);
        weights.push_back(weight_[static_cast<std::size_t>(body)]);
    }
    const std::vector<std::int32_t> part = bisect(points, weights, ranks_);
    for (std::size_t k = 0; k < active.size(); ++k) owner_[static_cast<std::size_t>(active[k])] = part[k];
}

double Owners::measured_imbalance(std::span<const std::int32_t> active) const {
    std::vector<double> of_rank(static_cast<std::size_t>(ranks_), 0.0);
    double all = 0;
    for (const std::int32_t body : active) {
        const double weight = weight_[static_cast<std::size_t>(body)];
        of_rank[static_cast<std::size_t>((*this)[body])] += weight;
        all += weight;
    }
    return all > 0 ? *std::max_element(of_rank.begin(), of_rank.end()) * ranks_ / all : 1;
}

/// Each rank counts on its own clock; the sums are the same everywhere.
void Division::begin_step(std::span<const Vec3> positions, std::span<const std::int32_t> active) {
    cost_.resize(positions.size(), 0);
    std::vector<std::int64_t> own;
    for (const std::int32_t body : active) own.push_back(cost_[static_cast<std::size_t>(body)]);
    std::fill(cost_.begin(), cost_.end(), 0);
    std::vector<std::int64_t> all(own.size() * static_cast<std::size_t>(size())), sums(own.size());
    const std::vector<std::size_t> sizes(static_cast<std::size_t>(size()), own.size() * sizeof(std::int64_t));
    ranks_.gather(std::as_bytes(std::span(own)), sizes, std::as_writable_bytes(std::span(all)));
    for (std::size_t k = 0; k < all.size(); ++k) sums[k % own.size()] += all[k];
    owners_.begin_step(positions, active, sums);
}

std::int64_t Division::clock() const { return log_ != nullptr ? thread_ns() : now_ns(); }

std::int64_t thread_ns() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return std::int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

GatheredBytes gather_bytes(Ranks& ranks, std::span<const std::byte> own) {
    const auto n = static_cast<std::size_t>(ranks.size());
    const std::vector<std::size_t> of_sizes(n, sizeof(std::uint64_t));
    const std::uint64_t size = own.size();
    std::vector<std::uint64_t> sizes(n);
    ranks.gather(std::as_bytes(std::span(&size, 1)), of_sizes, std::as_writable_bytes(std::span(sizes)));
    GatheredBytes out;
    out.begin.assign(1, 0);
    for (const std::uint64_t s : sizes) out.begin.push_back(out.begin.back() + s);
    out.all.resize(out.begin.back());
    const std::vector<std::size_t> counts(sizes.begin(), sizes.end());
    ranks.gather(own, counts, out.all);
    return out;
}

} // namespace flotilla
