// SPDX-License-Identifier: MIT
// Contacts of bodies that are thinner than the distance at which they rest. Contacts of thick bodies have one point, at
// which their impulses keep the angular momentum. On a needle of 1 m and 10 um that point of the other body would be
// 600 radii from the axis: friction would turn it as nothing that it touches can. So these have a point on each body.
#pragma once

#include "state/contact.hpp"
#include "state/model.hpp"

namespace flotilla {

/// Whether the contacts of a pair with this friction and rest distance, m, have a point on each body: whether that is
/// more than the least radius of gyration of one that is dynamic, asleep or not: waking changes nothing. Normal
/// impulses go through both points, so that those of a pair without friction need one alone.
[[nodiscard]] bool is_thin_pair(const Model& model, std::int32_t a, std::int32_t b, double friction, double rest);

/// Such a contact, of one that was found with its point on either body.
[[nodiscard]] Contact with_two_points(Contact contact);

} // namespace flotilla
