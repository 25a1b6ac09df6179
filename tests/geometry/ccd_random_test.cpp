// SPDX-License-Identifier: MIT
// A slice of the generated queries; ccd_random_slow_test.cpp runs the whole.
#include <gtest/gtest.h>

#include "support/ccd_random.hpp"

namespace flotilla::test {
namespace {

TEST(CcdRandom, WideKernelsGiveTheBitsOfTheScalarCode) {
    check_wide_against_scalar(0, count_from_environment("FLOTILLA_CCD_QUERIES", 200'000));
}

TEST(CcdRandom, MissesNoContactOfTheExactOracle) {
    check_against_oracle(0, count_from_environment("FLOTILLA_CCD_ORACLE_QUERIES", 20'000));
}

} // namespace
} // namespace flotilla::test
