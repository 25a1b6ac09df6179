// SPDX-License-Identifier: MIT
#include "pair/simultaneous_hits.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/index.hpp"
#include "geometry/closest.hpp"
#include "geometry/rounding.hpp"
#include "pair/body_at.hpp"
#include "pair/impulses.hpp"

namespace flotilla {
namespace {

/// The box of the node at time t on the straight ways of its vertices, but for rounding by a few units of the largest
/// coordinate, for which CoarseReach has room. Vertices of a body that turns are within arc_gap(1) of these ways.
CoarseBox node_at(const BodyMotion& body, std::size_t node, Float4 t) {
    const CoarseBox &at0 = body.at0.nodes[node], &at1 = body.at1.nodes[node];
    const auto between = [&](const float* x0, const float* x1) { return load4(x0) + t * (load4(x1) - load4(x0)); };
    CoarseBox box;
    store(box.lower, between(at0.lower, at1.lower));
    store(box.neg_upper, between(at0.neg_upper, at1.neg_upper));
    return box;
}

/// Calls found(triangle) for the triangles of the body that may come within `reach` (m) of the box, until one returns
/// true; returns whether one did.
template <class Found>
bool any_near(const BodyAt& body, const Box& box, double reach, Found&& found) {
    const BodyMotion& motion = body.motion();
    const Bvh& bvh = body.shape().bvh;
    const CoarseBox around = merged(coarse_box(box.lower), coarse_box(box.upper));
    const CoarseReach room(reach + motion.arc_gap(1), std::max(motion.max_abs(), max_abs_coordinate(box)));
    const Float4 time = both4(static_cast<float>(body.time()));
    std::array<std::int32_t, kMaxBvhDepth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const std::int32_t i = stack[--size];
        if (!coarse_overlap(node_at(motion, at(i), time), around, room)) continue;
        const BvhNode node = bvh.nodes[at(i)];
        if (node.count > 0) {
            const auto triangles = bvh.leaf_triangles(node);
            if (std::any_of(triangles.begin(), triangles.end(), found)) return true;
        } else {
            stack[size++] = node.first;
            stack[size++] = i + 1;
        }
    }
    return false;
}

/// Whether the body is within `reach` (m) of x in front of it, along n or against it by less than 45 degrees: a wall
/// beside a corner holds nothing up.
bool touches(const BodyAt& body, const Vec3& x, const Vec3& n, double reach) {
    return any_near(body, {x, x}, reach, [&](std::int32_t triangle) {
        const Triangle& f = body.shape().mesh.triangles[at(triangle)];
        const auto nearest = closest_vertex_triangle(x, body.vertex(f[0]), body.vertex(f[1]), body.vertex(f[2]));
        const double ahead = dot(n, x - nearest.point);
        return nearest.distance_sq <= reach * reach && 2 * ahead * ahead >= nearest.distance_sq;
    });
}

/// How near to the plane something is that stands on it, m.
struct Reach {
    double above, below;
};

/// x . normal = offset; what stands on the plane is on the side of `normal`.
struct Plane {
    Vec3 normal;
    double offset;

    [[nodiscard]] bool holds(const Vec3& x, const Reach& reach) const {
        const double height = dot(normal, x) - offset;
        return height <= reach.above && height >= -reach.below;
    }
};

/// Heights above a plane by mesh coordinates, for a third of the work of the exact ones.
struct Heights {
    Vec3 slope;
    double start, error; ///< m; the error is far more than the rounding of either

    Heights(const BodyAt& body, const Plane& plane) {
        const MatrixPose map = body.map();
        slope = transpose(map.rotation) * plane.normal;
        start = dot(plane.normal, map.origin) - plane.offset;
        error = place_rounding(body.motion().max_abs() + body.shape().radius + max_component(abs(map.origin)) +
                               std::abs(plane.offset));
    }
    [[nodiscard]] double at_least(const Vec3& local) const { return (dot(slope, local) + start) - error; }
};

/// The vertices of a body that stands on the plane which are near it. None where the body does not stand on the plane
/// but reaches through it, and through what is beyond. All vertices are tested but those within a flat face, whose
/// corners say as much: an impulse has moved all of them before.
void find_feet(const BodyAt& body, const Plane& plane, const Reach& reach, std::vector<Vec3>& feet) {
    const Heights heights(body, plane);
    const std::vector<Vec3>& local = body.shape().mesh.vertices;
    const Topology& topology = body.shape().topology;
    for (std::size_t v = 0; v < local.size(); ++v) {
        if (heights.at_least(local[v]) > reach.above || topology.salient_vertex[v] == 0 || topology.vertex_owner[v] < 0)
            continue;
        const Vec3 x = body.vertex(static_cast<std::int32_t>(v));
        const double height = dot(plane.normal, x) - plane.offset;
        if (height > reach.above) continue;
        if (height < -reach.below) return feet.clear();
        feet.push_back(x);
    }
}

/// The edges of a body that lie on the plane, but for those within a flat face, the crossings of which say nothing that
/// its rim does not.
void find_rim(const BodyAt& body, const Plane& plane, const Reach& reach, std::vector<Segment>& rim) {
    const Heights heights(body, plane);
    const std::vector<Vec3>& local = body.shape().mesh.vertices;
    const Topology& topology = body.shape().topology;
    for (std::size_t e = 0; e < topology.edges.size(); ++e) {
        const auto [v, w] = topology.edges[e];
        if (topology.salient_edge[e] == 0 || heights.at_least(local[at(v)]) > reach.above ||
            heights.at_least(local[at(w)]) > reach.above)
            continue;
        const Segment edge{body.vertex(v), body.vertex(w)};
        if (plane.holds(edge.p, reach) && plane.holds(edge.q, reach)) rim.push_back(edge);
    }
}

/// Both of a body that does not move, such as a floor of any size, where the other one stands; of its vertices too only
/// those that lie within no flat face.
void find_below(const BodyAt& body, const Plane& plane, const Reach& reach, const Box& where, Footprint& print) {
    const RigidShape& shape = body.shape();
    any_near(body, where, reach.above + reach.below, [&](std::int32_t triangle) {
        const std::uint8_t owned = shape.topology.owned[at(triangle)];
        const Triangle& corners = shape.mesh.triangles[at(triangle)];
        std::array<Vec3, 3> x;
        std::array<bool, 3> on_plane;
        for (std::size_t k = 0; k < 3; ++k) {
            x[k] = body.vertex(corners[k]);
            on_plane[k] = plane.holds(x[k], reach);
            if (on_plane[k] && owns_corner(owned, static_cast<int>(k)) &&
                shape.topology.salient_vertex[at(corners[k])] != 0)
                print.feet.push_back(x[k]);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t edge = at(shape.topology.triangle_edges[at(triangle)][k]), next = (k + 1) % 3;
            if (on_plane[k] && on_plane[next] && owns_edge(owned, static_cast<int>(k)) &&
                shape.topology.salient_edge[edge] != 0)
                print.rim.push_back({x[k], x[next]});
        }
        return false;
    });
}

/// Calls found(x) for the points in which edges of the one rim cross edges of the other, or come within `reach` (m).
template <class Found>
void for_crossings(const std::vector<Segment>& rim_a, const std::vector<Segment>& rim_b, double reach, Found&& found) {
    for (const Segment& a : rim_a) {
        const Box box = a.box();
        for (const Segment& b : rim_b) {
            if (!boxes_overlap(box, b.box(), reach)) continue;
            const EdgeEdgeClosest closest = closest_edge_edge(a.p, a.q, b.p, b.q);
            if (closest.distance_sq <= reach * reach) found(0.5 * (closest.p + closest.q));
        }
    }
}

/// How level something has to be to land as a whole.
struct Level {
    double slope; ///< by which a face may rise from the plane
    double reach; ///< m; within it of a point or an edge no slope is measured
    double flat;  ///< m, by which places on one face may miss it
};

/// The face of a body's hull, or the edge, that lands on a plane as a whole, as the normal of a plane through it.
class Sole {
  public:
    /// What of a body lands with the point `from` on the plane with the normal `up`; the body's vertices near the plane
    /// are `feet`. The plane is turned up about that point until it meets the first foot, then about the edge to that
    /// foot until it meets the next. Of feet at the same slope but for `flat` the farther one tells more.
    Sole(const Vec3& from, const Vec3& up, const std::vector<Vec3>& feet, const Level& level)
        : from_(from), normal_(up) {
        double least = level.slope;
        Vec3 edge;
        for (const Vec3& x : feet) {
            const Vec3 way = x - from;
            const double height = dot(up, way), across = length(way - height * up);
            if (!(across > level.reach) || !(height + level.flat <= least * across)) continue;
            least = (height + level.flat) / across;
            edge = way;
        }
        if (edge == Vec3{}) return;
        const Vec3 along = normalized(edge), upright = normalized(up - dot(up, along) * along);
        const Vec3 aside = cross(along, upright);
        normal_ = upright;
        least = level.slope;
        for (const Vec3& x : feet) {
            const double across = dot(aside, x - from), height = dot(upright, x - from);
            if (!(std::abs(across) > level.reach) || !(height + level.flat <= least * std::abs(across))) continue;
            least = (height + level.flat) / std::abs(across);
            normal_ = normalized(upright - (height / across) * aside);
        }
    }
    [[nodiscard]] bool has(const Vec3& x, double flat) const { return std::abs(dot(normal_, x - from_)) <= flat; }

  private:
    Vec3 from_, normal_;
};

/// Leaves of what is near the plane what lands with `from`: what lies on one face, or edge. The rest meets the plane
/// later. A ball of a fine mesh has a hundred vertices within its rest distance of a floor, and a rebound of each would
/// turn it as a foot of that width does.
void keep_sole(const Vec3& from, const Vec3& up, const Level& level, Footprint& print) {
    if (print.feet.empty()) return;
    const Sole sole(from, up, print.feet, level);
    const auto off = [&](const Vec3& x) { return !sole.has(x, level.flat); };
    std::erase_if(print.feet, off);
    std::erase_if(print.rim, [&](const Segment& s) { return off(s.p) || off(s.q); });
}

Box box_of(const std::vector<Vec3>& points) {
    Box box;
    for (const Vec3& x : points) box = extended(box, x);
    return box;
}

/// What each of two bodies has on its plane, of which at least one moves.
void find_footprints(const std::array<BodyAt, 2>& bodies, const std::array<Plane, 2>& planes,
                     const std::array<bool, 2>& moves, const Reach& reach, std::array<Footprint, 2>& prints) {
    for (std::size_t k = 0; k < 2; ++k) {
        prints[k].clear();
        if (moves[k]) find_feet(bodies[k], planes[k], reach, prints[k].feet);
    }
    for (std::size_t k = 0; k < 2; ++k)
        if (!moves[k] && prints[1 - k].feet.size() > 1)
            find_below(bodies[k], planes[k], reach, box_of(prints[1 - k].feet), prints[k]);
    const auto has_rim = [&](std::size_t k) { return moves[k] ? prints[k].feet.size() > 1 : !prints[k].rim.empty(); };
    if (!has_rim(0) || !has_rim(1)) return;
    for (std::size_t k = 0; k < 2; ++k)
        if (moves[k]) find_rim(bodies[k], planes[k], reach, prints[k].rim);
}

/// The points at which two bodies meet at the time of a hit. What lands as a whole is a face, or edge, so level that it
/// would be within `reach` of the plane were it as wide as the smaller of the two.
class MeetingPoints {
  public:
    MeetingPoints(const StepView& view, std::array<Footprint, 2>& prints, const ClusterHit& hit,
                  const ContactPoint& first, double reach, std::vector<ContactPoint>& out)
        : view_(view), hit_(hit), first_(first), reach_(reach), prints_(prints), out_(out) {
        const auto center = [&](std::int32_t id) { // from which the arms of the hit are
            return hit.hit.hit && stays(id) ? view.trajectories.start_pose(at(id)).com
                                            : view.trajectories.motion(at(id)).pose(hit.hit.toi).com;
        };
        com_ = {center(hit.a), center(hit.b)};
        point_ = {com_[0] + first.arm_a, com_[1] + first.arm_b};
        within_ = length(point_[1] - point_[0]) + reach;
        planes_ = {Plane{-first.normal, -dot(first.normal, point_[0])},
                   Plane{first.normal, dot(first.normal, point_[1])}};
    }

    void of_both() {
        const BodyMotion a = view_.trajectories.motion(at(hit_.a)), b = view_.trajectories.motion(at(hit_.b));
        const BodyAt a_then(a, hit_.hit.toi), b_then(b, hit_.hit.toi);
        find_footprints({a_then, b_then}, planes_, {!stays(hit_.a), !stays(hit_.b)}, {reach_, within_}, prints_);
        keep(0, a_then, b_then);
        keep(1, b_then, a_then);
        add(a_then, b_then, first_.friction);
    }

    /// After of_both(), whose footprint of the body that moves is that on all bodies that stand.
    void on(std::int32_t ground) {
        const std::size_t mover = stays(hit_.a) ? 1 : 0;
        Footprint &own = prints_[mover], &below = prints_[1 - mover];
        below.clear();
        if (own.feet.size() < 2) return;
        const BodyMotion moving = view_.trajectories.motion(at(mover == 0 ? hit_.a : hit_.b)),
                         standing = view_.trajectories.motion(at(ground));
        const Box where = box_of(own.feet);
        if (!boxes_overlap(where, *standing.at0.box, within_)) return;
        const BodyAt then(moving, hit_.hit.toi), ground_then(standing, hit_.hit.toi);
        find_below(ground_then, planes_[1 - mover], {reach_, within_}, where, below);
        if (!below.rim.empty() && own.rim.empty()) {
            find_rim(then, planes_[mover], {reach_, within_}, own.rim);
            keep(mover, then, ground_then);
        }
        keep(1 - mover, ground_then, then);
        const double friction = pair_friction(view_.model, mover == 0 ? hit_.a : hit_.b, ground);
        mover == 0 ? add(then, ground_then, friction) : add(ground_then, then, friction);
    }

  private:
    [[nodiscard]] bool stays(std::int32_t id) const { return view_.clusters[view_.clusters.of(at(id))].infinite(); }

    void keep(std::size_t side, const BodyAt& body, const BodyAt& other) {
        constexpr double kOneFace = 1.0 / 1024;    // of the rest distance
        constexpr double kOfCoordinates = 0x1p-22; // of coordinates in single precision, as files have them, four times
        const double width = std::min(body.shape().radius, other.shape().radius);
        const double flat = std::max(kOneFace * reach_, kOfCoordinates * max_abs_coordinate(body.shape().box));
        keep_sole(point_[side], planes_[side].normal, {reach_ / width, reach_, flat}, prints_[side]);
    }

    void add(const BodyAt& a, const BodyAt& b, double friction) {
        const Impulsive body_a = view_.clusters.impulsive(view_.clusters.of(at(hit_.a)));
        const Impulsive body_b = view_.clusters.impulsive(view_.clusters.of(at(hit_.b)));
        const auto add_if = [&](const Vec3& x, auto&& meets) {
            ContactPoint p{first_.normal, x - com_[0], x - com_[1], {}, friction};
            p.relative_velocity = point_velocity(body_b, p.arm_b) - point_velocity(body_a, p.arm_a);
            if (!(dot(p.relative_velocity, p.normal) < 0) || length_sq(x - point_[1]) <= 4 * reach_ * reach_) return;
            if (!known(p) && meets()) out_.push_back(p);
        };
        for (const Vec3& x : prints_[0].feet) add_if(x, [&] { return touches(b, x, first_.normal, within_); });
        for (const Vec3& x : prints_[1].feet) add_if(x, [&] { return touches(a, x, first_.normal, within_); });
        for_crossings(prints_[0].rim, prints_[1].rim, within_, [&](const Vec3& x) { add_if(x, [] { return true; }); });
    }
    [[nodiscard]] bool known(const ContactPoint& point) const {
        return std::any_of(out_.begin(), out_.end(),
                           [&](const ContactPoint& p) { return length_sq(p.arm_b - point.arm_b) <= reach_ * reach_; });
    }

    const StepView& view_;
    const ClusterHit& hit_;
    const ContactPoint& first_;
    double reach_, within_;           ///< m, of the planes; of the other body
    std::array<Vec3, 2> com_, point_; ///< of the hit, on either body
    std::array<Plane, 2> planes_;
    std::array<Footprint, 2>& prints_;
    std::vector<ContactPoint>& out_;
};

} // namespace

void find_simultaneous_hits(const StepView& view, std::array<Footprint, 2>& prints, const ClusterHit& hit,
                            const ContactPoint& first, double reach, std::span<const std::int32_t> grounds,
                            std::vector<ContactPoint>& out) {
    MeetingPoints points(view, prints, hit, first, reach, out);
    points.of_both();
    for (const std::int32_t ground : grounds) points.on(ground);
}

} // namespace flotilla
