// SPDX-License-Identifier: MIT
// The tests that the fast slice leaves out.
#include "physics/physics.hpp"

namespace flotilla::physics {

extern const Slice kSlice;
const Slice kSlice = Slice::full;

} // namespace flotilla::physics
