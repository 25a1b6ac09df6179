// SPDX-License-Identifier: MIT
#include "panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "mesh/topology.hpp"

namespace flotilla::baseline {
namespace {

using Members = std::vector<std::int32_t>; ///< triangles
using Point2 = std::array<double, 2>;      ///< m

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

/// Twice the signed area of the triangle a, b, c.
double turn(const Point2& a, const Point2& b, const Point2& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Area of the convex hull, by Andrew's monotone chain.
double hull_area(std::vector<Point2> points) {
    std::sort(points.begin(), points.end());
    double twice = 0;
    for (const double side : {1.0, -1.0}) {
        std::vector<Point2> chain;
        for (const Point2& p : points) {
            while (chain.size() > 1 && side * turn(chain[chain.size() - 2], chain.back(), p) <= 0) chain.pop_back();
            chain.push_back(p);
        }
        for (std::size_t k = 2; k < chain.size(); ++k) twice += side * turn(chain[0], chain[k - 1], chain[k]);
    }
    return twice / 2;
}

/// Two unit vectors that make a right angle with `normal` and with each other.
std::pair<Vec3, Vec3> plane_axes(const Vec3& normal) {
    const Vec3 a = abs(normal);
    const Vec3 least = a.x <= a.y && a.x <= a.z ? Vec3{1, 0, 0} : a.y <= a.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    const Vec3 u = normalized(cross(normal, least));
    return {u, cross(normal, u)};
}

class Merger {
  public:
    Merger(const TriangleMesh& mesh, const PanelLimits& limits)
        : mesh_(mesh), limits_(limits), free_(mesh.triangles.size(), true), neighbours_(mesh.triangles.size()) {
        for (const Triangle& t : mesh.triangles) areas_.push_back(area_vector(t));
        find_neighbours();
    }

    std::vector<Panel> run() {
        std::vector<Panel> out;
        std::vector<Members> grown(mesh_.triangles.size()); // from each triangle; empty: to be grown (again)
        for (std::size_t left = mesh_.triangles.size(); left > 0;) {
            const Members& best = grown[largest(grown, left)];
            for (const std::int32_t t : best) free_[at(t)] = false;
            left -= best.size();
            out.push_back(panel_of(best));
            for (Members& members : grown)
                if (std::any_of(members.begin(), members.end(), [&](std::int32_t t) { return !free_[at(t)]; }))
                    members.clear();
        }
        return out;
    }

    Panel panel_of(Members members) const {
        std::sort(members.begin(), members.end());
        Panel out{std::move(members), {}, 0, 0};
        for (const std::int32_t t : out.triangles) out.normal += areas_[at(t)];
        out.normal = normalized(out.normal);
        out.low = std::numeric_limits<double>::infinity();
        out.high = -out.low;
        for (const std::int32_t t : out.triangles)
            for (const std::int32_t v : mesh_.triangles[at(t)]) {
                const double height = dot(out.normal, mesh_.vertices[at(v)]);
                out.low = std::min(out.low, height);
                out.high = std::max(out.high, height);
            }
        return out;
    }

  private:
    Vec3 area_vector(const Triangle& t) const {
        const Vec3 &a = mesh_.vertices[at(t[0])], &b = mesh_.vertices[at(t[1])], &c = mesh_.vertices[at(t[2])];
        return cross(b - a, c - a) / 2;
    }

    void find_neighbours() {
        const Topology topology = build_topology(mesh_);
        std::vector<Members> around(topology.edges.size());
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
            for (const std::int32_t e : topology.triangle_edges[t])
                around[at(e)].push_back(static_cast<std::int32_t>(t));
        for (const Members& triangles : around)
            for (const std::int32_t t : triangles)
                for (const std::int32_t other : triangles)
                    if (other != t) neighbours_[at(t)].push_back(other);
    }

    /// The free triangle whose panel has the most triangles, the first of them; `left` are free.
    std::size_t largest(std::vector<Members>& grown, std::size_t left) const {
        std::size_t best = grown.size();
        for (std::size_t t = 0; t < grown.size(); ++t) {
            if (!free_[t]) continue;
            if (grown[t].empty()) grown[t] = grow(static_cast<std::int32_t>(t));
            if (best == grown.size() || grown[t].size() > grown[best].size()) best = t;
            if (grown[best].size() == left) break;
        }
        return best;
    }

    /// Takes the neighbour that leaves the panel flattest while it is thin, and of all these panels the last that its
    /// hull fills: on the way there it may well be shaped like an L.
    Members grow(std::int32_t seed) const {
        Members members{seed};
        std::size_t filled = 1;
        while (const auto next = flattest_neighbour(members)) {
            members.push_back(*next);
            if (fills_hull(members)) filled = members.size();
        }
        members.resize(filled);
        return members;
    }

    std::optional<std::int32_t> flattest_neighbour(const Members& members) const {
        std::optional<std::int32_t> best;
        auto best_key = std::make_pair(std::numeric_limits<double>::infinity(), 0.0);
        for (const std::int32_t t : candidates(members)) {
            Members with = members;
            with.push_back(t);
            const auto thickness = thin_enough(with);
            if (!thickness) continue;
            // Rounding makes flat panels differently thin; among them the nearest one keeps the panel round.
            const auto key =
                std::make_pair(*thickness < kFlat * limits_.thickness ? 0 : *thickness, distance(members[0], t));
            if (key >= best_key) continue;
            best = t;
            best_key = key;
        }
        return best;
    }

    Members candidates(const Members& members) const {
        Members out;
        for (const std::int32_t member : members)
            for (const std::int32_t t : neighbours_[at(member)])
                if (free_[at(t)] && std::find(members.begin(), members.end(), t) == members.end()) out.push_back(t);
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    }

    /// The thickness, m, where it is small enough and all triangles face along the normal.
    std::optional<double> thin_enough(const Members& members) const {
        const Panel panel = panel_of(members);
        const bool facing = std::all_of(members.begin(), members.end(),
                                        [&](std::int32_t t) { return dot(areas_[at(t)], panel.normal) > 0; });
        const double thickness = panel.high - panel.low;
        return facing && thickness <= limits_.thickness ? std::optional(thickness) : std::nullopt;
    }

    bool fills_hull(const Members& members) const {
        const Panel panel = panel_of(members);
        const auto [u, v] = plane_axes(panel.normal);
        std::vector<Point2> points;
        for (const std::int32_t i : panel_vertices(mesh_, panel))
            points.push_back({dot(u, mesh_.vertices[at(i)]), dot(v, mesh_.vertices[at(i)])});
        double covered = 0;
        for (const std::int32_t t : members) covered += dot(areas_[at(t)], panel.normal);
        return hull_area(std::move(points)) <= (1 + limits_.overhang) * covered;
    }

    double distance(std::int32_t t, std::int32_t other) const { return length(middle(t) - middle(other)); }
    Vec3 middle(std::int32_t t) const {
        Vec3 sum;
        for (const std::int32_t v : mesh_.triangles[at(t)]) sum += mesh_.vertices[at(v)];
        return sum / 3;
    }

    static constexpr double kFlat =
        1e-6; ///< part of the permitted thickness: far above rounding, far below what matters

    const TriangleMesh& mesh_;
    PanelLimits limits_;
    std::vector<bool> free_;
    std::vector<Members> neighbours_;
    std::vector<Vec3> areas_; ///< m^2, along the normals
};

} // namespace

std::vector<Panel> merge_into_panels(const TriangleMesh& mesh, const PanelLimits& limits) {
    Merger merger(mesh, limits);
    if (limits.thickness > 0) return merger.run();
    std::vector<Panel> out;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        out.push_back(merger.panel_of({static_cast<std::int32_t>(t)}));
    return out;
}

std::vector<std::int32_t> panel_vertices(const TriangleMesh& mesh, const Panel& panel) {
    std::vector<std::int32_t> out;
    for (const std::int32_t t : panel.triangles)
        for (const std::int32_t v : mesh.triangles[at(t)]) out.push_back(v);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

} // namespace flotilla::baseline
