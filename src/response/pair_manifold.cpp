// SPDX-License-Identifier: MIT
#include "response/pair_manifold.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flotilla {
namespace {

/// A bound on the sweeps over the hits of a pair, which end at kTolerance.
constexpr int kSweeps = 300;
/// Sweeps after which momentum begins. Until then impulses that are not determined come out shared evenly: with
/// momentum from the first sweep on a box that a script presses on was knocked out of rest, and from the 30th on twenty
/// boxes that fell flat on each other did not stand.
constexpr int kPlainSweeps = 100;
/// The share of the fastest relative velocity at which the sweeps stop. What they leave is spin, which makes corners of
/// the next hits land one after the other: two boxes that fall on a floor and flat on each other (restitution 0.8,
/// friction 0.4, 1/24 s) come to 3.1 rad/s with 1e-4 and no more than 30 sweeps, to 0.003 with this.
constexpr double kTolerance = 0x1p-20;

double approach(const ContactPoint& point) { return -dot(point.normal, point.relative_velocity); }

} // namespace

void PairManifold::start(const Impulsive& a, const Impulsive& b, double gap) {
    a_ = a;
    b_ = b;
    gap_ = gap;
    hits_.clear();
}

void PairManifold::set_effects(Hit& hit) const {
    const Vec3 &arm_a = hit.point.arm_a, &arm_b = hit.point.arm_b;
    const Mat3 k = collision_matrix(a_, b_, arm_a, arm_b);
    hit.mass_normal = normal_mobility(a_, b_, hit.point, k);
    hit.mass_tangent = k.m[0] + k.m[4] + k.m[8]; // its trace: no less than its largest eigenvalue
    hit.own = k;
    hit.turn_a = a_.inverse_inertia * cross_matrix(arm_a);
    hit.turn_b = b_.inverse_inertia * cross_matrix(arm_b);
}

PairManifold::Velocities PairManifold::applied() const {
    Velocities v;
    for (const Hit& hit : hits_) push(hit, hit.impulse, v);
    return v;
}

Vec3 PairManifold::change(const ContactPoint& point, const Velocities& v) {
    return (v.linear_b + cross(v.angular_b, point.arm_b)) - (v.linear_a + cross(v.angular_a, point.arm_a));
}

bool PairManifold::simultaneous(const ContactPoint& point, double gap, double reach) const {
    const double first = approach(hits_[0].point);
    const double speed = approach(point) + dot(point.normal, change(point, applied()));
    if (!(speed > kTolerance * first)) return false; // it touches, and does not meet
    return std::abs(first * std::max(0.0, gap) - speed * std::max(0.0, gap_)) <= reach * std::min(first, speed);
}

PairManifold::Hit PairManifold::make_hit(const ContactPoint& point, double restitution,
                                         const Velocities& applied) const {
    Hit hit;
    hit.point = point;
    set_effects(hit);
    hit.point.relative_velocity -= change(point, applied);
    hit.target = std::max(0.0, -restitution * dot(point.normal, hit.point.relative_velocity));
    return hit;
}

void PairManifold::add(const ContactPoint& point, double restitution, const Vec3& impulse) {
    Hit hit = make_hit(point, restitution, applied());
    hit.impulse = impulse;
    hits_.push_back(hit);
}

void PairManifold::push(const Hit& hit, const Vec3& impulse, Velocities& v) const {
    v.linear_a -= velocity_change(a_, impulse);
    v.angular_a -= hit.turn_a * impulse;
    v.linear_b += velocity_change(b_, impulse);
    v.angular_b += hit.turn_b * impulse;
}

Vec3 PairManifold::relative(const Hit& hit, const Velocities& v) {
    return hit.point.relative_velocity + change(hit.point, v);
}

/// Returns the largest change of a velocity.
double PairManifold::sweep(bool all, Velocities& v) {
    double worst = 0;
    for (Hit& hit : hits_) {
        if (!(hit.mass_normal > 0) || (hit.within && !all)) continue;
        const Vec3& n = hit.point.normal;
        const Vec3 u = relative(hit, v);
        const double old = dot(n, hit.next), normal = std::max(0.0, old + (hit.target - dot(n, u)) / hit.mass_normal);
        if (!(normal > 0) && hit.next == Vec3{}) continue;
        worst = std::max(worst, std::abs(normal - old) * hit.mass_normal);
        // Down the gradient of the energy of the slip, onto the disc of Coulomb's law.
        const Vec3 slip = u + hit.own * ((normal - old) * n), tangential = slip - dot(n, slip) * n;
        const Vec3 friction = hit.next - old * n;
        Vec3 wanted = friction - tangential / hit.mass_tangent;
        const double size = length(wanted), bound = hit.point.friction * normal;
        if (size > bound) wanted = (bound / size) * wanted;
        worst = std::max(worst, length(wanted - friction) * hit.mass_tangent);
        const Vec3 next = normal * n + wanted;
        push(hit, next - hit.next, v);
        hit.next = next;
    }
    return worst;
}

/// Adds a share of what the last sweep changed.
void PairManifold::carry_on(double share, Velocities& v) {
    for (Hit& hit : hits_) {
        const Vec3 more = share * (hit.next - hit.last);
        hit.last = hit.next;
        push(hit, more, v);
        hit.next += more;
    }
}

void PairManifold::solve(Velocities& v) {
    double fastest = 0;
    for (Hit& hit : hits_) {
        fastest = std::max(fastest, length(hit.point.relative_velocity));
        hit.next = hit.last = hit.impulse;
    }
    if (std::ranges::any_of(hits_, &Hit::within)) sweep_on(false, fastest, v);
    sweep_on(true, fastest, v);
}

/// Sweeps with Nesterov's momentum, which begins anew where a sweep changes more than the one before: feet that stand
/// close to each other, as the corners of a narrow side, turn a body by hardly anything that a sweep sees.
void PairManifold::sweep_on(bool all, double fastest, Velocities& v) {
    double before = std::numeric_limits<double>::infinity();
    int age = 0;
    for (int i = 0; i < kSweeps; ++i) {
        carry_on(age > 0 ? (age - 1.0) / (age + 2.0) : 0, v);
        const double worst = sweep(all, v);
        if (worst <= kTolerance * fastest) break;
        age = worst > before || i < kPlainSweeps ? 0 : age + 1;
        before = worst;
    }
}

/// How much of all impulses the pair's energy allows ([13], as energy_clamp() has it for one).
double PairManifold::energy_share() const {
    Velocities v;
    double slope = 0, curvature = 0;
    for (const Hit& hit : hits_) {
        push(hit, hit.next, v);
        slope += dot(hit.next, point_velocity(b_, hit.point.arm_b) - point_velocity(a_, hit.point.arm_a));
    }
    if (!(slope < 0)) return 0;
    for (const Hit& hit : hits_) curvature += dot(hit.next, relative(hit, v) - hit.point.relative_velocity);
    return curvature > -2 * slope ? -2 * slope / curvature : 1.0;
}

bool PairManifold::resolve(std::span<const ContactPoint> points, double restitution, bool within,
                           std::vector<Change>& changes) {
    const std::size_t before = hits_.size();
    Velocities v = applied();
    for (const ContactPoint& point : points) hits_.push_back(make_hit(point, restitution, v));
    hits_[before].within = within;
    solve(v);
    const double share = energy_share();
    const auto pushed = [](const Hit& hit) { return dot(hit.next, hit.point.normal) > 0; };
    const auto first = hits_.begin() + static_cast<std::ptrdiff_t>(before);
    if (!(share > 0) || std::none_of(first, hits_.end(), pushed)) {
        hits_.resize(before);
        return false;
    }
    changes.clear();
    for (Hit& h : hits_) {
        changes.push_back({h.point, share * h.next - h.impulse});
        h.impulse = share * h.next;
    }
    return true;
}

} // namespace flotilla
