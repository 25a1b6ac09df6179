// SPDX-License-Identifier: MIT
#include "proximity/contact_points.hpp"

#include <algorithm>
#include <limits>

#include "geometry/closest.hpp"
#include "geometry/ray.hpp"

namespace flotilla {
namespace {

// A ray starts and ends on the bodies themselves; crossings this near to its ends are those.
constexpr double kRayMargin = 1e-6;

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

double box_distance_sq(const Box& box, const Vec3& p) { return length_sq(p - min(max(p, box.lower), box.upper)); }

std::array<Vec3, 3> corners(const BodyMotion& body, std::int32_t t) {
    const Triangle& v = body.shape->mesh.triangles[at(t)];
    return {body.x0[at(v[0])], body.x0[at(v[1])], body.x0[at(v[2])]};
}

/// Calls leaf(triangle) for all triangles below nodes that `enter(box)` accepts.
template <class Enter, class Leaf>
void walk(const BodyMotion& body, Enter&& enter, Leaf&& leaf) {
    const Bvh& bvh = body.shape->bvh;
    std::array<std::int32_t, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t i = stack[--size];
        if (!enter(body.boxes0[at(i)])) continue;
        const BvhNode node = bvh.nodes[at(i)];
        if (node.count > 0) {
            for (std::int32_t t : bvh.leaf_triangles(node)) leaf(t);
        } else {
            stack[size++] = node.first;
            stack[size++] = i + 1;
        }
    }
}

bool crosses(const BodyMotion& body, const Vec3& p, const Vec3& q) {
    const Box ray{min(p, q), max(p, q)};
    bool found = false;
    walk(
        body, [&](const Box& box) { return !found && boxes_overlap(box, ray, 0); },
        [&](std::int32_t t) {
            const auto f = corners(body, t);
            const auto s = segment_triangle(p, q, f[0], f[1], f[2]);
            found = found || (s && *s > kRayMargin && *s < 1 - kRayMargin);
        });
    return found;
}

/// Whether p, on `body`, is the nearest point to q of the body around it: no triangle that reaches within |pq| tan(theta) of p
/// comes nearer to q than p in a direction more than theta away.
bool faces(const BodyMotion& body, const Vec3& p, const Vec3& q, double angle_cos) {
    const Vec3 to_p = p - q;
    const double distance_sq = length_sq(to_p);
    const double reach_sq = distance_sq * (1 - angle_cos * angle_cos) / (angle_cos * angle_cos);
    bool nearest = true;
    walk(
        body, [&](const Box& box) { return nearest && box_distance_sq(box, p) <= reach_sq; },
        [&](std::int32_t t) {
            const auto f = corners(body, t);
            if (closest_vertex_triangle(p, f[0], f[1], f[2]).distance_sq > reach_sq) return;
            const auto c = closest_vertex_triangle(q, f[0], f[1], f[2]);
            if (!(c.distance_sq < distance_sq)) return;
            const Vec3 to_c = c.point - q;
            nearest = nearest && dot(to_p, to_c) >= angle_cos * std::sqrt(distance_sq * c.distance_sq);
        });
    return nearest;
}

class Finder {
  public:
    Finder(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos, ProximityScratch& scratch)
        : a_(a), b_(b), proximity_(proximity), angle_cos_(angle_cos), scratch_(scratch) {}

    ProximityResult run(std::vector<ProximityPoint>& out) {
        scratch_.found.clear();
        for_each_overlapping_leaf_pair(a_.shape->bvh, a_.boxes0, b_.shape->bvh, b_.boxes0, proximity_,
                                       [&](std::span<const std::int32_t> ta, std::span<const std::int32_t> tb) {
                                           for (std::int32_t i : ta)
                                               for (std::int32_t j : tb) add_triangles(i, j);
                                       });
        sort_and_keep_distinct_faces();
        for (const ProximityPoint& p : scratch_.found)
            if (keep(p)) out.push_back(p);
        return result_;
    }

  private:
    void add_triangles(std::int32_t i, std::int32_t j) {
        const Topology &ta = a_.shape->topology, &tb = b_.shape->topology;
        const Triangle &ca = a_.shape->mesh.triangles[at(i)], &cb = b_.shape->mesh.triangles[at(j)];
        const Box box_a = triangle_box(a_.x0, ca), box_b = triangle_box(b_.x0, cb);
        if (!boxes_overlap(box_a, box_b, proximity_)) return;
        for (int k = 0; k < 3; ++k) {
            const auto c = static_cast<std::size_t>(k);
            if (owns_corner(ta.owned[at(i)], k) && boxes_overlap(vertex_box(a_.x0, ca[c]), box_b, proximity_))
                add({FeatureKind::vertex_face, ca[c], j});
            if (owns_corner(tb.owned[at(j)], k) && boxes_overlap(box_a, vertex_box(b_.x0, cb[c]), proximity_))
                add({FeatureKind::face_vertex, i, cb[c]});
        }
        for (int k = 0; k < 3; ++k) {
            if (!owns_edge(ta.owned[at(i)], k)) continue;
            const std::int32_t ea = ta.triangle_edges[at(i)][static_cast<std::size_t>(k)];
            const Box edge_a = edge_box(a_.x0, ta.edges[at(ea)]);
            if (!boxes_overlap(edge_a, box_b, proximity_)) continue;
            for (int l = 0; l < 3; ++l) {
                if (!owns_edge(tb.owned[at(j)], l)) continue;
                const std::int32_t eb = tb.triangle_edges[at(j)][static_cast<std::size_t>(l)];
                if (boxes_overlap(edge_a, edge_box(b_.x0, tb.edges[at(eb)]), proximity_))
                    add({FeatureKind::edge_edge, ea, eb});
            }
        }
    }

    void add(const FeaturePair& f) {
        const FeaturePoints p = closest_points(a_, b_, f, 0);
        if (!(p.distance_sq < proximity_ * proximity_)) return;
        ++scratch_.counters.proximities;
        const double distance = std::sqrt(p.distance_sq);
        if (!result_.near || distance < result_.distance) result_ = {true, distance};
        if (f.kind == FeatureKind::edge_edge && !p.interior) {
            ++scratch_.counters.end_points;
            return;
        }
        const Vec3 normal = normalized(p.b - p.a);
        if (normal != Vec3{}) scratch_.found.push_back({f, p.a, p.b, normal, distance});
    }

    /// Of the faces near one vertex in one direction, to within theta, the nearest stays (the lowest number, at equal distance).
    void sort_and_keep_distinct_faces() {
        const auto vertex = [](const ProximityPoint& p) {
            return p.features.kind == FeatureKind::vertex_face ? p.features.a : p.features.b;
        };
        auto& found = scratch_.found;
        std::sort(found.begin(), found.end(), [&](const ProximityPoint& p, const ProximityPoint& q) {
            if (p.features.kind != q.features.kind) return p.features.kind < q.features.kind;
            if (p.features.kind != FeatureKind::edge_edge) {
                if (vertex(p) != vertex(q)) return vertex(p) < vertex(q);
                if (p.distance != q.distance) return p.distance < q.distance;
            }
            return feature_key(p.features) < feature_key(q.features);
        });
        auto end = found.begin();   // of those kept
        auto first = found.begin(); // kept, of the same vertex
        for (const ProximityPoint& p : found) {
            if (first != end && (first->features.kind != p.features.kind || vertex(*first) != vertex(p))) first = end;
            const auto repeats = [&](const ProximityPoint& kept) { return dot(kept.normal, p.normal) >= angle_cos_; };
            if (p.features.kind == FeatureKind::edge_edge || std::none_of(first, end, repeats)) *end++ = p;
        }
        scratch_.counters.same_direction += found.end() - end;
        found.erase(end, found.end());
        std::sort(found.begin(), found.end(), [](const ProximityPoint& p, const ProximityPoint& q) {
            return feature_key(p.features) < feature_key(q.features);
        });
    }

    bool keep(const ProximityPoint& p) {
        const bool admissible = faces(a_, p.a, p.b, angle_cos_) && faces(b_, p.b, p.a, angle_cos_);
        if (!admissible) {
            ++scratch_.counters.angle;
            return false;
        }
        if (crosses(a_, p.a, p.b) || crosses(b_, p.a, p.b)) {
            ++scratch_.counters.occluded;
            return false;
        }
        return true;
    }

    const BodyMotion &a_, &b_;
    double proximity_, angle_cos_;
    ProximityScratch& scratch_;
    ProximityResult result_;
};

} // namespace

ProximityResult find_contact_points(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                    ProximityScratch& scratch, std::vector<ProximityPoint>& out) {
    return Finder(a, b, proximity, angle_cos, scratch).run(out);
}

} // namespace flotilla
