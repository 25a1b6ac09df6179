// SPDX-License-Identifier: MIT
#include "proximity/contact_points.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <utility>

#include "base/index.hpp"
#include "ccd/leaf_features.hpp"
#include "geometry/plane_test.hpp"
#include "geometry/ray.hpp"
#include "geometry/rounding.hpp"
#include "geometry/support.hpp"
#include "proximity/feature_points.hpp"
#include "proximity/same_place.hpp"

namespace flotilla {
namespace {

// A ray starts and ends on the bodies themselves; crossings this near to its ends are those.
constexpr double kRayMargin = 1e-6;
constexpr std::size_t kBatch = 64; // feature pairs examined together
/// Cosine of 15 degrees, the angle between facets of a circle of 24: a corner that a round body sits in, not another
/// side of a box.
constexpr double kOtherDirection = 0.96592582628906829;
/// Sine of the angle between triangles of one plane: far more than the rounding of their corners.
constexpr double kOnePlane = 0x1p-20;

std::array<Vec3, 3> corners(const BodyMotion& body, std::int32_t t) {
    const Triangle& v = body.shape->mesh.triangles[at(t)];
    return {body.at0.x[at(v[0])], body.at0.x[at(v[1])], body.at0.x[at(v[2])]};
}

/// Whether both features may say what no other contact does.
bool salient(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f) {
    const Topology &of_a = a.shape->topology, &of_b = b.shape->topology;
    switch (f.kind) {
    case FeatureKind::vertex_face: return of_a.salient_vertex[at(f.a)] != 0;
    case FeatureKind::face_vertex: return of_b.salient_vertex[at(f.b)] != 0;
    case FeatureKind::edge_edge: return of_a.salient_edge[at(f.a)] != 0 && of_b.salient_edge[at(f.b)] != 0;
    }
    return true;
}

/// One body's part of a proximity.
struct Side {
    const BodyMotion& body;
    Vec3 p, q;          ///< its point, the other body's
    std::int32_t face;  ///< that has p as its nearest point to q; -1: the feature is no face
    std::int32_t owner; ///< a triangle of the vertex or edge that has p; -1: the feature is a face
};

std::int32_t owner_of(const BodyMotion& body, FeatureKind kind, std::int32_t feature) {
    const Topology& t = body.shape->topology;
    return kind == FeatureKind::edge_edge ? t.edge_owner[at(feature)] : t.vertex_owner[at(feature)];
}

Side side_of(const BodyMotion& body, const ProximityPoint& point, bool first) {
    const FeaturePair& f = point.features;
    const bool is_face = f.kind == (first ? FeatureKind::face_vertex : FeatureKind::vertex_face);
    const std::int32_t own = first ? f.a : f.b;
    return {body, first ? point.a : point.b, first ? point.b : point.a, is_face ? own : -1,
            is_face ? -1 : owner_of(body, f.kind, own)};
}

/// How far from p a triangle may be that says whether p faces q, squared (m^2): |pq| tan(theta).
double facing_reach_sq(const Side& s, double angle_cos) {
    return length_sq(s.p - s.q) * (1 - angle_cos * angle_cos) / (angle_cos * angle_cos);
}

/// Fills `out` with all triangles that may be within that reach of p or meet the segment pq.
void list_around(const Side& s, double angle_cos, std::vector<std::int32_t>& out) {
    out.clear();
    const Bvh& bvh = s.body.shape->bvh;
    const CoarseBox segment = merged(coarse_box(s.p), coarse_box(s.q));
    const CoarseReach reach(std::sqrt(facing_reach_sq(s, angle_cos)), s.body.max_abs());
    std::array<std::int32_t, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t i = stack[--size];
        if (!coarse_overlap(s.body.at0.nodes[at(i)], segment, reach)) continue;
        const BvhNode node = bvh.nodes[at(i)];
        if (node.count > 0) {
            for (const std::int32_t t : bvh.leaf_triangles(node)) out.push_back(t);
        } else {
            stack[size++] = node.first;
            stack[size++] = i + 1;
        }
    }
}

bool crosses(const Side& s, std::span<const std::int32_t> around) {
    return std::any_of(around.begin(), around.end(), [&](std::int32_t t) {
        const auto f = corners(s.body, t);
        return segment_pierces(s.p, s.q, f[0], f[1], f[2], kRayMargin);
    });
}

/// A triangle whose corners x are all as far along qp as |pq| cos(theta), (p - q).(x - q) being at least this, has no
/// point nearer than p that is more than theta away. Most are, and need no closest points. The room is far more than
/// rounding, that of closest points on needles included.
double least_along(const Side& s, double angle_cos) {
    const double distance_sq = length_sq(s.p - s.q);
    return (angle_cos + 0x1p-20) * distance_sq + 0x1p-40 * std::sqrt(distance_sq) * (s.body.max_abs() + length(s.q));
}

/// Whether p is, as far as the given triangles know, the nearest point to q of the body around it: none that reaches
/// within |pq| tan(theta) of p comes nearer to q than p in a direction more than theta away.
bool faces(const Side& s, std::span<const std::int32_t> triangles, double angle_cos) {
    const Vec3 to_p = s.p - s.q;
    const double distance_sq = length_sq(to_p);
    const double reach_sq = facing_reach_sq(s, angle_cos);
    const double least = least_along(s, angle_cos);
    return std::none_of(triangles.begin(), triangles.end(), [&](std::int32_t t) {
        if (t == s.face) return false;
        const auto f = corners(s.body, t);
        const auto along = [&](std::size_t k) { return dot(to_p, f[k] - s.q); };
        if (std::min({along(0), along(1), along(2)}) >= least) return false;
        const auto c = closest_vertex_triangle(s.q, f[0], f[1], f[2]);
        if (!(c.distance_sq < distance_sq)) return false;
        if (dot(to_p, c.point - s.q) >= angle_cos * std::sqrt(distance_sq * c.distance_sq)) return false;
        return !(closest_vertex_triangle(s.p, f[0], f[1], f[2]).distance_sq > reach_sq);
    });
}

/// Whether all of a convex body of few vertices is beyond the plane through p across qp, but for half of what a ray may
/// miss at its ends: so it is where p is the nearest point to q. Then both rules hold without a look at a triangle:
/// faces() compares heights of corners with the same bound, and where crosses() could find a crossing, farther from p
/// than the whole margin, the segment is lower than all corners of all triangles.
bool is_beyond_plane(const Side& s, double angle_cos) {
    if (!worth_slicing(*s.body.shape)) return false;
    const Vec3 to_p = s.p - s.q;
    const double distance_sq = length_sq(to_p);
    const double least = std::max(least_along(s, angle_cos), (1 - kRayMargin / 2) * distance_sq);
    return std::none_of(s.body.at0.x.begin(), s.body.at0.x.end(),
                        [&](const Vec3& x) { return !(dot(to_p, x - s.q) >= least); });
}

/// Whether points of the two boxes may come within the rest distance on their ways, by one axis at a time.
bool may_pass(const PassingBodies& passing, const CoarseBox& box_a, const CoarseBox& box_b) {
    const Box a = to_box(box_a), b = to_box(box_b);
    const Vec3 half_a = 0.5 * (a.upper - a.lower), half_b = 0.5 * (b.upper - b.lower);
    const Vec3 way = passing.b.at(b.lower + half_b) - passing.a.at(a.lower + half_a);
    const double room =
        passing.rest + length(passing.a.turn) * length(half_a) + length(passing.b.turn) * length(half_b);
    const auto meet = [&](double low_a, double high_a, double low_b, double high_b, double x) {
        return low_b + std::min(x, 0.0) - room <= high_a && low_a <= high_b + std::max(x, 0.0) + room;
    };
    return meet(a.lower.x, a.upper.x, b.lower.x, b.upper.x, way.x) &&
           meet(a.lower.y, a.upper.y, b.lower.y, b.upper.y, way.y) &&
           meet(a.lower.z, a.upper.z, b.lower.z, b.upper.z, way.z);
}

/// Of whatever is near.
struct AnyPair {
    [[nodiscard]] static bool may_meet(const CoarseBox&, const CoarseBox&) { return true; }
    [[nodiscard]] static bool meets(const Vec3&, const Vec3&, const Vec3&, double) { return true; }
};

/// m, how far a box reaches along d.
double top_of(const CoarseBox& coarse, const Vec3& d) {
    const Box box = to_box(coarse);
    const Vec3 half = 0.5 * (box.upper - box.lower);
    return dot(d, box.lower + half) + dot(abs(d), half);
}

/// m, how far a body reaches along d at t = 0, or a little more.
double top_of(const BodyMotion& body, const Vec3& d) {
    const SupportPoints& points = body.shape->outline;
    return dot(d, body.at0.pose->origin) + reach(points, transpose(*body.at0.rotation) * d).reach + points.error;
}

/// Between the levels that two bodies reach to along a direction, and so much beyond: what is near the other one.
/// Boxes lie along the axes and tell nothing of a wheel on a tilted plane.
class Band {
  public:
    Band(const BodyMotion& a, const BodyMotion& b, const Vec3& across, double distance) {
        const auto serves = [](const SupportPoints& points) {
            return !points.fours.empty() && points.fours.size() <= kMostFours;
        };
        if (across == Vec3{} || !serves(a.shape->outline) || !serves(b.shape->outline)) return;
        across_ = across;
        const double room = distance * (1 + kLengthRounding) + place_rounding(std::max(a.max_abs(), b.max_abs()));
        top_ = top_of(a, across) + room, low_ = -top_of(b, -across) - room;
    }
    [[nodiscard]] bool holds(const CoarseBox& of_a, const CoarseBox& of_b) const {
        return across_ == Vec3{} || (top_of(of_a, across_) >= low_ && -top_of(of_b, -across_) <= top_);
    }

  private:
    static constexpr std::size_t kMostFours = 1024; ///< of a terrain going through all costs more than it saves
    Vec3 across_;
    double top_ = 0, low_ = 0; ///< m
};

/// Of what comes nearer than the rest distance.
struct PassingPair {
    const PassingBodies& passing;
    Band band;
    [[nodiscard]] bool may_meet(const CoarseBox& a, const CoarseBox& b) const {
        return band.holds(a, b) && may_pass(passing, a, b);
    }
    [[nodiscard]] bool meets(const Vec3& p, const Vec3& q, const Vec3& normal, double distance) const {
        return distance + dot(normal, passing.b.at(q) - passing.a.at(p)) < passing.rest;
    }
};

/// A body at its start.
struct AtStart {
    const RigidShape& shape;
    const BodyMotion& body;
    [[nodiscard]] Vec3 vertex(std::int32_t v) const { return body.at0.x[at(v)]; }
};
ClosestPoints closest(const BodyMotion& a, const BodyMotion& b, const FeaturePair& f) {
    return closest_points(f, AtStart{*a.shape, a}, AtStart{*b.shape, b});
}

/// Of one body's feature at its start.
CoarseBox box_of(const BodyMotion& body, const FeaturePair& f, bool first) {
    const std::int32_t own = first ? f.a : f.b;
    if (f.kind == FeatureKind::edge_edge) return coarse_edge(body, body.shape->topology.edges[at(own)]).at0;
    if ((f.kind == FeatureKind::vertex_face) == first) return coarse_vertex(body, own).at0;
    return coarse_triangle(body, body.shape->mesh.triangles[at(own)]).at0;
}

template <class Pair = AnyPair>
class Finder {
  public:
    Finder(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos, ProximityScratch& scratch,
           const Pair& pair = {})
        : a_(a),
          b_(b),
          proximity_(proximity),
          angle_cos_(angle_cos),
          largest_(std::max(a.max_abs(), b.max_abs())),
          reach_(proximity, largest_),
          scratch_(scratch),
          pair_(pair) {}

    ProximityResult all(const QueryAid& aid) {
        scratch_.found.clear();
        collect(aid);
        sort_and_keep_distinct_faces();
        return result_;
    }

    bool any(const QueryAid& aid) {
        first_only_ = true;
        scratch_.found.clear();
        collect(aid);
        return result_.near;
    }

  private:
    bool sliced(const QueryAid& aid) {
        return aid.direction != Vec3{} &&
               slice_features(FeatureTest::near, a_, b_, aid.direction, proximity_, scratch_.slices);
    }

    void collect(const QueryAid& aid) {
        const CoveringList& list = aid.list;
        if (sliced(aid))
            examine_all(scratch_.slices.found());
        else if (list.list != nullptr)
            examine_all(list.list->select(FeatureTest::near, a_, b_, list.strayed, reach_, scratch_.candidates));
        else
            traverse();
    }

    void examine_all(std::span<const FeaturePair> left) {
        while (!left.empty() && !done()) {
            const auto other = [&](const FeaturePair& f) { return f.kind != left[0].kind; };
            const auto few = left.first(std::min(kBatch, left.size()));
            const auto n = static_cast<std::size_t>(std::find_if(few.begin(), few.end(), other) - few.begin());
            examine(left.first(n));
            left = left.subspan(n);
        }
    }

    void traverse() {
        constexpr std::size_t kLeaves = 256; // pairs whose features are looked at together
        std::vector<NodeIds>& leaves = scratch_.candidates.open;
        leaves.clear();
        const auto examine_leaves = [&] {
            if (!leaves.empty()) examine_all(features_of_leaves(a_, b_, reach_, scratch_.candidates));
            leaves.clear();
        };
        bvh_detail::traverse(
            a_.shape->bvh, b_.shape->bvh, a_.at0.nodes, b_.at0.nodes,
            [&](std::int32_t i, std::int32_t j, double&) {
                return coarse_overlap(a_.at0.nodes[at(i)], b_.at0.nodes[at(j)], reach_) &&
                       pair_.may_meet(a_.at0.nodes[at(i)], b_.at0.nodes[at(j)]);
            },
            [&](double) { return !done(); },
            [&](std::int32_t i, std::int32_t j, double) {
                leaves.push_back({i, j});
                if (leaves.size() == kLeaves) examine_leaves();
            });
        examine_leaves();
    }

    [[nodiscard]] bool done() const { return first_only_ && result_.near; }

    /// Examines feature pairs of one kind, at most kBatch.
    void examine(std::span<const FeaturePair> features) {
        std::array<CcdCorners, kBatch> corners;
        std::array<std::int32_t, kBatch + 1> near;
        const FeatureKind kind = features[0].kind;
        for (std::size_t i = 0; i < features.size(); ++i) corners[i] = ccd_corners(a_, b_, features[i]);
        const long n =
            near_by_planes(ccd_kind(kind), ccd_points(a_, b_, kind), std::span(corners).first(features.size()),
                           proximity_, near.data(), features.size() > 1 ? isa_ : Isa::scalar);
        for (const std::int32_t i : std::span(near).first(static_cast<std::size_t>(n))) add(features[at(i)]);
    }

    void add(const FeaturePair& f) {
        if (done()) return;
        const ClosestPoints p = closest(a_, b_, f);
        if (!(p.distance_sq < proximity_ * proximity_)) return;
        ++scratch_.counters.proximities;
        const double distance = std::sqrt(p.distance_sq);
        if (!result_.near || distance < result_.distance) result_ = {true, distance};
        if (!p.interior || !salient(a_, b_, f)) {
            ++scratch_.counters.end_points;
            return;
        }
        const Vec3 normal = direction_between(p.b - p.a, largest_, p.e, p.f);
        if (normal == Vec3{} || !pair_.meets(p.a, p.b, normal, distance)) return;
        if (!pair_.may_meet(box_of(a_, f, true), box_of(b_, f, false))) return;
        scratch_.found.push_back({f, p.a, p.b, normal, distance});
    }

    /// Of the faces near one vertex in one direction, to within theta, the nearest stays (the lowest number, at equal
    /// distance).
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

    const BodyMotion &a_, &b_;
    double proximity_, angle_cos_, largest_;
    CoarseReach reach_;
    ProximityScratch& scratch_;
    Pair pair_;
    Isa isa_ = best_isa();
    ProximityResult result_;
    bool first_only_ = false;
};

/// The normal of triangle t, not of unit length.
Vec3 area_normal(const BodyMotion& body, std::int32_t t) {
    const auto f = corners(body, t);
    return cross(f[1] - f[0], f[2] - f[0]);
}

/// The flat side of a body that the foot of a contact's vertex is on.
struct FlatSide {
    enum class At : std::uint8_t { none, inside, rim, beyond };
    At at = At::none;
    Vec3 normal; ///< unit, in the sense of the contact's; of a rim, or beyond it
};

/// On the rim: the triangles around the foot that face the vertex to within kOtherDirection are all in one plane, and
/// that does so to within theta; beyond it, where it does not. A vertex a hair outside such a side has a normal that is
/// tilted by that hair over the distance: one cube flush on another of its size is turned by it, ever faster, up to 0.5
/// rad/s.
FlatSide side_below(const BodyMotion& body, const Vec3& vertex, std::int32_t face, const Vec3& normal,
                    double angle_cos) {
    using At = FlatSide::At;
    const auto f = corners(body, face);
    const auto foot = closest_vertex_triangle(vertex, f[0], f[1], f[2]).barycentric;
    if (foot[0] > 0 && foot[1] > 0 && foot[2] > 0) return {At::inside, normal};
    const Topology& topology = body.shape->topology;
    const auto place = [&](std::int32_t t, std::size_t k) {
        return topology.place[at(body.shape->mesh.triangles[at(t)][k])];
    };
    const auto has_foot = [&](std::int32_t t) { // one of the triangles around a corner beside the foot
        const auto has = [&](std::size_t k) {
            return foot[k] == 0 || place(t, 0) == place(face, k) || place(t, 1) == place(face, k) ||
                   place(t, 2) == place(face, k);
        };
        return has(0) && has(1) && has(2);
    };
    const std::size_t corner = foot[0] > 0 ? 0 : foot[1] > 0 ? 1 : 2;
    FlatSide side;
    for (const std::int32_t t : topology.around_vertex(body.shape->mesh.triangles[at(face)][corner])) {
        if (!has_foot(t)) continue;
        const Vec3 n = area_normal(body, t);
        const double along = dot(normal, n), size = length(n);
        if (!(std::abs(along) >= kOtherDirection * size) || size == 0) continue;
        const Vec3 unit = (along < 0 ? -1 : 1) / size * n;
        if (side.at == At::none)
            side = {std::abs(along) >= angle_cos * size ? At::rim : At::beyond, unit};
        else if (!(length_sq(cross(side.normal, unit)) <= kOnePlane * kOnePlane))
            return {};
    }
    return side;
}

/// The point with the direction in which its bodies touch, and the distance along it: a corner that is a hair outside
/// would else be farther than the others, by hair^2 / 2 gap, and its body be tilted until it is not. Cubes without
/// friction that stand 1e-6 m aside of each other were driven away at 7e-8 m/s^2.
ProximityPoint contact_point(const FlatSide& side, const ProximityPoint& p) {
    ProximityPoint point = p;
    point.flat = side.at == FlatSide::At::inside || side.at == FlatSide::At::rim;
    if (side.at != FlatSide::At::rim) return point;
    point.normal = side.normal;
    point.distance = dot(side.normal, p.b - p.a);
    return point;
}
FlatSide flat_side(const BodyMotion& a, const BodyMotion& b, const ProximityPoint& p, double angle_cos) {
    switch (p.features.kind) {
    case FeatureKind::vertex_face: return side_below(b, p.a, p.features.b, p.normal, angle_cos);
    case FeatureKind::face_vertex: return side_below(a, p.b, p.features.a, p.normal, angle_cos);
    case FeatureKind::edge_edge: break;
    }
    return {};
}
ProximityPoint contact_point(const BodyMotion& a, const BodyMotion& b, const ProximityPoint& p, double angle_cos) {
    return contact_point(flat_side(a, b, p, angle_cos), p);
}

/// Whether the foot of a contact's vertex is at the border of its triangle, and not at that of the flat face that the
/// triangle is part of.
bool crosses_flat_face(const BodyMotion& body, const Vec3& vertex, std::int32_t face) {
    const auto f = corners(body, face);
    const auto foot = closest_vertex_triangle(vertex, f[0], f[1], f[2]).barycentric;
    const Topology& topology = body.shape->topology;
    for (std::size_t k = 0; k < 3; ++k) {
        const bool edge = foot[k] == 0 && foot[(k + 1) % 3] > 0 && foot[(k + 2) % 3] > 0; // across from corner k
        if (edge) return topology.salient_edge[at(topology.triangle_edges[at(face)][(k + 1) % 3])] == 0;
        if (foot[k] == 1) return topology.salient_vertex[at(body.shape->mesh.triangles[at(face)][k])] == 0;
    }
    return false;
}
bool crosses_flat_face(const BodyMotion& a, const BodyMotion& b, const ProximityPoint& p) {
    switch (p.features.kind) {
    case FeatureKind::vertex_face: return crosses_flat_face(b, p.a, p.features.b);
    case FeatureKind::face_vertex: return crosses_flat_face(a, p.b, p.features.a);
    case FeatureKind::edge_edge: break;
    }
    return false;
}

/// Bodies that touch at one point alone slide or roll from it, within a step, onto features that do not face each other
/// yet. A link that hangs in a corner between facets of another sees one side of it, slides past the corner, and so on
/// in every step: ten links at 1/100 s keep 0.5 J for ever, and 1e-5 J with this. The nearest points in other
/// directions up to kOtherDirection from that one are contacts as well. A flat face has one direction, however it is
/// cut into triangles. `out` ends with the one point.
void add_other_directions(const BodyMotion& a, const BodyMotion& b, double angle_cos, ProximityScratch& scratch,
                          std::vector<ProximityPoint>& out) {
    const ProximityPoint only = out.back();
    const std::size_t first = out.size() - 1;
    auto& others = scratch.others;
    others.clear();
    std::copy_if(scratch.found.begin(), scratch.found.end(), std::back_inserter(others), [&](const ProximityPoint& p) {
        const double cos = dot(only.normal, p.normal);
        return cos < angle_cos && cos >= kOtherDirection;
    });
    const auto key = [](const ProximityPoint& p) { return std::pair(p.distance, feature_key(p.features)); };
    std::ranges::sort(others, {}, key);
    for (const ProximityPoint& p : others) {
        const auto repeats = [&](const ProximityPoint& kept) { return dot(kept.normal, p.normal) >= angle_cos; };
        if (std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), repeats)) continue;
        if (!crosses_flat_face(a, b, p) && admissible(a, b, p, kOtherDirection, scratch)) out.push_back(p);
    }
    std::ranges::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), {},
                      [](const ProximityPoint& p) { return feature_key(p.features); });
}

} // namespace

ProximityResult find_proximities(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                 const QueryAid& aid, ProximityScratch& scratch) {
    return Finder<>(a, b, proximity, angle_cos, scratch).all(aid);
}

bool any_proximity(const BodyMotion& a, const BodyMotion& b, double proximity, const QueryAid& aid,
                   ProximityScratch& scratch) {
    return Finder<>(a, b, proximity, 1, scratch).any(aid);
}

bool admissible(const BodyMotion& a, const BodyMotion& b, const ProximityPoint& point, double angle_cos,
                ProximityScratch& scratch) {
    const Side sides[2] = {side_of(a, point, true), side_of(b, point, false)};
    const bool beyond[2] = {is_beyond_plane(sides[0], angle_cos), is_beyond_plane(sides[1], angle_cos)};
    if (beyond[0] && beyond[1]) return true;
    auto& around = scratch.around;
    // Of what is around a vertex or an edge, a triangle of its own is at hand, and often enough.
    const auto owner_faces = [&](int k) {
        const Side& s = sides[k];
        return beyond[k] || s.owner < 0 || faces(s, {&s.owner, 1}, angle_cos);
    };
    const auto faces_other = [&](int k) {
        if (beyond[k]) return true;
        list_around(sides[k], angle_cos, around[at(k)]);
        return faces(sides[k], around[at(k)], angle_cos);
    };
    if (!owner_faces(0) || !owner_faces(1) || !faces_other(0) || !faces_other(1)) {
        ++scratch.counters.angle;
        return false;
    }
    if ((!beyond[0] && crosses(sides[0], around[0])) || (!beyond[1] && crosses(sides[1], around[1]))) {
        ++scratch.counters.occluded;
        return false;
    }
    return true;
}

ProximityResult find_contact_points(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                                    const QueryAid& aid, ProximityScratch& scratch, std::vector<ProximityPoint>& out) {
    const ProximityResult result = find_proximities(a, b, proximity, angle_cos, aid, scratch);
    const std::size_t first = out.size();
    for (const ProximityPoint& p : scratch.found)
        if (admissible(a, b, p, angle_cos, scratch)) out.push_back(contact_point(a, b, p, angle_cos));
    scratch.counters.end_points +=
        static_cast<std::int64_t>(drop_same_places(a, b, proximity, angle_cos, first, scratch, out));
    if (out.size() == first + 1 && scratch.found.size() > 1) add_other_directions(a, b, angle_cos, scratch, out);
    return result;
}

bool renew_contact_points(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                          std::span<const FeaturePair> features, double& distance, std::vector<ProximityPoint>& out) {
    const std::size_t first = out.size();
    const double largest = std::max(a.max_abs(), b.max_abs());
    distance = std::numeric_limits<double>::infinity();
    for (const FeaturePair& f : features) {
        const ClosestPoints p = closest(a, b, f);
        const bool near = p.distance_sq < proximity * proximity && p.interior;
        const ProximityPoint point{f, p.a, p.b, near ? direction_between(p.b - p.a, largest, p.e, p.f) : Vec3{},
                                   std::sqrt(p.distance_sq)};
        const FlatSide side = point.normal == Vec3{} ? FlatSide{} : flat_side(a, b, point, angle_cos);
        if (point.normal == Vec3{} || side.at == FlatSide::At::beyond) {
            out.resize(first);
            return false;
        }
        out.push_back(contact_point(side, point));
        distance = std::min(distance, point.distance);
    }
    std::ranges::sort(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(), {},
                      [](const ProximityPoint& p) { return feature_key(p.features); });
    return true;
}

void find_passing_points(const BodyMotion& a, const BodyMotion& b, const PassingBodies& passing, double proximity,
                         double angle_cos, ProximityScratch& scratch, std::vector<ProximityPoint>& out) {
    Finder<PassingPair>(a, b, proximity, angle_cos, scratch, {passing, Band(a, b, passing.across, proximity)}).all({});
    for (const ProximityPoint& p : scratch.found)
        if (admissible(a, b, p, angle_cos, scratch)) out.push_back(contact_point(a, b, p, angle_cos));
}

} // namespace flotilla
