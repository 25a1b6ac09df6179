// SPDX-License-Identifier: MIT
#include "static_contact/squeezed_pairs.hpp"

#include <algorithm>
#include <cstddef>

#include "parallel/compact.hpp"

namespace flotilla {

double due_distance(std::span<const SqueezedPair> squeezed, std::int32_t a, std::int32_t b, double rest) {
    const auto less = [](const SqueezedPair& s, std::pair<std::int32_t, std::int32_t> key) {
        return std::pair(s.a, s.b) < key;
    };
    const auto it = std::lower_bound(squeezed.begin(), squeezed.end(), std::pair(a, b), less);
    return it != squeezed.end() && it->a == a && it->b == b ? std::min(rest, it->distance) : rest;
}

/// Those that lack more of their rest distance than any dead band.
void SqueezedPairs::list_near(Team& team, const ContactSet& contacts, const ContactTuning& tuning) {
    constexpr std::size_t kContactGrain = 256; // contacts of a task
    const auto is_near = [&](std::size_t i) {
        return contacts.ahead[i] == 0 && contacts.contacts[i].distance < (1 - tuning.most_of_rest) * contacts.rest[i];
    };
    const auto first_near = [&](std::size_t i) {
        if (!is_near(i)) return false;
        for (std::size_t k = i; k > 0 && contacts.pair(k - 1) == contacts.pair(i); --k)
            if (is_near(k - 1)) return false;
        return true;
    };
    const auto nearest = [&](std::size_t i) {
        const Contact& c = contacts.contacts[i];
        NearPair pair{c.a, c.b, c.distance, contacts.rest[i]};
        for (std::size_t k = i + 1; k < contacts.size() && contacts.pair(k) == contacts.pair(i); ++k)
            if (contacts.ahead[k] == 0) pair.distance = std::min(pair.distance, contacts.contacts[k].distance);
        return pair;
    };
    compact_if({&team, "squeezed pairs", kContactGrain, places_}, contacts.size(), first_near, near_, 0, nearest);
}

/// What a pair gains while it waits is due from then on.
SqueezedPair SqueezedPairs::judge(const NearPair& pair, SqueezedPair known, const ContactTuning& tuning) {
    if (known.steps < 0) {
        known.distance = std::clamp(pair.distance, std::min(known.distance, pair.rest), pair.rest);
        if (++known.steps == 0) known.distance = pair.rest;
        return known;
    }
    if (++known.steps < tuning.steps_in_vain) return known;
    known.waits = std::clamp(2 * known.waits, tuning.steps_in_vain, SqueezedPair::kMostWait);
    known.steps = -known.waits;
    known.distance = pair.distance;
    return known;
}

} // namespace flotilla
