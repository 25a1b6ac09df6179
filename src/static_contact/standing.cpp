// SPDX-License-Identifier: MIT
#include "static_contact/standing.hpp"

#include <algorithm>
#include <limits>

#include "base/index.hpp"

namespace flotilla {
namespace {

/// Of the arm of a pivot, and of the length of an edge: what lies so near together is one point, or on one line. More
/// than the rounding of places.
constexpr double kOnePlace = 0x1p-10;

} // namespace

double arm_of(const Contact& c, const VelocityArrays& bodies) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::int32_t body : {c.a, c.b})
        if (bodies.inverse_mass[at(body)] > 0)
            least = std::min(least, length(point_on(c, body) - bodies.position[at(body)]));
    return least;
}

void Pivot::add(const Vec3& point) {
    const Vec3 way = point - origin;
    switch (kind) {
    case Kind::held: return;
    case Kind::none:
        kind = Kind::point;
        origin = point;
        edge = {};
        return;
    case Kind::point:
        if (!(length(way) > kOnePlace * arm)) return;
        kind = Kind::edge;
        edge = way;
        return;
    case Kind::edge: break;
    }
    if (length_sq(way) > length_sq(edge)) { // the longer line is the more certain one
        const Vec3 end = origin + edge;
        edge = way;
        if (!has(end)) kind = Kind::held;
    } else if (!has(point)) {
        kind = Kind::held;
    }
}

bool Pivot::has(const Vec3& point) const {
    const Vec3 way = point - origin;
    if (kind == Kind::point) return length(way) <= kOnePlace * arm;
    const double extent = length(edge);
    return kind == Kind::edge && length(cross(edge, way)) <= kOnePlace * extent * std::max(extent, length(way));
}

void Pivot::add(const Pivot& other) {
    arm = std::min(arm, other.arm);
    if (other.kind == Kind::held) kind = Kind::held;
    if (other.turns()) add(other.origin);
    if (other.kind == Kind::edge) add(other.origin + other.edge);
}

void TurningBodies::clear(std::size_t bodies, std::size_t contacts) {
    expected.clear(bodies);
    pair_pivots.resize(contacts);
}

void TurningBodies::join(std::size_t bodies, std::span<const Contact> contacts) {
    pivots.assign(bodies, {});
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& c = contacts[i];
        if (!begins_pair(contacts, i) || pair_pivots[i].kind == Pivot::Kind::none) continue;
        for (const std::int32_t body : {c.a, c.b}) pivots[at(body)].add(pair_pivots[i]);
    }
}

Standing::Standing(std::span<const Contact> pair, const VelocityArrays& bodies, const TurningBodies& turning,
                   double time_step, bool at_end)
    : pair_(pair), bodies_(bodies), turning_(turning), time_step_(time_step), at_end_(at_end) {
    slides_ = pair.front().friction == 0;
    for (const std::int32_t body : {pair.front().a, pair.front().b}) {
        const bool still = length_sq(bodies.turn_of(body)) == 0;
        // Prescribed ones are seen on their way (turned_under() in targets.cpp).
        slides_ = slides_ || (!still && !(bodies.inverse_mass[at(body)] > 0));
        turns_far_ = turns_far_ || !(time_step * length(bodies.turn_of(body)) <= 1);
    }
}

/// Whether the pivot goes round a body by more than a radian. A top goes round its tip as far as it will.
bool Standing::goes_round() const {
    const auto goes = [&](std::int32_t body) {
        const Vec3 arm = pivot_.origin - bodies_.position[at(body)];
        return bodies_.inverse_mass[at(body)] > 0 &&
               !(time_step_ * length(cross(bodies_.turn_of(body), arm)) <= length(arm));
    };
    return goes(pair_.front().a) || goes(pair_.front().b);
}

void Standing::find() {
    pivot_ = {};
    if (slides_) return;
    for (const std::int32_t body : {pair_.front().a, pair_.front().b})
        if (!pivot_.turns() && bodies_.inverse_mass[at(body)] > 0) pivot_ = turning_.pivots[at(body)];
    if (turns_far_ && (pivot_.kind != Pivot::Kind::point || goes_round())) pivot_ = {};
    if (pivot_.kind != Pivot::Kind::edge) return;
    edge_ = normalized(pivot_.edge);
    if (!at_end_) turn_about_edge();
}

/// Apart from their turn about the edge both go with the mean by mass.
void Standing::turn_about_edge() {
    const Contact& c = pair_.front();
    const double of_a = bodies_.inverse_mass[at(c.a)], of_b = bodies_.inverse_mass[at(c.b)];
    const Vec3 a = turning_.expected.angular_velocity(bodies_, c.a),
               b = turning_.expected.angular_velocity(bodies_, c.b);
    const Vec3 common = (of_b * a + of_a * b) / (of_a + of_b);
    const auto set = [&](std::size_t k, const Vec3& omega) {
        const Vec3 about_edge = dot(edge_, omega - common) * edge_;
        spin_[k] = common + about_edge;
        rate_[k] = cross(common, about_edge);
    };
    set(0, a);
    set(1, b);
}

bool Standing::on(std::size_t i, ArcContact& arc) const {
    if (!stands(i)) return false;
    const double rate = arc.rate;
    arc = {};
    arc.rate = rate;
    if (at_end_) return true;
    const Contact& c = pair_[i];
    const Vec3 back = mean_less_now(c, false) - mean_less_now(c, true);
    const Vec3 along = back - dot(c.normal, back) * c.normal;
    arc.stands = sticks(c, length(along), bodies_, turning_.last) ? back : back - along;
    return true;
}

void Standing::on_all(std::span<ArcContact> arcs) {
    find();
    if (!pivot_.turns()) return;
    for (std::size_t i = 0; i < pair_.size(); ++i) on(i, arcs[i]);
}

Vec3 Standing::mean_less_now(const Contact& c, bool of_b) const {
    const std::int32_t body = of_b ? c.b : c.a;
    if (!(bodies_.inverse_mass[at(body)] > 0)) return {};
    const Vec3 arm = point_on(c, body) - bodies_.position[at(body)];
    if (pivot_.kind == Pivot::Kind::point) return turning_.expected.mean_less_now(body, arm);
    const std::size_t k = of_b ? 1 : 0;
    if (!(time_step_ * length(spin_[k]) <= 1)) return {};
    return (1 / time_step_) * arc_way(time_step_ * spin_[k], arm) - cross(spin_[k], arm) +
           0.5 * time_step_ * cross(rate_[k], arm);
}

} // namespace flotilla
