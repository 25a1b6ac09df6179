// SPDX-License-Identifier: MIT
// The impulse at one point: Guendelman, Bridson, Fedkiw 2003, section 7 (friction), after section 5 (collisions).
#pragma once

#include "bodies.hpp"

namespace flotilla::baseline {

/// What a pair's bodies have together. Friction is the geometric mean as in flotilla, so that both methods solve one
/// problem; restitution the smaller one.
[[nodiscard]] double pair_friction(const Body& a, const Body& b);
[[nodiscard]] double pair_restitution(const Body& a, const Body& b);

/// Changes the velocities of `a` and `b` at `contact` so that its normal velocity becomes -restitution times what it
/// was, with Coulomb friction: sticking where that impulse lies in the cone, otherwise sliding. `arm_a`, `arm_b`: from
/// the centres of mass, m. Returns whether there was anything to do; points that separate are left alone.
bool apply_impulse(Body& a, Body& b, const Interference& contact, const Vec3& arm_a, const Vec3& arm_b,
                   double restitution, double friction);

} // namespace flotilla::baseline
