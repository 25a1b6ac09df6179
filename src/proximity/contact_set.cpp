// SPDX-License-Identifier: MIT
#include "proximity/contact_set.hpp"

#include <algorithm>
#include <utility>

#include "parallel/compact.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kGrain = 512; // contacts of a task

} // namespace

void ContactSet::add(const Contact& contact, double rest_distance, bool was_processed, bool is_ahead) {
    contacts.push_back(contact);
    rest.push_back(rest_distance);
    processed.push_back(was_processed ? 1 : 0);
    ahead.push_back(is_ahead ? 1 : 0);
}

void ContactSet::clear() {
    contacts.clear();
    rest.clear();
    processed.clear();
    ahead.clear();
    min_distance = std::numeric_limits<double>::infinity();
}

void ContactSet::resize(std::size_t size) {
    contacts.resize(size);
    rest.resize(size);
    processed.resize(size);
    ahead.resize(size);
}

void ContactSet::put(std::size_t place, const ContactSet& part) {
    const auto to = static_cast<std::ptrdiff_t>(place);
    std::copy(part.contacts.begin(), part.contacts.end(), contacts.begin() + to);
    std::copy(part.rest.begin(), part.rest.end(), rest.begin() + to);
    std::copy(part.processed.begin(), part.processed.end(), processed.begin() + to);
    std::copy(part.ahead.begin(), part.ahead.end(), ahead.begin() + to);
}

void ContactSet::append(const ContactSet& part, std::size_t begin, std::size_t end) {
    const auto copy = [&](const auto& from, auto& to) {
        const auto at_place = [&](std::size_t i) { return from.begin() + static_cast<std::ptrdiff_t>(i); };
        to.insert(to.end(), at_place(begin), at_place(end));
    };
    copy(part.contacts, contacts);
    copy(part.rest, rest);
    copy(part.processed, processed);
    copy(part.ahead, ahead);
}

void ContactSet::list_pairs(Team& team, std::vector<std::size_t>& places, std::vector<CandidatePair>& out) const {
    // A pair is listed with the first of its contacts that is not ahead.
    const auto first = [&](std::size_t i) {
        if (ahead[i] != 0) return false;
        std::size_t before = i;
        while (before > 0 && pair(before - 1) == pair(i) && ahead[before - 1] != 0) --before;
        return before == 0 || !(pair(before - 1) == pair(i));
    };
    compact_if({&team, "list pairs", kGrain, places}, size(), first, out, 0, [&](std::size_t i) { return pair(i); });
}

void ContactSet::mark_processed(Team& team, std::span<const CandidatePair> pairs) {
    team.for_chunks("mark pairs", size(), kGrain, [&](std::size_t begin, std::size_t end, int) {
        auto next = std::lower_bound(pairs.begin(), pairs.end(), pair(begin));
        for (std::size_t i = begin; i < end; ++i) {
            while (next != pairs.end() && *next < pair(i)) ++next;
            if (next != pairs.end() && *next == pair(i)) processed[i] = 1;
        }
    });
}

void ContactSet::merge(const ContactSet& others) {
    if (others.size() == 0) return;
    ContactSet own = std::exchange(*this, {});
    near = std::move(own.near), keeps_near = own.keeps_near, min_distance = own.min_distance, counters = own.counters;
    std::size_t i = 0;
    for (std::size_t k = 0; k < others.size(); ++k) {
        const std::size_t first = i;
        while (i < own.size() && own.pair(i) < others.pair(k)) ++i;
        append(own, first, i);
        append(others, k, k + 1);
    }
    append(own, i, own.size());
}

Contact contact_of(std::int32_t a, std::int32_t b, const ProximityPoint& p, double friction) {
    const Vec3 point = p.features.kind == FeatureKind::face_vertex ? p.b : p.a;
    return {a, b, point, p.normal, p.distance, 0, friction, feature_key(p.features)};
}

} // namespace flotilla
