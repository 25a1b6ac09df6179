// SPDX-License-Identifier: MIT
#include "run/planted_faults.hpp"

namespace flotilla::test {
namespace {

TEST(PlantedFaults, EachOfTwoHundredIsFoundAndNamed) { expect_planted_faults_are_found(200, 2); }

} // namespace
} // namespace flotilla::test
