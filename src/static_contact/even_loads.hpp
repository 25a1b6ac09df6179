// SPDX-License-Identifier: MIT
// How the contacts of a pair share a load where no law says how: flat sides that touch at more than three points.
//
// Any shares with the same force and torque are solutions, and sweeps find one by their order: a cube that stands alone
// had 3.1 N at two corners and 1.8 at two, one between jaws 7.5, 2.3, 1.9 and 1.1 N. Where it needs most of its
// friction that decides: the corner with the largest load is a hinge that the others do not hold, and a box slid out of
// jaws that press by a fifth more than they need to, swinging about that corner. That is a solution too, of bodies that
// are stiff at one corner alone. A solve begins with the one of least norm, that of sides which are stiff all over:
// normal impulses are affine in the place. It has the force and torque of the one before: what was solved remains so.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/vec3.hpp"
#include "parallel/team.hpp"
#include "state/contact.hpp"

namespace flotilla {

/// A contact of a patch.
struct SharedLoad {
    std::size_t contact = 0;
    double x = 0, y = 0;                         ///< m, in the plane, from the middle of the patch
    double normal = 0, along_x = 0, along_y = 0; ///< N s
};

/// Shares the impulses (N s, on b, by contact) of each patch: contacts of a pair with one normal, in one plane, that
/// touch. Friction is shared by the same law, as far as its cones allow; where all that carry slide, it goes with the
/// normal impulses. Pairs that have bounds of friction (ContactSolveOptions::bounds) are left as they are. `scratch` is
/// by thread.
void even_loads(Team* team, std::span<const Contact> contacts, std::span<const double> bounds, std::span<Vec3> impulses,
                std::vector<std::vector<SharedLoad>>& scratch);

} // namespace flotilla
