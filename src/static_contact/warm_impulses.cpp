// SPDX-License-Identifier: MIT
#include "static_contact/warm_impulses.hpp"

#include <algorithm>
#include <tuple>

#include "base/index.hpp"
#include "base/search.hpp"
#include "islands/body_pair.hpp"
#include "state/feature_pair.hpp"

namespace flotilla {
namespace {

constexpr std::size_t kContactGrain = 256; // contacts of a task

/// A feature pair without its face. The face nearest to a vertex changes as the vertex slides, and between faces of
/// equal distance by rounding; what presses on the vertex stays.
std::uint64_t without_face(std::uint64_t feature_key) {
    constexpr std::uint64_t kIndex = (std::uint64_t{1} << 31) - 1;
    switch (static_cast<FeatureKind>(feature_key >> 62)) {
    case FeatureKind::vertex_face: return feature_key & ~kIndex;
    case FeatureKind::face_vertex: return feature_key & ~(kIndex << 31);
    case FeatureKind::edge_edge: break;
    }
    return feature_key;
}

/// Of a Contact or a WarmImpulse.
template <class Item>
auto group_key(const Item& x) {
    return std::tuple(x.a, x.b, without_face(x.feature_key));
}
constexpr auto kByGroup = [](const auto& x, const auto& y) { return group_key(x) < group_key(y); };

/// The impulse of the same feature pair; failing that, the only one of the same vertex. `guess`: about where it is.
const WarmImpulse* find_warm(std::span<const WarmImpulse> warm, const Contact& contact, std::size_t guess) {
    const auto same = [&](const WarmImpulse& w) {
        return w.feature_key == contact.feature_key && w.a == contact.a && w.b == contact.b;
    };
    if (guess < warm.size() && same(warm[guess]) && (guess == 0 || !same(warm[guess - 1]))) return &warm[guess];
    const auto first = warm.begin() + static_cast<std::ptrdiff_t>(lower_bound_near(warm, guess, contact, kByGroup));
    auto w = first;
    for (; w != warm.end() && group_key(*w) == group_key(contact); ++w)
        if (w->feature_key == contact.feature_key) return &*w;
    return w - first == 1 ? &*first : nullptr;
}

/// What is stored, by place in the list of those that are.
class StoredContacts {
  public:
    StoredContacts(const SolvedContacts& solved, std::vector<std::int32_t>& places) : solved_(solved), places_(places) {
        places.clear();
        for (std::size_t i = 0; i < solved.contacts.size(); ++i)
            if (solved.left_out.empty() || solved.left_out[i] == 0) places.push_back(static_cast<std::int32_t>(i));
    }

    [[nodiscard]] std::size_t size() const { return places_.size(); }
    [[nodiscard]] WarmImpulse impulse(std::size_t i) const {
        const Contact& c = contact(i);
        return {c.a, c.b, c.feature_key, solved_.impulses[at(places_[i])]};
    }
    [[nodiscard]] bool same_pair(std::size_t i, std::size_t j) const {
        const Contact &p = contact(i), &q = contact(j);
        return p.a == q.a && p.b == q.b;
    }

  private:
    [[nodiscard]] const Contact& contact(std::size_t i) const { return solved_.contacts[at(places_[i])]; }

    const SolvedContacts& solved_;
    const std::vector<std::int32_t>& places_;
};

constexpr auto kByGroupAndFeature = [](const WarmImpulse& x, const WarmImpulse& y) {
    return std::tuple(group_key(x), x.feature_key) < std::tuple(group_key(y), y.feature_key);
};

} // namespace

void load_warm(Team* team, std::span<const Contact> contacts, const KnownImpulses& known, std::vector<Vec3>& impulses) {
    impulses.resize(contacts.size());
    for_each(team, "warm start", contacts.size(), kContactGrain, [&](std::size_t i) {
        impulses[i] = {};
        // Few contacts come and go in a step, so the list of the last one is nearly this one.
        if (const WarmImpulse* w = find_warm(known.own, contacts[i], i))
            impulses[i] = w->impulse;
        else if (const WarmImpulse* v = find_warm(known.other, contacts[i], i))
            impulses[i] = known.other_factor * v->impulse;
    });
}

void store_warm(Team* team, const SolvedContacts& solved, std::vector<std::int32_t>& places,
                std::vector<WarmImpulse>& warm) {
    const StoredContacts stored(solved, places);
    warm.resize(stored.size());
    for_each(team, "store warm impulses", stored.size(), kContactGrain,
             [&](std::size_t i) { warm[i] = stored.impulse(i); });
    // Contacts come pair by pair: what is left to sort are those of one pair, by the contact that begins it.
    for_each(team, "sort warm impulses", warm.size(), kContactGrain, [&](std::size_t i) {
        if (i > 0 && stored.same_pair(i - 1, i)) return;
        std::size_t end = i + 1;
        while (end < warm.size() && stored.same_pair(i, end)) ++end;
        std::sort(warm.begin() + static_cast<std::ptrdiff_t>(i), warm.begin() + static_cast<std::ptrdiff_t>(end),
                  kByGroupAndFeature);
    });
}

void add_impulses(std::span<const WarmImpulse> more, double factor, std::vector<WarmImpulse>& sums,
                  std::vector<WarmImpulse>& scratch) {
    scratch.clear();
    auto known = sums.cbegin();
    for (auto next = more.begin(); next != more.end();) {
        const WarmImpulse& first = *next;
        for (; known != sums.cend() && by_bodies(*known, first); ++known) scratch.push_back(*known);
        const auto pair = static_cast<std::ptrdiff_t>(scratch.size());
        for (; known != sums.cend() && !by_bodies(first, *known); ++known) scratch.push_back(*known);
        for (; next != more.end() && !by_bodies(first, *next); ++next) {
            const auto same = [&](const WarmImpulse& w) { return w.feature_key == next->feature_key; };
            const auto sum = std::find_if(scratch.begin() + pair, scratch.end(), same);
            if (sum != scratch.end())
                sum->impulse += factor * next->impulse;
            else
                scratch.push_back({next->a, next->b, next->feature_key, factor * next->impulse});
        }
    }
    scratch.insert(scratch.end(), known, sums.cend());
    sums.swap(scratch);
}

} // namespace flotilla
