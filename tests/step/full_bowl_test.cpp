// SPDX-License-Identifier: MIT
#include "step/bowl_run.hpp"

namespace flotilla::scenario {
namespace {

TEST(Bowl, AHundredBoatsComeToRest) { expect_boats_come_to_rest(102, 1, 5000); }

} // namespace
} // namespace flotilla::scenario
