// SPDX-License-Identifier: MIT
#include "static_contact/between.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "parallel/compact.hpp"

namespace flotilla {
namespace {

constexpr double kAcross = 0.95; // cosine of 18 degrees
/// Of a rest distance, what is due where there is no play. What of both rest distances is none: those that were noted
/// where bodies were placed (RestDistance) add up to the play.
constexpr double kDue = 0.5, kNoPlay = 1 + 1.0 / 64;

/// Of pairs sorted by bodies.
template <class Pair>
bool has(std::span<const Pair> pairs, const Contact& c) {
    const auto less = [](const Pair& p, const Contact& k) { return std::pair(p.a, p.b) < std::pair(k.a, k.b); };
    const auto it = std::lower_bound(pairs.begin(), pairs.end(), c, less);
    return it != pairs.end() && it->a == c.a && it->b == c.b;
}

bool is_fixed(const Model& model, std::int32_t body) {
    return !model.bodies[at(body)].dynamic() && !model.bodies[at(body)].scripted();
}

} // namespace

void Between::find(Team* team, const Model& model, const ContactSet& set, std::span<const RestDistance> noted,
                   std::span<const SqueezedPair> squeezed, double least_lacking) {
    list_sides(team, model, set, noted, squeezed);
    for_bodies([](std::span<Side> around) { drop_where_none_is_across(around); });
    std::erase_if(sides_, [](const Side& s) { return s.body < 0; });
    if (sides_.empty()) return;
    rooms_.assign(set.size(), std::numeric_limits<double>::infinity());
    yields_.assign(set.size(), 0);
    pressed_.assign(set.size(), 0);
    presses_ = false;
    follow_rows();
    for_bodies([&](std::span<Side> around) { compare(around); });
    if (std::ranges::none_of(sides_, &Side::scripted)) return;
    for_bodies([&](std::span<Side> around) { press(around, least_lacking); });
}

void Between::list_sides(Team* team, const Model& model, const ContactSet& set, std::span<const RestDistance> noted,
                         std::span<const SqueezedPair> squeezed) {
    constexpr std::size_t kContactGrain = 256; // contacts of a task
    const std::span<const Contact> contacts = set.contacts;
    const auto lacks_room = [&](const Contact& c) { return has(noted, c) || has(squeezed, c); };
    const auto moves = [&](std::int32_t body) { return model.bodies[at(body)].dynamic(); };
    const auto asked = [&](std::size_t i) {
        const Contact& c = contacts[i];
        return begins_pair(contacts, i) && (!moves(c.a) || !moves(c.b) || lacks_room(c));
    };
    compact_if({team, "pairs beside what does not give way", kContactGrain, places_}, contacts.size(), asked, follow_,
               0, [](std::size_t i) { return i; });
    sides_.clear();
    for (const std::size_t first : follow_) {
        std::size_t end = first + 1;
        while (end < contacts.size() && !begins_pair(contacts, end)) ++end;
        add_sides(model, set, first, end, lacks_room(contacts[first]));
    }
    // By pairs too, whose sides of one body face the same way or stand in the order of contacts: no two are alike.
    std::ranges::sort(sides_, {}, [](const Side& s) { return std::pair(s.body, s.contact); });
}

/// One for all contacts of a pair, where they face one way.
void Between::add_sides(const Model& model, const ContactSet& set, std::size_t first, std::size_t end,
                        bool lacks_room) {
    const std::span<const Contact> pair = std::span(set.contacts).subspan(first, end - first);
    Vec3 sum;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Contact& c : pair) sum += c.normal, nearest = std::min(nearest, c.distance);
    const double alike = kAcross * length(sum);
    const bool one_way = std::ranges::all_of(pair, [&](const Contact& c) { return dot(c.normal, sum) > alike; });
    const auto add = [&](std::int32_t body, std::int32_t other, std::size_t contact, const Vec3& normal,
                         double distance) {
        if (!model.bodies[at(body)].movable()) return;
        sides_.push_back({body, other, first, contact, body == pair[0].b ? normal : -normal, distance, set.rest[first],
                          is_fixed(model, other), model.bodies[at(other)].scripted(), lacks_room,
                          !model.bodies[at(other)].dynamic()});
    };
    for (const auto& [body, other] : {std::pair(pair[0].a, pair[0].b), std::pair(pair[0].b, pair[0].a)}) {
        if (one_way)
            add(body, other, first, normalized(sum), nearest);
        else
            for (std::size_t i = first; i < end; ++i)
                add(body, other, i, pair[i - first].normal, pair[i - first].distance);
    }
}

std::span<Between::Side> Between::sides_of(std::int32_t body) {
    const auto [first, last] = std::ranges::equal_range(sides_, body, {}, &Side::body);
    return {first, last};
}

/// From what does not give way on: what is beyond a body that is held is held by it, in the same direction.
void Between::follow_rows() {
    follow_.clear();
    for (std::size_t i = 0; i < sides_.size(); ++i)
        if (sides_[i].holds && sides_[i].lacks_room) follow_.push_back(i);
    for (std::size_t next = 0; next < follow_.size(); ++next) {
        const Side& held = sides_[follow_[next]];
        for (const Side& to : sides_of(held.body)) {
            if (!to.lacks_room || to.first == held.first || !(dot(to.normal, held.normal) < -kAcross)) continue;
            for (Side& beyond : sides_of(to.other))
                if (beyond.first == to.first && !beyond.holds && dot(beyond.normal, held.normal) > kAcross) {
                    beyond.holds = true;
                    follow_.push_back(static_cast<std::size_t>(&beyond - sides_.data()));
                }
        }
    }
}

/// Of a body that touches one other alone, or all whose sides face one way, as on a floor of tiles.
void Between::drop_where_none_is_across(std::span<Side> around) {
    Vec3 sum;
    for (const Side& s : around) sum += s.normal;
    const double least = 0.5 * length(sum);
    const bool one_way = std::ranges::all_of(around, [&](const Side& s) { return dot(s.normal, sum) > least; });
    if (one_way || around.front().first == around.back().first)
        for (Side& s : around) s.body = -1;
}

void Between::compare(std::span<const Side> around) {
    for (std::size_t i = 1; i < around.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const Side &p = around[i], &q = around[k];
            if (p.first == q.first || !p.holds || !q.holds || !(dot(p.normal, q.normal) < -kAcross)) continue;
            const bool no_play = p.distance + q.distance < kNoPlay * (p.rest + q.rest);
            for (const Side* side : {&p, &q}) {
                if (!(p.fixed && q.fixed))
                    yields_[side->first] |= p.lacks_room && q.lacks_room ? 1 : 0;
                else if (no_play)
                    rooms_[side->first] = kDue * side->rest;
            }
        }
}

/// A script on one side at least, and together they lack what one would: a floor may keep its distance and leave all of
/// it to the script. Two sides of one body are its shape, which presses nothing.
void Between::press(std::span<const Side> around, double least_lacking) {
    for (std::size_t i = 1; i < around.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const Side &p = around[i], &q = around[k];
            const bool closed = (p.scripted && (q.scripted || q.fixed)) || (p.fixed && q.scripted);
            if (!closed || p.other == q.other) continue;
            if (!(dot(p.normal, q.normal) < -kAcross)) continue;
            if (p.distance + q.distance < (1 - least_lacking) * (p.rest + q.rest))
                pressed_[p.first] = pressed_[q.first] = 1, presses_ = true;
        }
}

} // namespace flotilla
