// SPDX-License-Identifier: MIT
// Pairs of bodies that have no room for their rest distance (SqueezedPair).
//
// Equation 16 asks for all that a pair lacks of its rest distance in one step, by the normals of where its bodies are.
// Where others squeeze them from several sides there may be no such place, or none that the normals of the present
// features lead to: bodies then rock between two states for ever, at what raising them costs in every step. A pair that
// was asked in vain for some steps is due what it has for as many, and then asked again; each time that is in vain it
// waits twice as long as the last.
//
// Reads: contacts. Writes: State::squeezed.
#pragma once

#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "parallel/team.hpp"
#include "proximity/contact_set.hpp"
#include "state/model.hpp"
#include "static_contact/contact_tuning.hpp"

namespace flotilla {

/// m, the distance that contacts raise the bodies of a pair to whose rest distance is `rest`.
[[nodiscard]] double due_distance(std::span<const SqueezedPair> squeezed, std::int32_t a, std::int32_t b, double rest);

class SqueezedPairs {
  public:
    /// Brings `squeezed` from the contacts at x^n to those at x^{n+1}. Pairs that rest(a, b), being not searched for
    /// contacts, stay as they are; those that were not asked(a, b) to part, or may not be held to it, are forgotten.
    template <class Rest, class Asked>
    void update(Team& team, const ContactSet& at_end, const ContactTuning& tuning, Rest&& rests, Asked&& asked,
                std::vector<SqueezedPair>& squeezed) {
        if (tuning.steps_in_vain == 0) return;
        list_near(team, at_end, tuning);
        if (near_.empty() && squeezed.empty()) return;
        next_.clear();
        auto old = squeezed.begin();
        const auto keep_before = [&](std::pair<std::int32_t, std::int32_t> key) {
            for (; old != squeezed.end() && std::pair(old->a, old->b) < key; ++old)
                if (rests(old->a, old->b)) next_.push_back(*old);
        };
        for (const NearPair& pair : near_) {
            keep_before({pair.a, pair.b});
            const bool known = old != squeezed.end() && old->a == pair.a && old->b == pair.b;
            const SqueezedPair before = known ? *old++ : SqueezedPair{pair.a, pair.b, pair.rest, 0, 0};
            if (asked(pair.a, pair.b)) next_.push_back(judge(pair, before, tuning));
        }
        keep_before({std::numeric_limits<std::int32_t>::max(), 0});
        squeezed.swap(next_);
    }

  private:
    struct NearPair {
        std::int32_t a, b;     ///< a < b
        double distance, rest; ///< m
    };

    void list_near(Team& team, const ContactSet& contacts, const ContactTuning& tuning);
    [[nodiscard]] static SqueezedPair judge(const NearPair& pair, SqueezedPair known, const ContactTuning& tuning);

    // Kept between steps, so that a steady scene allocates nothing.
    std::vector<NearPair> near_; ///< sorted
    std::vector<SqueezedPair> next_;
    std::vector<std::size_t> places_;
};

} // namespace flotilla
