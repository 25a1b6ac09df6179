// SPDX-License-Identifier: MIT
// Bodies that others hold between them, of several pairs, with no room for their rest distances.
//
// A disc between a floor and a plate, a tile between its neighbours in a tray: at rest no pair may come nearer, and
// what is at the ends of the row does not give way. Any impulses that balance each other are then a solution, and
// friction goes by them: discs stopped, pressed by 300 times their weight. So where two fixed bodies leave no play
// beside the rest distances of both pairs, half of these is due, and the other half is there to move in; rows of bodies
// yield a little (targets.cpp), as pairs do whose own contacts oppose each other.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "parallel/team.hpp"
#include "proximity/contact_set.hpp"
#include "state/model.hpp"

namespace flotilla {

class Between {
  public:
    /// `least_lacking`: the share of its rest distances that what a script presses lacks at least.
    void find(Team* team, const Model& model, const ContactSet& set, std::span<const RestDistance> noted,
              std::span<const SqueezedPair> squeezed, double least_lacking);
    /// `first`: the first contact of a pair. m, the distance that is due to it; infinite: its rest distance.
    [[nodiscard]] double room(std::size_t first) const {
        return sides_.empty() ? std::numeric_limits<double>::infinity() : rooms_[first];
    }
    /// Of a row.
    [[nodiscard]] bool yields(std::size_t first) const { return !sides_.empty() && yields_[first] != 0; }
    [[nodiscard]] bool presses() const { return !sides_.empty() && presses_; }
    /// Between a script and what does not give way.
    [[nodiscard]] bool pressed(std::size_t first) const { return !sides_.empty() && pressed_[first] != 0; }

  private:
    /// What a movable body has beside it.
    struct Side {
        std::int32_t body, other;
        std::size_t first;   ///< contact of the pair
        std::size_t contact; ///< that one, or where the pair faces several ways each
        Vec3 normal;         ///< towards the body
        double distance;     ///< m
        double rest;         ///< m
        bool fixed;          ///< the other
        bool scripted;       ///< the other
        bool lacks_room;     ///< the pair, of its rest distance
        bool holds;          ///< the other does not give way, or is held in the same direction
    };
    void list_sides(Team* team, const Model& model, const ContactSet& set, std::span<const RestDistance> noted,
                    std::span<const SqueezedPair> squeezed);
    void add_sides(const Model& model, const ContactSet& set, std::size_t first, std::size_t end, bool lacks_room);
    [[nodiscard]] std::span<Side> sides_of(std::int32_t body);
    void follow_rows();
    void compare(std::span<const Side> around);
    void press(std::span<const Side> around, double least_lacking);
    static void drop_where_none_is_across(std::span<Side> around);
    template <class Work>
    void for_bodies(Work&& work) {
        for (std::size_t i = 0, end = 0; i < sides_.size(); i = end) {
            for (end = i + 1; end < sides_.size() && sides_[end].body == sides_[i].body;) ++end;
            work(std::span(sides_).subspan(i, end - i));
        }
    }

    std::vector<Side> sides_;         ///< sorted by bodies, then by pairs
    std::vector<std::size_t> follow_; ///< sides that hold, to go on from; before that, first contacts of pairs
    std::vector<std::size_t> places_; ///< scratch
    // By contact, the first ones of pairs; where there are sides.
    std::vector<double> rooms_;
    std::vector<std::uint8_t> yields_, pressed_;
    bool presses_ = false; ///< whether any is pressed
};

} // namespace flotilla
