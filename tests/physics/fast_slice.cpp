// SPDX-License-Identifier: MIT
// The tests of the fast slice.
#include "physics/physics.hpp"

namespace flotilla::physics {

extern const Slice kSlice;
const Slice kSlice = Slice::fast;

} // namespace flotilla::physics
