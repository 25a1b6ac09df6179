// SPDX-License-Identifier: MIT
#include "step/bowl_run.hpp"

namespace flotilla::scenario {
namespace {

// The last boat slides down the bowl until step 230, as it also does with every solve from step 160 on swept to its tolerance.
TEST(Bowl, TwentyBoatsComeToRest) { expect_boats_come_to_rest(22, 1, 288, 500); }

} // namespace
} // namespace flotilla::scenario
