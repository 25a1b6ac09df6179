// SPDX-License-Identifier: MIT
// Tangent directions of a contact (paper, section 4.3.2: "randomly choosing the tangent vectors").
#pragma once

#include <cstdint>

#include "base/vec3.hpp"
#include "state/contact.hpp"

namespace flotilla {

/// Right-handed with the normal: t1 x t2 = n.
struct TangentPair {
    Vec3 t1, t2;
};

/// Tangents turned about the unit normal by an angle uniform in [0, pi/2) (a quarter turn maps a pyramid onto itself),
/// a pure function of normal, seed, step and the contact's ids: no order of contacts or steps can change it.
TangentPair keyed_tangents(const Contact& contact, std::uint64_t seed, std::uint64_t step);

/// Some tangents, a pure function of the unit normal, for friction that is the same in every direction.
TangentPair any_tangents(const Vec3& normal);

} // namespace flotilla
