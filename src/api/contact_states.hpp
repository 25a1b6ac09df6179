// SPDX-License-Identifier: MIT
// Contacts at the present poses, with what each of them carried in the last step.
#pragma once

#include <vector>

#include <flotilla/report.hpp>

#include "step/stepper.hpp"

namespace flotilla {

/// Fills `out` with the contacts of a stepper, of bodies that sleep as well, in the order of their bodies.
void list_contact_states(const Stepper& stepper, std::vector<ContactState>& out);

} // namespace flotilla
