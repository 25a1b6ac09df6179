// SPDX-License-Identifier: MIT
#include "mesh/bvh.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "base/index.hpp"
#include "mesh/placement_avx2.hpp"

namespace flotilla {
namespace {

constexpr int kBins = 16;

/// Proportional to the surface of a box: the chance that it is met, were other boxes spread evenly.
double half_area(const Box& b) {
    const Vec3 e = extent(b);
    return (e.x * e.y + e.y * e.z) + e.z * e.x;
}

struct Split {
    int axis = -1; ///< -1: none found
    int bin = 0;   ///< bins below it go left
    double cost = std::numeric_limits<double>::infinity();
};

struct Bin {
    Box box;
    std::int32_t count = 0;
};

/// Maps a centroid to its bin along one axis.
struct BinScale {
    double lower, factor;
    BinScale(const Box& centroids, int axis)
        : lower(component(centroids.lower, axis)),
          factor(kBins / (component(centroids.upper, axis) - component(centroids.lower, axis))) {}
    /// Infinite or NaN factors (no extent along the axis) are excluded by the caller.
    [[nodiscard]] int bin(double x) const { return std::clamp(static_cast<int>((x - lower) * factor), 0, kBins - 1); }
};

class Builder {
  public:
    Builder(const TriangleMesh& mesh, const BvhOptions& options)
        : max_leaf_(std::max(options.max_leaf_triangles, 1)),
          boxes_(mesh.triangles.size()),
          centroids_(mesh.triangles.size()) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& v = mesh.triangles[t];
            boxes_[t] = box_of(mesh.vertices[at(v[0])], mesh.vertices[at(v[1])], mesh.vertices[at(v[2])]);
            centroids_[t] = center(boxes_[t]);
        }
        bvh_.triangles.resize(mesh.triangles.size());
        std::iota(bvh_.triangles.begin(), bvh_.triangles.end(), 0);
        build(0, static_cast<std::int32_t>(mesh.triangles.size()), 0);
        bvh_.corners.reserve(mesh.triangles.size());
        for (std::int32_t t : bvh_.triangles) bvh_.corners.push_back(mesh.triangles[at(t)]);
        list_vertices();
        std::vector<Box> boxes;
        refit(bvh_, mesh.vertices, boxes);
        for (const Box& box : boxes) bvh_.sizes.push_back(static_cast<float>(bvh_detail::extent_sum(box)));
    }
    Bvh take() { return std::move(bvh_); }

  private:
    void list_vertices() {
        std::vector<std::int32_t>& list = bvh_.vertices;
        bvh_.first_vertex.assign(bvh_.triangles.size() + 1, 0);
        for (const BvhNode& node : bvh_.nodes) { // leaves come in the order of their triangles
            if (node.count == 0) continue;
            const auto begin = static_cast<std::ptrdiff_t>(list.size());
            for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
                for (const std::int32_t v : bvh_.corners[at(k)])
                    if (std::find(list.begin() + begin, list.end(), v) == list.end()) list.push_back(v);
                bvh_.first_vertex[at(k + 1)] = static_cast<std::int32_t>(list.size());
            }
        }
    }

    void build(std::int32_t first, std::int32_t last, int depth) {
        const auto node = bvh_.nodes.size();
        bvh_.nodes.push_back({first, last - first});
        bvh_.depth = std::max(bvh_.depth, depth);
        if (last - first <= max_leaf_) return;
        const std::int32_t middle = split(first, last, depth);
        build(first, middle, depth + 1);
        bvh_.nodes[node] = {static_cast<std::int32_t>(bvh_.nodes.size()), 0};
        build(middle, last, depth + 1);
    }

    /// Reorders [first, last) and returns where the right half begins.
    std::int32_t split(std::int32_t first, std::int32_t last, int depth) {
        Box bounds;
        for (std::int32_t i = first; i < last; ++i) bounds = extended(bounds, centroid(i));
        // Halving by count needs 31 levels for the largest mesh, so the depth stays below kMaxBvhDepth.
        const bool halve = depth >= kMaxBvhDepth / 2;
        const Split s = halve ? Split{} : best_split(first, last, bounds);
        if (s.axis < 0) return split_at_median(first, last, bounds);
        const BinScale scale(bounds, s.axis);
        const auto middle =
            std::stable_partition(bvh_.triangles.begin() + first, bvh_.triangles.begin() + last, [&](std::int32_t t) {
                return scale.bin(component(centroids_[at(t)], s.axis)) < s.bin;
            });
        return static_cast<std::int32_t>(middle - bvh_.triangles.begin());
    }

    /// The cheapest split between bins; ties go to the lower axis and the lower bin.
    Split best_split(std::int32_t first, std::int32_t last, const Box& bounds) const {
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            const BinScale scale(bounds, axis);
            if (!(scale.factor > 0 && scale.factor < std::numeric_limits<double>::infinity())) continue;
            std::array<Bin, kBins> bins;
            for (std::int32_t i = first; i < last; ++i) {
                Bin& bin = bins[at(scale.bin(component(centroid(i), axis)))];
                bin.box = merged(bin.box, boxes_[at(bvh_.triangles[at(i)])]);
                ++bin.count;
            }
            const Split s = best_of_bins(bins, axis);
            if (s.cost < best.cost) best = s;
        }
        return best;
    }

    static Split best_of_bins(const std::array<Bin, kBins>& bins, int axis) {
        std::array<double, kBins> right_cost{};
        Bin right;
        for (std::size_t i = kBins - 1; i > 0; --i) {
            right.box = merged(right.box, bins[i].box);
            right.count += bins[i].count;
            right_cost[i] =
                right.count > 0 ? half_area(right.box) * right.count : std::numeric_limits<double>::infinity();
        }
        Split best;
        Bin left;
        for (std::size_t i = 1; i < kBins; ++i) {
            left.box = merged(left.box, bins[i - 1].box);
            left.count += bins[i - 1].count;
            if (left.count == 0) continue;
            const double cost = half_area(left.box) * left.count + right_cost[i];
            if (cost < best.cost) best = {axis, static_cast<int>(i), cost};
        }
        return best;
    }

    /// Halves along the longest axis of the centroids; equal centroids are told apart by triangle number.
    std::int32_t split_at_median(std::int32_t first, std::int32_t last, const Box& bounds) {
        const Vec3 e = extent(bounds);
        const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
        std::sort(bvh_.triangles.begin() + first, bvh_.triangles.begin() + last, [&](std::int32_t s, std::int32_t t) {
            const double cs = component(centroids_[at(s)], axis), ct = component(centroids_[at(t)], axis);
            return cs < ct || (cs == ct && s < t);
        });
        return first + (last - first) / 2;
    }

    [[nodiscard]] const Vec3& centroid(std::int32_t i) const { return centroids_[at(bvh_.triangles[at(i)])]; }

    std::int32_t max_leaf_;
    std::vector<Box> boxes_;
    std::vector<Vec3> centroids_;
    Bvh bvh_;
};

} // namespace

Bvh build_bvh(const TriangleMesh& mesh, const BvhOptions& options) {
    FLOTILLA_ASSERT(!mesh.triangles.empty());
    return Builder(mesh, options).take();
}

void refit(const Bvh& bvh, std::span<const Vec3> vertices, std::vector<Box>& boxes) {
    boxes.resize(bvh.nodes.size());
    for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
        const BvhNode node = bvh.nodes[i];
        if (node.count == 0) {
            boxes[i] = merged(boxes[i + 1], boxes[at(node.first)]);
            continue;
        }
        Box box;
        for (std::int32_t k = node.first; k < node.first + node.count; ++k) {
            const Triangle& t = bvh.corners[at(k)];
            box = merged(box, box_of(vertices[at(t[0])], vertices[at(t[1])], vertices[at(t[2])]));
        }
        boxes[i] = box;
    }
}

void refit(const Bvh& bvh, std::span<const CoarseBox> vertices, std::vector<CoarseBox>& boxes,
           [[maybe_unused]] Isa isa) {
    boxes.resize(bvh.nodes.size());
#if defined(__x86_64__)
    static_assert(sizeof(Triangle) == 3 * sizeof(std::int32_t)); // the kernel reads corners as bare numbers
    if (isa != Isa::scalar)
        return refit_avx2(bvh.nodes.data(), bvh.nodes.size(),
                          reinterpret_cast<const std::int32_t(*)[3]>(bvh.corners.data()), vertices.data(),
                          boxes.data());
#endif
    for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
        const BvhNode node = bvh.nodes[i];
        if (node.count == 0) {
            boxes[i] = merged(boxes[i + 1], boxes[at(node.first)]);
            continue;
        }
        CoarseBox box = vertices[at(bvh.corners[at(node.first)][0])];
        for (std::int32_t k = node.first; k < node.first + node.count; ++k)
            for (std::int32_t v : bvh.corners[at(k)]) box = merged(box, vertices[at(v)]);
        boxes[i] = box;
    }
}

} // namespace flotilla
