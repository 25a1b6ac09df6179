// SPDX-License-Identifier: MIT
#include "static_contact/landing_load.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/axis_locks.hpp"
#include "base/index.hpp"
#include "state/loads.hpp"

namespace flotilla {
namespace {

/// N s: the inverse of a subnormal number may not be finite.
constexpr double kLeastCarried = std::numeric_limits<double>::min();
/// What a pair's load makes of the lighter body, in terms of what the loads make of the one that presses. What carries
/// it on, at the other side of that body, is left to the solve, which has to find both to a share of the velocity that
/// the one alone would give.
constexpr double kMostHeavier = 16;

/// What the loads of a pair's bodies press on each other: that of the one that is pressed more.
struct Press {
    std::int32_t body = 0;
    double impulse = 0; ///< N s
};
Press press_of_loads(const Model& model, const VelocityArrays& bodies, const Contact& c, double seconds) {
    const auto press = [&](std::int32_t body, double sign) {
        const double inverse_mass = bodies.inverse_mass[at(body)];
        return inverse_mass > 0 ? std::max(0.0, sign * dot(c.normal, acceleration(model, at(body)))) / inverse_mass : 0;
    };
    const double of_a = press(c.a, 1), of_b = press(c.b, -1);
    return of_b >= of_a ? Press{c.b, seconds * of_b} : Press{c.a, seconds * of_a};
}

/// N s, on b. `point`: on a.
void push(VelocityArrays& bodies, const Contact& c, const Vec3& point, const Vec3& impulse) {
    const auto change = [&](std::size_t i, const Vec3& place, const Vec3& own) {
        if (!(bodies.inverse_mass[i] > 0)) return;
        bodies.velocity[i] += bodies.inverse_mass[i] * free_part(bodies.locked[i], own);
        bodies.angular_velocity[i] += bodies.inverse_inertia[i] * cross(place - bodies.position[i], own);
    };
    change(at(c.a), point, -impulse);
    change(at(c.b), point + c.across, impulse);
}

/// The contacts of one pair, and what they carried in the step before.
class LandingPair {
  public:
    LandingPair(const ContactTargets& targets, std::size_t inside, std::span<const Vec3> impulses)
        : targets_(targets), impulses_(impulses), first_(inside), end_(inside) {
        const std::vector<Contact>& contacts = targets.contacts;
        const auto same = [&](std::size_t k) {
            return contacts[k].a == contacts[inside].a && contacts[k].b == contacts[inside].b;
        };
        while (first_ > 0 && same(first_ - 1)) --first_;
        while (end_ < contacts.size() && same(end_)) ++end_;
        for (std::size_t k = first_; k < end_; ++k) {
            all_ += carried(k);
            sum_ += impulses[k];
        }
    }

    [[nodiscard]] std::size_t first() const { return first_; }
    [[nodiscard]] std::size_t end() const { return end_; }
    [[nodiscard]] double carried() const { return all_; } ///< N s
    [[nodiscard]] bool takes(std::size_t k) const { return targets_.carries[k] != 0; }
    [[nodiscard]] bool carries_now(std::size_t k) const { return targets_.arcs[k].carries > 0; }

    /// Fills `taken` with what contacts take over (N s, by contact from first() on): at either corner each from what
    /// was nearest to it, so that an edge keeps how its ends share.
    void take_over(std::vector<double>& taken) const {
        taken.assign(end_ - first_, 0);
        for (std::size_t i = first_; i < end_; ++i)
            for (const bool now : {true, false})
                if (const std::size_t k = nearest(i, now); carried(i) > 0 && k < end_) taken[k - first_] += carried(i);
    }

    /// Of the normal impulse of a contact, its friction: as that of the pair was in the step before.
    [[nodiscard]] Vec3 friction(const Contact& c) const {
        const Vec3 ratio = (1 / all_) * (sum_ - dot(sum_, c.normal) * c.normal);
        const double size = length(ratio);
        return size > c.friction ? (c.friction / size) * ratio : ratio;
    }

  private:
    [[nodiscard]] double carried(std::size_t k) const {
        return std::max(0.0, dot(targets_.contacts[k].normal, impulses_[k]));
    }

    /// Of the contacts that carry now, or that land.
    [[nodiscard]] std::size_t nearest(std::size_t i, bool now) const {
        const auto distance = [&](std::size_t k) {
            return length_sq(targets_.contacts[k].point - targets_.contacts[i].point);
        };
        std::size_t best = end_;
        for (std::size_t k = first_; k < end_; ++k)
            if (takes(k) && carries_now(k) == now && (best == end_ || distance(k) < distance(best))) best = k;
        return best;
    }

    const ContactTargets& targets_;
    std::span<const Vec3> impulses_;
    std::size_t first_, end_;
    double all_ = 0; ///< N s, along the normals
    Vec3 sum_;       ///< N s
};

/// Most contacts have none.
std::size_t next_that_carries(const ContactTargets& targets, std::size_t from) {
    if (from >= targets.carries.size()) return targets.carries.size();
    const std::uint8_t* const begin = targets.carries.data();
    const void* const found = std::memchr(begin + from, 1, targets.carries.size() - from);
    return found == nullptr ? targets.carries.size()
                            : static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - begin);
}

} // namespace

void give_landing_loads(const Model& model, const ContactTargets& targets, double accelerated, std::span<Vec3> impulses,
                        VelocityArrays& bodies, LandingLoads& out) {
    out.contacts.clear();
    out.impulses.clear();
    out.pairs.clear();
    for (std::size_t i = next_that_carries(targets, 0); i < targets.carries.size();) {
        out.pairs.push_back(i);
        i = next_that_carries(targets, LandingPair(targets, i, impulses).end());
    }
    if (out.pairs.empty()) return;
    const auto press = [&](const LandingPair& pair) {
        return press_of_loads(model, bodies, targets.contacts[pair.first()], accelerated);
    };
    const auto most_of = [&](const LandingPair& pair, const Press& loads) {
        const Contact& c = targets.contacts[pair.first()];
        const std::int32_t other = loads.body == c.a ? c.b : c.a;
        const double of_other = bodies.inverse_mass[at(other)], own = bodies.inverse_mass[at(loads.body)];
        return of_other > 0 ? kMostHeavier * loads.impulse * (own / of_other) : std::numeric_limits<double>::infinity();
    };
    // A body has one weight, on however many it rolls.
    out.carried.resize(model.size());
    for (const std::size_t inside : out.pairs) out.carried[at(press(LandingPair(targets, inside, impulses)).body)] = 0;
    for (const std::size_t inside : out.pairs) {
        const LandingPair pair(targets, inside, impulses);
        out.carried[at(press(pair).body)] += pair.carried();
    }
    for (const std::size_t inside : out.pairs) {
        const LandingPair pair(targets, inside, impulses);
        const Press loads = press(pair);
        const double all = out.carried[at(loads.body)];
        if (!(pair.carried() >= kLeastCarried)) continue;
        const double load = std::min(pair.carried() * std::min(1.0, loads.impulse / all), most_of(pair, loads));
        pair.take_over(out.taken);
        for (std::size_t k = pair.first(); k < pair.end(); ++k) {
            if (!pair.takes(k)) continue;
            const Contact& c = targets.contacts[k];
            const double share = std::abs(targets.arcs[k].carries) * out.taken[k - pair.first()] / pair.carried();
            const Vec3 normal = share * load * c.normal;
            const Vec3 place = c.point - targets.arcs[k].shift + targets.arcs[k].carries_at;
            if (!pair.carries_now(k)) {
                // The solve finds it, where the contact lands.
                push(bodies, c, place, normal);
                push(bodies, c, c.point, -normal);
                continue;
            }
            const Vec3 impulse = normal + share * load * pair.friction(c);
            push(bodies, c, place, impulse);
            out.contacts.push_back(k);
            out.impulses.push_back(impulse);
        }
    }
    for (std::size_t k = 0; k < out.contacts.size(); ++k) impulses[out.contacts[k]] -= out.impulses[k];
}

void add_landing_loads(const LandingLoads& given, std::span<Vec3> impulses) {
    for (std::size_t k = 0; k < given.contacts.size(); ++k) impulses[given.contacts[k]] += given.impulses[k];
}

} // namespace flotilla
