// SPDX-License-Identifier: MIT
#include "step/bowl_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(Bowl, TwentyBoatsComeToRest) { expect_boats_come_to_rest(22, 1, 500); }

} // namespace
} // namespace flotilla::scenario
