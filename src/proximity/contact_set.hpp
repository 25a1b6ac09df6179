// SPDX-License-Identifier: MIT
// The contact points of all pairs at one set of poses.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "proximity/contact_points.hpp"
#include "state/candidate_pairs.hpp"
#include "state/contact.hpp"

namespace flotilla {

class Team;

/// Contact points of all pairs within their proximity distance, sorted by (a, b, feature key); those found ahead come
/// after the others of their pair.
struct ContactSet {
    std::vector<Contact> contacts;       ///< targets unset
    std::vector<double> rest;            ///< m, rest distance of each contact's pair
    std::vector<std::uint8_t> processed; ///< stage 1 examined the pair, near at the start or the end of its motion
    std::vector<std::uint8_t> ahead;     ///< found by what the bodies would do (step/look_ahead.hpp)
    std::vector<CandidatePair> near;     ///< pairs whose boxes come within the reach of gravity, sorted; if kept
    bool keeps_near = false;             ///< for look_ahead.hpp
    double min_distance = std::numeric_limits<double>::infinity(); ///< m, of all feature pairs within proximity
    PruneCounters counters;                                        ///< of the search

    [[nodiscard]] std::size_t size() const { return contacts.size(); }
    [[nodiscard]] CandidatePair pair(std::size_t i) const { return {contacts[i].a, contacts[i].b}; }
    void clear();
    void resize(std::size_t size);
    void add(const Contact& contact, double rest_distance, bool was_processed, bool is_ahead);
    /// The pairs of its contacts, without those that are only ahead. `places` is scratch.
    void list_pairs(Team& team, std::vector<std::size_t>& places, std::vector<CandidatePair>& out) const;
    /// Takes pairs for processed, given in the order of the contacts.
    void mark_processed(Team& team, std::span<const CandidatePair> pairs);
    /// Writes the contacts of `part` over those from `place` on.
    void put(std::size_t place, const ContactSet& part);
    /// Appends those of `part` from `begin` to `end`.
    void append(const ContactSet& part, std::size_t begin, std::size_t end);
    /// Takes the contacts of pairs that it has none of, in the order of pairs.
    void merge(const ContactSet& others);
    /// Removes the contacts that are not wanted, by their places; the smallest distance stays.
    template <typename Wanted>
    void keep(Wanted&& wanted) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            if (!wanted(i)) continue;
            contacts[kept] = contacts[i];
            rest[kept] = rest[i];
            processed[kept] = processed[i];
            ahead[kept++] = ahead[i];
        }
        resize(kept);
    }
};

/// A contact at the point of the vertex, or of body a's edge (section 4.3.1), without a target.
[[nodiscard]] Contact contact_of(std::int32_t a, std::int32_t b, const ProximityPoint& point, double friction);

} // namespace flotilla
