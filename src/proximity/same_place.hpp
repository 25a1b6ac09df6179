// SPDX-License-Identifier: MIT
// Contact points that repeat one another: corners and edges of two bodies at one place.
#pragma once

#include <cstddef>
#include <vector>

#include "proximity/contact_points.hpp"

namespace flotilla {

/// Of the contact points from `first` on, in the order of their feature keys, drops those that say what that of a
/// vertex on a flat side says: the other body's vertex, and edges that cross there. Of several such the first stays.
/// Where boxes stand corner over corner, which of these there are is decided by the last bits of their poses, and a
/// contact that comes or goes in each step takes what it carried with it. A hundred boxes under one of 1e9 times their
/// mass, preset accurate, have 400 contacts for 880 to 960, and take a seventeenth of the time. `proximity`: m, as in
/// find_contact_points(). Returns how many went.
std::size_t drop_same_places(const BodyMotion& a, const BodyMotion& b, double proximity, double angle_cos,
                             std::size_t first, ProximityScratch& scratch, std::vector<ProximityPoint>& points);

} // namespace flotilla
