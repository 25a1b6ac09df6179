// SPDX-License-Identifier: MIT
#include "static_contact/between.hpp"

#include <algorithm>
#include <utility>

#include "base/index.hpp"

namespace flotilla {
namespace {

constexpr double kAcross = 0.95; // cosine of 18 degrees
/// Of the play, for either side; of the rest distances, what leaves no play beside them: those that were noted where
/// bodies were placed (RestDistance) add up to it.
constexpr double kOfPlay = 0.25, kNone = 1 + 1.0 / 64;

/// Goes along pairs in the order of bodies.
template <class Pair>
class Listed {
  public:
    explicit Listed(std::span<const Pair> pairs) : left_(pairs) {}
    [[nodiscard]] bool has(std::int32_t a, std::int32_t b) {
        while (!left_.empty() && std::pair(left_[0].a, left_[0].b) < std::pair(a, b)) left_ = left_.subspan(1);
        return !left_.empty() && left_[0].a == a && left_[0].b == b;
    }

  private:
    std::span<const Pair> left_;
};

bool is_fixed(const Model& model, std::int32_t body) {
    return !model.bodies[at(body)].movable() && !model.bodies[at(body)].scripted();
}

} // namespace

void Between::find(const Model& model, const ContactSet& set, std::span<const RestDistance> noted,
                   std::span<const SqueezedPair> squeezed) {
    list_sides(model, set, noted, squeezed);
    if (sides_.empty()) return;
    rooms_.assign(set.size(), std::numeric_limits<double>::infinity());
    yields_.assign(set.size(), 0);
    follow_rows();
    for (std::size_t i = 0, end = 0; i < sides_.size(); i = end) {
        for (end = i + 1; end < sides_.size() && sides_[end].body == sides_[i].body;) ++end;
        compare(std::span(sides_).subspan(i, end - i));
    }
}

void Between::list_sides(const Model& model, const ContactSet& set, std::span<const RestDistance> noted,
                         std::span<const SqueezedPair> squeezed) {
    const std::span<const Contact> contacts = set.contacts;
    sides_.clear();
    Listed noted_pairs(noted);
    Listed squeezed_pairs(squeezed);
    for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
        const Contact& c = contacts[first];
        for (end = first + 1; end < contacts.size() && !begins_pair(contacts, end);) ++end;
        const bool is_noted = noted_pairs.has(c.a, c.b), is_squeezed = squeezed_pairs.has(c.a, c.b);
        const bool lacks_room = is_noted || is_squeezed;
        if (lacks_room || is_fixed(model, c.a) || is_fixed(model, c.b)) add_sides(model, set, first, end, lacks_room);
    }
    std::ranges::stable_sort(sides_, {}, &Side::body);
}

/// One for all contacts of a pair, where they face one way.
void Between::add_sides(const Model& model, const ContactSet& set, std::size_t first, std::size_t end,
                        bool lacks_room) {
    const std::span<const Contact> pair = std::span(set.contacts).subspan(first, end - first);
    Vec3 sum;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Contact& c : pair) sum += c.normal, nearest = std::min(nearest, c.distance);
    const bool one_way = !holds_between(pair);
    const auto add = [&](std::int32_t body, std::int32_t other, const Vec3& normal, double distance) {
        if (!model.bodies[at(body)].movable()) return;
        sides_.push_back({body, other, first, body == pair[0].b ? normal : -normal, distance, set.rest[first],
                          is_fixed(model, other), lacks_room, !model.bodies[at(other)].movable()});
    };
    for (const auto& [body, other] : {std::pair(pair[0].a, pair[0].b), std::pair(pair[0].b, pair[0].a)}) {
        if (one_way)
            add(body, other, normalized(sum), nearest);
        else
            for (const Contact& c : pair) add(body, other, c.normal, c.distance);
    }
}

std::span<Between::Side> Between::sides_of(std::int32_t body) {
    const auto [first, last] = std::ranges::equal_range(sides_, body, {}, &Side::body);
    return {first, last};
}

/// From what does not give way on.
void Between::follow_rows() {
    for (bool any = true; any;) {
        any = false;
        for (Side& side : sides_) {
            if (side.holds || !side.lacks_room) continue;
            side.holds = std::ranges::any_of(sides_of(side.other), [&](const Side& beyond) {
                return beyond.holds && beyond.lacks_room && dot(beyond.normal, side.normal) > kAcross;
            });
            any |= side.holds;
        }
    }
}

void Between::compare(std::span<const Side> around) {
    for (std::size_t i = 1; i < around.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const Side &p = around[i], &q = around[k];
            if (p.first == q.first || !p.holds || !q.holds || !(dot(p.normal, q.normal) < -kAcross)) continue;
            const double play = p.distance + q.distance;
            for (const std::size_t first : {p.first, q.first}) {
                if (!(p.fixed && q.fixed))
                    yields_[first] |= p.lacks_room && q.lacks_room ? 1 : 0;
                else if (play < kNone * (p.rest + q.rest))
                    rooms_[first] = std::min(rooms_[first], kOfPlay * play);
            }
        }
}

} // namespace flotilla
