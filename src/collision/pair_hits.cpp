// SPDX-License-Identifier: MIT
#include "collision/pair_hits.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "base/stopwatch.hpp"
#include "geometry/rounding.hpp"
#include "pair/cluster_query.hpp"
#include "pair/face_of_hit.hpp"
#include "pair/impulses.hpp"
#include "pair/neighbour_lists.hpp"
#include "pair/pair_distance.hpp"
#include "pair/simultaneous_hits.hpp"
#include "proximity/passing.hpp"
#include "response/arc.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

Vec3 rigid_velocity(const StepView& view, const PairRecord& pair, const ContactPoint& point) {
    return point_velocity(view.clusters.impulsive(pair.b), point.arm_b) -
           point_velocity(view.clusters.impulsive(pair.a), point.arm_a);
}

/// The contact of a swept hit, along the normal of the face that meets the other body where the points approach along
/// that as well.
SweptContact contact_of_hit(const StepView& view, const ClusterHit& hit) {
    const SweptContact contact = swept_contact(view, hit);
    const auto face = face_of_hit(view, hit);
    if (!face || !(dot(*face, contact.point.relative_velocity) < 0)) return contact;
    ClusterHit of_face = hit;
    of_face.hit.normal = *face;
    return swept_contact(view, of_face);
}

/// The contact of a swept hit with rigid velocities where these approach as well. Effective ones, of straight paths,
/// are what makes sure that it does (section 3.2), but a rebound at their speed takes energy where they are slower than
/// the bodies, and gives none where they are faster, for that is cut: 27 cubes in a box lose 6 % in 4 s at 1/240 s.
ContactPoint rebounding(const StepView& view, const PairRecord& pair, ContactPoint point) {
    const Vec3 rigid = rigid_velocity(view, pair, point);
    if (dot(rigid, point.normal) < 0) point.relative_velocity = rigid;
    return point;
}

/// `way`: m/s, of the points on their way in this step, b minus a; `start_gap`: m, along the normal at x^n; `time`:
/// share of the step.
Landing landing_of(const StepView& view, const PairRecord& pair, const ContactPoint& point, const Vec3& way,
                   double start_gap, double time) {
    const Vec3& n = point.normal;
    const bool late = view.clusters[pair.a].any_late() || view.clusters[pair.b].any_late();
    return {.normal = n,
            .approach = -dot(n, point.relative_velocity),
            .parts = late && dot(n, rigid_velocity(view, pair, point)) >= 0,
            .way = -dot(n, way),
            .gap = start_gap - pair.lengths.rest,
            .lengths = pair.lengths,
            .time = time};
}

/// Whether some points of two bodies may approach each other faster than `speed` (m/s), by their motions and radii
/// alone.
bool may_approach(const Impulsive& a, const Impulsive& b, double radius_a, double radius_b, double speed) {
    return length(b.velocity - a.velocity) + length(a.angular_velocity) * radius_a +
               length(b.angular_velocity) * radius_b >
           speed * (1 - kLengthRounding);
}

/// m/s, of the pair's bodies (StepView::approach).
double approach_of(const StepView& view, std::int32_t a, std::int32_t b) {
    const bool driven = view.model.bodies[at(a)].driven() || view.model.bodies[at(b)].driven();
    if (!driven || view.model.settings.approach_threshold >= 0) return view.approach;
    return std::max(view.approach, 0.5 * most_acceleration(view.model, a, b) * view.dt);
}

/// Whether static contact stops points of a pair that approach at `speed`, m/s, from `gap` m above their rest distance:
/// those whose rebound is slower than `least_approach`, if they come no farther beyond it in a step than contacts are
/// found, so that stages 3 and 7 know them. They stop all of them together. An impulse here would be one more beside
/// theirs, often ahead of the time at which the points meet: what rolls loses its energy so, and in a pile that falls
/// two of three impulses are such.
bool stops_calmly(const StepView& view, const PairRecord& pair, double speed, double gap) {
    return view.model.settings.approach_threshold < 0 && speed * view.dt - gap <= pair.lengths.proximity &&
           pair_restitution(view.model, pair.a, pair.b) * speed <=
               least_approach(view, pair.a, pair.b, pair.lengths.rest);
}

/// Whether points of two bodies are contacts at x^n already that nothing brought together until then. Static contact
/// then carries on with them however far the step leads them: they meet by the arcs that they go on, or by a script
/// that is faster than in the step before. An impulse here would take the load from stages 3 and 7, and friction with
/// it: a box that a wall pushes ahead with 40 m/s^2 and friction 0.4 sank at g dt / 2 so. What would rebound
/// from a script is not left to them, and has that fault still.
bool carries_on(const StepView& view, const PairRecord& pair, const FeaturePair& features) {
    if (view.model.settings.approach_threshold >= 0) return false;
    const FeaturePoints points =
        closest_points(view.trajectories.motion(at(pair.a)), view.trajectories.motion(at(pair.b)), features, 0);
    const Vec3 gap = points.b0 - points.a0;
    const double distance = length(gap);
    if (!(distance > 0 && distance <= pair.lengths.proximity)) return false;
    const auto velocity = [&](std::int32_t body, const Vec3& point, bool before) {
        const Vec3 arm = point - view.state.pose[at(body)].com;
        if (!before || !view.model.bodies[at(body)].scripted())
            return point_velocity(view.clusters.impulsive(body), arm);
        const Motion& last = view.state.motion[at(body)]; // whose momentum is its angular velocity
        return last.velocity + cross(last.momentum, arm);
    };
    const auto approach = [&](bool before) {
        return dot(gap, velocity(pair.a, points.a0, before) - velocity(pair.b, points.b0, before)) / distance;
    };
    const double least = least_approach(view, pair.a, pair.b, pair.lengths.rest);
    return approach(true) <= std::max(least, (distance - pair.lengths.rest) / view.dt) &&
           pair_restitution(view.model, pair.a, pair.b) * approach(false) <= least;
}

/// Fills worker.points with the proximities of the bodies at the end of the step that approach too fast, the nearest
/// first, with the normals at which they meet. Static contact stops the others, and those that are slower than `least`.
template <class ContactOf>
void find_fast_points(const StepView& view, Worker& worker, const PairRecord& pair, const PosedShape& place_a,
                      const PosedShape& place_b, ContactOf&& contact) {
    worker.points.clear();
    const double least = least_approach(view, pair.a, pair.b, pair.lengths.rest);
    const Impulsive body_a = view.clusters.impulsive(pair.a), body_b = view.clusters.impulsive(pair.b);
    for (ProximityPoint p : worker.proximity.found) {
        const ContactPoint c = contact(p);
        const PointGap there = gap_on_the_way(p.features, place_a, place_b, view.dt * c.relative_velocity,
                                              pair.lengths.rest, {p.normal, p.distance});
        p.normal = there.normal;
        const double approach = -dot(c.relative_velocity, p.normal);
        const double gap = there.distance - pair.lengths.rest;
        if (!(approach > std::max(least, gap / view.dt))) continue;
        const double apart = dot(p.normal, arc_acceleration(body_b.angular_velocity, c.arm_b) -
                                               arc_acceleration(body_a.angular_velocity, c.arm_a));
        const double arrives = approach_on_arrival(approach, gap, apart);
        if (arrives > least && !stops_calmly(view, pair, arrives, gap) && !carries_on(view, pair, p.features))
            worker.points.push_back(p);
    }
    std::stable_sort(worker.points.begin(), worker.points.end(),
                     [](const ProximityPoint& p, const ProximityPoint& q) { return p.distance < q.distance; });
}

} // namespace

double least_approach(const StepView& view, std::int32_t a, std::int32_t b, double rest) {
    constexpr double kOfRest = 1.0 / 1024;
    if (view.model.settings.approach_threshold >= 0) return view.approach;
    return std::max(approach_of(view, a, b), kOfRest * rest / view.dt);
}

EndProximity end_proximity(const StepView& view, Worker& worker, const PairRecord& pair) {
    if (far_by_known_plane(view, pair)) return {};
    const BodyMotion a = view.trajectories.at_end(at(pair.a)), b = view.trajectories.at_end(at(pair.b));
    const Impulsive body_a = view.clusters.impulsive(pair.a), body_b = view.clusters.impulsive(pair.b);
    if (!may_approach(body_a, body_b, a.shape->radius, b.shape->radius, approach_of(view, pair.a, pair.b)))
        return {std::nullopt, std::nullopt, pair.processed || near_at_end(view, worker, pair)};
    const Stopwatch watch(worker.counters.detection_ms);
    const QueryAid aid = end_aid(view, pair);
    EndProximity out;
    out.near = find_proximities(a, b, pair.lengths.proximity, view.angle_cos, aid, worker.proximity).near;
    const auto contact = [&](const ProximityPoint& p) {
        const Vec3 arm_a = p.a - a.at1.pose->com, arm_b = p.b - b.at1.pose->com;
        const Vec3 relative = point_velocity(body_b, arm_b) - point_velocity(body_a, arm_a);
        return ContactPoint{p.normal, arm_a, arm_b, relative, pair_friction(view.model, pair.a, pair.b)};
    };
    find_fast_points(view, worker, pair, {*a.shape, *a.at1.pose}, {*b.shape, *b.at1.pose}, contact);
    const auto first = std::find_if(worker.points.begin(), worker.points.end(), [&](const ProximityPoint& p) {
        return admissible(a, b, p, view.angle_cos, worker.proximity);
    });
    if (first == worker.points.end()) return out;
    out.point = contact(*first);
    const FeaturePoints way =
        closest_points(view.trajectories.motion(at(pair.a)), view.trajectories.motion(at(pair.b)), first->features, 1);
    out.landing = landing_of(view, pair, *out.point, ((way.b1 - way.b0) - (way.a1 - way.a0)) / view.dt,
                             dot(out.point->normal, way.b0 - way.a0), 1);
    return out;
}

CollisionFinding find_collision(const StepView& view, Worker& worker, const PairRecord& pair, PairCache& cache) {
    const PairFinding found = examine(view, worker, pair, cache, view.model.settings.ccd);
    CollisionFinding out{.hit = found.hit, .verdict = found.verdict, .processed = false, .urgent = {}, .landing = {}};
    if (found.hit.hit) {
        out.processed = true;
        const SweptContact swept = contact_of_hit(view, {found.hit, pair.a, pair.b});
        out.urgent = rebounding(view, pair, swept.point);
        out.landing =
            landing_of(view, pair, *out.urgent, swept.point.relative_velocity, swept.start_gap, found.hit.toi);
        const double approach = -dot(out.urgent->relative_velocity, out.urgent->normal);
        const bool calm =
            approach >= 0 && (stops_calmly(view, pair, approach, 0) || carries_on(view, pair, found.hit.features));
        if (calm) {
            out.urgent.reset();
            out.verdict = Verdict::settled; // stage 5 has the proof
        }
    } else {
        const EndProximity end = end_proximity(view, worker, pair);
        out.processed = end.near;
        out.urgent = end.point;
        out.landing = end.landing;
    }
    return out;
}

namespace {

/// Whether the features of a hit are in the middle of a flat side: a corner of none, or an edge that only its
/// triangulation has.
bool is_flat(const StepView& view, const PairRecord& pair, const FeaturePair& f) {
    const auto corner = [&](std::int32_t body, std::int32_t v) {
        return view.model.shape_of(at(body)).topology.salient_vertex[at(v)] != 0;
    };
    const auto edge = [&](std::int32_t body, std::int32_t e) {
        return view.model.shape_of(at(body)).topology.salient_edge[at(e)] != 0;
    };
    switch (f.kind) {
    case FeatureKind::vertex_face: return !corner(pair.a, f.a);
    case FeatureKind::face_vertex: return !corner(pair.b, f.b);
    default: return !edge(pair.a, f.a) || !edge(pair.b, f.b);
    }
}

} // namespace

bool find_hits(const StepView& view, Worker& worker, PairRecord& pair, const Grounds* grounds,
               const CollisionFinding* known) {
    const CollisionFinding found = known != nullptr ? *known : find_collision(view, worker, pair, pair.cache);
    commit(view.trajectories, pair, found.verdict);
    if (found.processed) pair.processed.set();
    worker.hits.clear();
    if (!found.urgent) return false;
    worker.hits.push_back(*found.urgent);
    worker.landing = found.landing;
    worker.grounds.clear();
    if (grounds != nullptr) grounds->beside(view, pair.a, pair.b, worker.grounds);
    find_simultaneous_hits(view, worker.footprints, {found.hit, pair.a, pair.b}, *found.urgent, pair.lengths.rest,
                           worker.grounds, worker.hits);
    constexpr std::size_t kSpan = 4; // three that may span it, and itself
    worker.first_within = found.hit.hit && worker.hits.size() >= kSpan && is_flat(view, pair, found.hit.features);
    return true;
}

CollisionFinding look_at(const StepView& view, Worker& worker, PairRecord& pair) {
    const CollisionFinding found = find_collision(view, worker, pair, pair.cache);
    if (found.urgent) return found;
    commit(view.trajectories, pair, found.verdict);
    if (found.processed) pair.processed.expect();
    return found;
}

} // namespace flotilla
