// SPDX-License-Identifier: MIT
#include "run/planted_faults.hpp"

namespace flotilla::test {
namespace {

TEST(PlantedFaults, EachOfTwentyFourIsFoundAndNamed) { expect_planted_faults_are_found(24, 1); }

} // namespace
} // namespace flotilla::test
