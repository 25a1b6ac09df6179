// SPDX-License-Identifier: MIT
#include "ccd/leaf_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"
#include "ccd/separation.hpp"

namespace flotilla {
namespace {

Vec3 direction_of(const float (&d)[3]) { return {d[0], d[1], d[2]}; }

std::span<const std::int32_t> vertices_of(const BodyMotion& body, std::int32_t leaf) {
    return body.shape->bvh.leaf_vertices(body.shape->bvh.nodes[at(leaf)]);
}

/// The lesser distance that the vertices of two leaves keep along a direction, and two vertices that do.
struct Extremes {
    double gap;
    std::int32_t a, b;
};
Extremes extremes(const Vec3* xa, std::span<const std::int32_t> a, const Vec3* xb, std::span<const std::int32_t> b,
                  const Vec3& d) {
    double most = -std::numeric_limits<double>::infinity(), least = std::numeric_limits<double>::infinity();
    std::int32_t of_a = a[0], of_b = b[0];
    for (const std::int32_t v : a) {
        const double along = dot(d, xa[v]);
        of_a = along > most ? v : of_a;
        most = std::max(most, along);
    }
    for (const std::int32_t v : b) {
        const double along = dot(d, xb[v]);
        of_b = along < least ? v : of_b;
        least = std::min(least, along);
    }
    return {least - most, of_a, of_b};
}

double gap_along(const Vec3* xa, std::span<const std::int32_t> a, const Vec3* xb, std::span<const std::int32_t> b,
                 const Vec3& d) {
    double most = dot(d, xa[a[0]]), least = dot(d, xb[b[0]]);
    for (std::size_t i = 1; i < a.size(); ++i) most = std::max(most, dot(d, xa[a[i]]));
    for (std::size_t i = 1; i < b.size(); ++i) least = std::min(least, dot(d, xb[b[i]]));
    return least - most;
}

} // namespace

/// Directions between leaves of two bodies.
class LeafPairs::Separation {
  public:
    Separation(const BodyMotion& a, const BodyMotion& b)
        : a_(a), b_(b), error_(kGapRounding * std::max(a.max_abs(), b.max_abs())) {}

    /// Whether the kept direction proves the leaves farther apart than `distance` at the end, m.
    [[nodiscard]] bool proved_at_end(const NodeIds& leaves, const Kept& kept, double distance) const {
        const double gap = gap_along(a_.at1.x.data(), vertices_of(a_, leaves.a), b_.at1.x.data(),
                                     vertices_of(b_, leaves.b), direction_of(kept.direction));
        return kLengthRoom * (gap - error_) > distance;
    }

    /// Looks for a direction that proves both gaps greater than `least`, m, and stops where they exceed `wanted`: the
    /// kept one or, where there is none, `guess`, then Gilbert's steps (1966) towards the nearest point of the hull of
    /// all differences of vertices at both ends. Keeps the best.
    [[nodiscard]] bool find(const NodeIds& leaves, double least, double wanted, const Vec3& guess, Kept& kept) const {
        constexpr int kTrials = 4;
        const auto vertices_a = vertices_of(a_, leaves.a), vertices_b = vertices_of(b_, leaves.b);
        Vec3 d = direction_of(kept.direction), nearest;
        if (d == Vec3{}) d = guess == Vec3{} ? center(*b_.at1.box) - center(*a_.at1.box) : guess;
        double best = least;
        for (int trial = 0; trial < kTrials; ++trial) {
            const double size = length(d);
            if (!(size > 0)) break;
            const float unit[3] = {static_cast<float>(d.x / size), static_cast<float>(d.y / size),
                                   static_cast<float>(d.z / size)};
            d = direction_of(unit);
            const Extremes at0 = extremes(a_.at0.x.data(), vertices_a, b_.at0.x.data(), vertices_b, d);
            const Extremes at1 = extremes(a_.at1.x.data(), vertices_a, b_.at1.x.data(), vertices_b, d);
            const double lesser = kLengthRoom * (std::min(at0.gap, at1.gap) - error_);
            if (lesser > best) {
                best = lesser;
                std::copy(unit, unit + 3, kept.direction);
                kept.start_gap = std::nextafter(static_cast<float>(kLengthRoom * (at0.gap - error_)), -1.0f);
            }
            if (lesser > wanted) break;
            const Vec3 w = at0.gap < at1.gap ? b_.at0.x[at(at0.b)] - a_.at0.x[at(at0.a)]
                                             : b_.at1.x[at(at1.b)] - a_.at1.x[at(at1.a)];
            nearest = trial == 0 ? w : nearest_of_segment(nearest, w);
            d = nearest;
        }
        return best > least;
    }

  private:
    static Vec3 nearest_of_segment(const Vec3& p, const Vec3& q) {
        const Vec3 e = q - p;
        const double square = length_sq(e);
        return square > 0 ? p + std::clamp(-dot(p, e) / square, 0.0, 1.0) * e : p;
    }

    const BodyMotion &a_, &b_;
    double error_;
};

void LeafPairs::drop() {
    leaves_ = std::vector<NodeIds>(); // of {} a vector keeps its memory
    kept_ = std::vector<Kept>();
}

bool LeafPairs::find(const BodyMotion& a, const BodyMotion& b, const ListingReach& reach, std::vector<NodeIds>& found) {
    constexpr std::size_t kRoom = 128;
    const Isa isa = best_isa();
    const ListingArrays arrays_a = listing_arrays(a), arrays_b = listing_arrays(b);
    ListingStack stack;
    stack.pairs[stack.size++] = {0, 0};
    std::size_t n = 0;
    while (stack.size > 0 && n <= kMost) {
        if (found.size() < n + kRoom) found.resize(n + kRoom);
        n += static_cast<std::size_t>(
            open_node_pairs(arrays_a, arrays_b, reach, stack, found.data() + n, static_cast<long>(kRoom), isa));
    }
    if (n > kMost || 2 * n < leaves_.capacity()) drop();
    if (n > kMost) return false;
    leaves_.assign(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(n));
    kept_.assign(n, {});
    return true;
}

std::span<const FeaturePair> LeafPairs::select(FeatureTest test, const BodyMotion& a, const BodyMotion& b,
                                               const CoarseReach& reach, FeatureBuffer& buffer) const {
    // Leaves that touch do so again, and a look in vain costs as much as their features.
    constexpr std::int32_t kLeftOut = 8;
    constexpr double kWanted = 16; // of what is clear: a direction that serves the next queries as well
    if (buffer.meeting.size() < size() + 1) buffer.meeting.resize(size() + 1);
    const long meeting = meeting_leaves(listing_arrays(a), listing_arrays(b), reach.distance(), leaves_.data(),
                                        static_cast<long>(size()), buffer.meeting.data(), best_isa());
    const double distance = double{reach.distance()}, clear = kClear * distance;
    const bool swept = test == FeatureTest::swept;
    const double least_start = swept ? clear : 0, least_end = swept ? clear : distance;
    const Separation separation(a, b);
    Vec3 last; // direction found
    buffer.open.clear();
    for (const std::int32_t i : std::span(buffer.meeting).first(static_cast<std::size_t>(meeting))) {
        const NodeIds& leaves = leaves_[at(i)];
        Kept& kept = kept_[at(i)];
        if (double{kept.start_gap} > least_start && separation.proved_at_end(leaves, kept, least_end)) continue;
        if (swept && kept.in_vain-- <= 0) {
            kept.in_vain = kLeftOut;
            if (separation.find(leaves, clear, kWanted * clear, last, kept)) {
                kept.in_vain = 0;
                last = direction_of(kept.direction);
                continue;
            }
        }
        buffer.open.push_back(leaves);
    }
    return buffer.open.empty() ? std::span<const FeaturePair>{} : features_of_leaves(a, b, reach, buffer);
}

} // namespace flotilla
